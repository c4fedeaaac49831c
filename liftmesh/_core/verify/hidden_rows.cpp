// The triangles cover the convex hull of their corners, and their lifts are a convex surface. A row
// is hidden if it is strictly above the plane of a triangle that contains it. Where it lies is
// asked from outside, and three orientations check the answer. A row that is said to be in none is
// counted as missing.

#include "base/input.hpp"
#include "parallel/blocks.hpp"
#include "predicates/orient2d.hpp"
#include "verify/sides.hpp"
#include "verify/verify.hpp"

namespace liftmesh {

namespace {

class Others {
 public:
    Others(const MeshView& mesh, ThreadPool& pool) : mesh_(mesh), pool_(pool) {}

    bool find(const Marks& vertices) {
        const auto is_other = [&](std::size_t row) {
            return !vertices[row] && is_finite(mesh_.points[row]);
        };
        return select(mesh_.rows, pool_, is_other, rows_);
    }

    bool locate(const Locate& locate) {
        if (rows_.empty()) return true;
        std::vector<Point> queries;
        queries.reserve(rows_.size());
        for (const Row row : rows_) queries.push_back(mesh_.points[row]);
        found_.resize(rows_.size());
        return locate({mesh_.points, mesh_.rows, mesh_.simplices, mesh_.neighbors, mesh_.count,
                       queries.data(), queries.size(), found_.data()});
    }

    bool judge(std::size_t& hidden, Flaws& flaws) {
        std::vector<Flaws> found(blocks(rows_.size()));
        std::vector<std::size_t> above(found.size());
        const auto work = [&](std::size_t first, std::size_t last, std::size_t task) {
            for (std::size_t i = first; i < last; ++i) judge(i, above[task], found[task]);
        };
        if (!in_blocks(rows_.size(), block, pool_, work)) return false;
        for (const std::size_t count : above) hidden += count;
        for (const Flaws& part : found) flaws.add(part);
        return true;
    }

 private:
    void judge(std::size_t i, std::size_t& above, Flaws& flaws) const {
        const Row row = rows_[i];
        if (found_[i] < 0) return flaws.add(Flaw::missing_vertices, {row, 0});
        const auto first = 3 * static_cast<std::size_t>(found_[i]);
        if (!contains(first, mesh_.points[row])) throw std::logic_error("a row is elsewhere");
        const int side = mesh_.sides->side(mesh_.corner(first), mesh_.corner(first + 1),
                                           mesh_.corner(first + 2), row);
        if (side < 0)
            ++above;
        else if (side > 0 || !is_corner(first, mesh_.points[row]))
            flaws.add(Flaw::missing_vertices, {row, mesh_.callers_place(first) / 3 + 1});
    }

    bool contains(std::size_t first, Point p) const {
        const Point a = mesh_.point(first), b = mesh_.point(first + 1), c = mesh_.point(first + 2);
        return orient2d(a, b, p) >= 0 && orient2d(b, c, p) >= 0 && orient2d(c, a, p) >= 0;
    }
    bool is_corner(std::size_t first, Point p) const {
        return mesh_.point(first) == p || mesh_.point(first + 1) == p ||
               mesh_.point(first + 2) == p;
    }

    const MeshView& mesh_;
    ThreadPool& pool_;
    std::vector<Row> rows_;  // those without a vertex
    std::vector<std::int32_t> found_;
};

}  // namespace

bool judge_others(const MeshView& mesh, const Marks& vertices, const Locate& locate,
                  ThreadPool& pool, std::size_t& hidden, Flaws& flaws) {
    Others others(mesh, pool);
    return others.find(vertices) && others.locate(locate) && others.judge(hidden, flaws);
}

}  // namespace liftmesh
