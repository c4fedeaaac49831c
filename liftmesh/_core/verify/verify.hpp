// Whether triangles from any source are the Delaunay triangulation of the points, or another member
// of its family.
#pragma once

#include "base/input.hpp"
#include "base/point.hpp"
#include "base/status.hpp"
#include "parallel/thread_pool.hpp"
#include "verify/edge_pairing.hpp"
#include "verify/flaws.hpp"
#include "verify/sides.hpp"

namespace liftmesh {

// Triangles over points, with their neighbours; queries, and the triangle that holds each of them,
// or -1.
struct Question {
    const Point* points;
    std::size_t rows;
    const std::int32_t* simplices;  // count x 3
    const std::int32_t* neighbors;  // count x 3
    std::size_t count;
    const Point* queries;
    std::size_t queried;
    std::int32_t* found;
};

// Where a point lies. What it answers is checked, so nothing rests on it. False if the interrupt
// came first.
using Locate = std::function<bool(const Question&)>;

// Counts the finite rows without a vertex that are hidden, and adds those that are not: their lift
// is below the triangles, or on them but not at a vertex. The triangles must be without a flaw, and
// have neighbours if any finite row is no vertex.
bool judge_others(const MeshView& mesh, const Marks& vertices, const Locate& locate,
                  ThreadPool& pool, std::size_t& hidden, Flaws& flaws);

struct Verdict {
    Status status = Status::ok;
    std::size_t row = 0;                 // the first non-finite row, if that is the status
    std::size_t skipped = 0;             // rows that are not finite
    std::size_t vertices = 0;            // distinct positions of corners
    std::size_t merged = 0;              // rows that are corners, beyond one for each position
    std::size_t hidden = 0;              // rows strictly above the triangles, if these have no flaw
    std::optional<std::size_t> outside;  // rows off carved triangles, if these do not overlap
    std::size_t interior_edges = 0;      // between two triangles
    std::size_t boundary_edges = 0;      // of one triangle only
    Flaws flaws;                         // those of edges only if all corners are finite rows
};

// `simplices` are count x 3 corners. `locate` is asked where rows without a vertex lie, if the
// member may hide rows.
Verdict verify(const Input& input, const std::int32_t* simplices, std::size_t count,
               bool skip_non_finite, const Member& member, const Locate& locate, Threads threads,
               Interrupt& interrupt);

// Of Delaunay triangulations.
inline Verdict verify(const Input& input, const std::int32_t* simplices, std::size_t count,
                      bool skip_non_finite, Threads threads, Interrupt& interrupt) {
    return verify(input, simplices, count, skip_non_finite, {}, {}, threads, interrupt);
}

// Triangles of a part of a triangulation: what is wrong with them, and where they end.
//
// The argument of verify.cpp holds for parts. Pairs of half-edges cancel in whatever order they are
// found, so it is enough to pair what each part leaves unpaired; what the last part leaves is the
// boundary of the whole.

// An edge with its triangle on the left, and no triangle of the part on its right.
struct OpenEdge {
    std::int32_t tail, head, apex;
};

struct VerifiedPart {
    bool is_complete = false;  // the interrupt did not come first
    Flaws flaws;               // of triangles, and of the edges between them
    std::size_t interior_edges = 0;
    std::vector<OpenEdge> open;
};

// All corners must be rows, and all rows finite.
VerifiedPart verify_part(const Input& rows, const std::int32_t* simplices, std::size_t count,
                         Threads threads, Interrupt& interrupt);

}  // namespace liftmesh
