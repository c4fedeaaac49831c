#include "surface/passage.hpp"

#include "base/floating_point.hpp"
#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

bool boxes_meet(Point a, Point b, Point p, Point q) {
    return std::max(a.x, b.x) >= std::min(p.x, q.x) && std::min(a.x, b.x) <= std::max(p.x, q.x) &&
           std::max(a.y, b.y) >= std::min(p.y, q.y) && std::min(a.y, b.y) <= std::max(p.y, q.y);
}

// Also of collinear segments, whose boxes meet if they do.
bool touch(Point a, Point b, Point p, Point q) {
    return boxes_meet(a, b, p, q) && orient2d(p, q, a) * orient2d(p, q, b) <= 0 &&
           orient2d(a, b, p) * orient2d(a, b, q) <= 0;
}

class PassageFinder {
 public:
    PassageFinder(const Triangulated& mesh, Passages& found, Patience& patience)
        : mesh_(mesh), found_(found), patience_(patience), seen_(mesh.count, -1) {}

    void run(std::int32_t segment, Point p, Point q, std::int32_t start) {
        reach(start, segment);
        while (!reached_.empty() && !patience_.ends()) {
            const std::int32_t face = reached_.back();
            reached_.pop_back();
            found_.segments.push_back(segment);
            found_.faces.push_back(face);
            for (int k = 0; k < 3; ++k) {
                const std::int32_t next = mesh_.neighbor(face, k);
                if (next >= 0 && touches_side(face, k, p, q)) reach(next, segment);
            }
        }
    }

 private:
    void reach(std::int32_t face, std::int32_t segment) {
        if (face < 0 || seen_[static_cast<std::size_t>(face)] == segment) return;
        seen_[static_cast<std::size_t>(face)] = segment;
        reached_.push_back(face);
    }

    bool touches_side(std::int32_t face, int k, Point p, Point q) const {
        return touch(mesh_.corner(face, (k + 1) % 3), mesh_.corner(face, (k + 2) % 3), p, q);
    }

    const Triangulated& mesh_;
    Passages& found_;
    Patience& patience_;
    std::vector<std::int32_t> seen_;  // the segment that reached each face last
    std::vector<std::int32_t> reached_;
};

}  // namespace

bool find_passages(const Triangulated& mesh, const Segments& segments, Passages& found,
                   Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    Patience patience(interrupt);
    PassageFinder finder(mesh, found, patience);
    for (std::size_t i = 0; i < segments.count && !patience.ends(); ++i) {
        const double* at = segments.ends + 4 * i;
        finder.run(static_cast<std::int32_t>(i), {at[0], at[1]}, {at[2], at[3]},
                   segments.starts[i]);
    }
    return !patience.ends(0);
}

}  // namespace liftmesh
