from . import scipy as scipy
from .base.cloud import Cloud as Cloud
from .base.weights import Weights as Weights
from .cells.disk_cells import (
    ApolloniusCells as ApolloniusCells,
    apollonius_diagram as apollonius_diagram,
)
from .cells.natural import (
    NaturalNeighbors as NaturalNeighbors,
    natural_neighbors as natural_neighbors,
)
from .cells.optimization import (
    LloydResult as LloydResult,
    TransportResult as TransportResult,
    lloyd as lloyd,
    transport as transport,
)
from .cells.voronoi import (
    Cells as Cells,
    Unclipped as Unclipped,
    power_diagram as power_diagram,
    voronoi as voronoi,
)
from .comparison.compare import compare as compare
from .comparison.report import Comparison as Comparison
from .comparison.solid import HullComparison as HullComparison
from .disks.apollonius import ApolloniusGraph as ApolloniusGraph, apollonius as apollonius
from .errors import (
    CrossingError as CrossingError,
    DataWarning as DataWarning,
    DegenerateInputError as DegenerateInputError,
    DuplicateHeightError as DuplicateHeightError,
    FormatError as FormatError,
    InputError as InputError,
    LiftmeshError as LiftmeshError,
    MissingDependencyError as MissingDependencyError,
    NonFiniteError as NonFiniteError,
    UnsupportedTypeError as UnsupportedTypeError,
)
from .io.format import Format as Format
from .io.read import read as read, read_chunks as read_chunks
from .io.registry import Adapter as Adapter, as_cloud as as_cloud
from .io.write import WriteResult as WriteResult, write as write
from .pages.page import Page as Page
from .planar.alpha import AlphaComplex as AlphaComplex, AlphaShape as AlphaShape
from .planar.anisotropic import (
    AnisotropicStars as AnisotropicStars,
    anisotropic_stars as anisotropic_stars,
)
from .planar.certificate import Certificate as Certificate, Flaw as Flaw, Violation as Violation
from .planar.constrained import constrained_delaunay as constrained_delaunay
from .planar.constrained_triangulation import (
    ConstrainedTriangulation as ConstrainedTriangulation,
)
from .planar.delaunay import delaunay as delaunay
from .planar.dynamic_triangulation import DynamicTriangulation as DynamicTriangulation
from .planar.lifting import (
    Counters as Counters,
    LowerHull as LowerHull,
    lift as lift,
    project as project,
)
from .planar.many import Triangulations as Triangulations, delaunay_many as delaunay_many
from .planar.polygon import triangulate_polygon as triangulate_polygon
from .planar.refined import RefineResult as RefineResult
from .planar.refinement import refine as refine
from .planar.regular import RegularTriangulation as RegularTriangulation, regular as regular
from .planar.triangulation import Triangulation as Triangulation
from .planar.verification import verify as verify
from .plots.plot import plot as plot
from .predicates import (
    incircle as incircle,
    insphere as insphere,
    orient2d as orient2d,
    orient3d as orient3d,
)
from .raster.raster import Raster as Raster
from .space.alpha_shape import alpha_shape as alpha_shape
from .space.convex_hull import ConvexHull as ConvexHull, convex_hull as convex_hull
from .space.lower_hull import lower_hull as lower_hull
from .space.spherical import (
    SphericalTriangulation as SphericalTriangulation,
    spherical_delaunay as spherical_delaunay,
)
from .space.tetrahedra import tetrahedralize as tetrahedralize
from .space.tetrahedralization import Tetrahedralization as Tetrahedralization
from .terrain.accuracy import Accuracy as Accuracy
from .terrain.clipping import paste as paste
from .terrain.contours import Contour as Contour, Contours as Contours
from .terrain.difference import difference as difference
from .terrain.filled import FilledContours as FilledContours
from .terrain.frame import Frame as Frame
from .terrain.ground import classify_ground as classify_ground
from .terrain.measures import CutFillResult as CutFillResult, VolumeResult as VolumeResult
from .terrain.merging import merge as merge
from .terrain.profile import Profile as Profile
from .terrain.report import Report as Report
from .terrain.simplification import simplify as simplify
from .terrain.stages import StageStorage as StageStorage
from .terrain.surface import Surface as Surface
from .terrain.thinning import thin as thin
from .terrain.triangulate import as_surface as as_surface, triangulate as triangulate
from .tiles.build import tile as tile, tile_surface as tile_surface
from .tiles.globe import (
    QuantizedMeshResult as QuantizedMeshResult,
    write_quantized_mesh as write_quantized_mesh,
)
from .tiles.tiled import Tiled as Tiled, TiledSurface as TiledSurface, open_tiled as open_tiled
from .tiles.tileset import TilesetResult as TilesetResult, write_tileset as write_tileset
from .viewer.view import view as view

__version__: str
