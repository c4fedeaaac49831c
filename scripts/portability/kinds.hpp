// What each kind of result is made of: every function adds hashes of what it computes on the rows.
#pragma once

#include <cstddef>

#include "digest.hpp"

namespace portability {

// Triangulations, by each engine that is quick enough, what is found in them, and their check.
void add_meshes(const double* coordinates, std::size_t rows, Digests& digests);

// Voronoi and power diagrams, their regions, and cells clipped to a square on its corner.
void add_cells(const double* coordinates, std::size_t rows, Digests& digests);

// The other members of the family: by weights, by radii, in a metric, and of farthest points.
void add_family(const double* coordinates, std::size_t rows, Digests& digests);

// Graphs of disks with their circles, and stars in metrics of their own.
void add_disks(const double* coordinates, std::size_t rows, Digests& digests);

// What a surface over the rows answers: heights and slopes at points and as rasters, neighbours,
// lines, rings, volumes and overlays.
void add_surfaces(const double* coordinates, std::size_t rows, Digests& digests);

// Points and edges that come and go, and terrains of few triangles.
void add_changes(const double* coordinates, std::size_t rows, Digests& digests);

// Edges that a triangulation must have, the regions between them, and what these are refined to.
void add_constraints(const double* coordinates, std::size_t rows, Digests& digests);

// Tetrahedra of rows in space, their check, alpha complexes, directions, and signs.
void add_space(const double* coordinates, std::size_t rows, Digests& digests);

// The nodes of a tiled triangulation, and what their faces reach.
void add_tiles(const double* coordinates, std::size_t rows, Digests& digests);

// Exact signs, and the numbers of the filters before them, of rows that follow one another.
void add_signs(const double* coordinates, std::size_t rows, Digests& digests);

// Coordinates, their bits as whole numbers, and as single precision; what is printed is parsed.
void add_printed(const double* coordinates, std::size_t rows, Digests& digests);

// The lines of a file, one number each.
void add_parsed(const char* file, Digests& digests);

}  // namespace portability
