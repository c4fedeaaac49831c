"""Heights and rasters of other programs, beside those of liftmesh: CGAL's, PDAL's loop, GDAL's."""
