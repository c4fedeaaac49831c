// What a sanitizer watches; each check ends the process with a message if anything differs.
#pragma once

#include <cstddef>

#include "clouds.hpp"
#include "delaunay/delaunay.hpp"

namespace parallel {

// Ends the process if threads change the vertices. Cells are clipped with the rows that were
// triangulated, with others, and interrupted.
void check_cells(const Cloud& cloud, const liftmesh::Delaunay& found);

// Exits with a message if threads change a height, a pixel, a line or a ring; runs are interrupted,
// too.
void check_surfaces(const Cloud& cloud, const liftmesh::Delaunay& found);

// Lays two surfaces over each other, on two callers' threads, and interrupts some runs. Exits with
// a message if anything differs.
void check_overlays(const Cloud& cloud);

// The same calls while their rows and heights are written. Whatever comes out, it comes.
void check_spoilt_surfaces(std::size_t rows, unsigned most_threads);

// Compares runs of each member of the family with those of one thread, interrupts some, and
// verifies the result on one thread and on several. Ends the process if anything differs.
void check_family(const Cloud& cloud);

// Triangulates a cloud in two tiles, on one thread and on several, and interrupts some runs. Ends
// the process if anything differs, or if there are not as many triangles as one run makes.
void check_tiles(const Cloud& cloud, std::size_t triangles);

// Inserts and removes rows, one by one and many at once, on several callers' threads, also with
// constraints; the number of triangles must be that of a fresh run. Then it simplifies a terrain of
// the rows. Ends the process if anything differs.
void check_changes(const Cloud& cloud);

// Puts edges into triangulations on one thread and on several, interrupts some runs, carves, and
// verifies what is left; then several callers refine. Ends the process if anything differs.
void check_constraints(const Cloud& cloud);

// Makes the graph of disks around the rows, and the stars of the rows, on several callers' threads,
// interrupts both, and verifies the graph on one thread and on many, also spoilt. Ends the process
// if anything differs.
void check_disks(const Cloud& cloud);

// Makes, verifies and searches tetrahedra of the rows at heights of few values, on one thread and
// on several, and interrupts some runs. Then two callers at the same time make their alpha complex,
// that of the rows in the plane, and the triangulation of their directions. Ends the process if
// anything differs.
void check_space(const Cloud& cloud);

// Exits with a message if what is parsed differs from what was printed, or threads change the text.
void check_text(std::size_t rows);

// Exits with a message if the result names anything but rows, or is no triangulation.
void check_spoilt_rows(std::size_t rows, unsigned most_threads);

}  // namespace parallel
