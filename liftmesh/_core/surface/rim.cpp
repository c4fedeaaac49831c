#include "surface/rim.hpp"

namespace liftmesh {

namespace {

struct Side {
    std::int32_t face;
    int k;  // the corner opposite
};

class RingFinder {
 public:
    RingFinder(const Triangulated& mesh, Shown shown, Patience& patience)
        : mesh_(mesh),
          shown_(shown),
          patience_(patience),
          is_done_(3 * mesh.count),
          place_(mesh.points.rows, -1) {}

    void run() {
        const auto count = static_cast<std::int32_t>(mesh_.count);
        for (std::int32_t face = 0; face < count && !patience_.ends(); ++face)
            for (int k = 0; k < 3; ++k)
                if (is_rim({face, k}) && !is_done(face, k)) follow({face, k});
    }

    std::vector<std::vector<std::int32_t>> found;

 private:
    bool is_rim(Side side) const {
        return shown_.has(side.face) && !shown_.has(mesh_.neighbor(side.face, side.k));
    }
    std::vector<bool>::reference is_done(std::int32_t face, int k) {
        return is_done_[3 * static_cast<std::size_t>(face) + static_cast<std::size_t>(k)];
    }

    // Goes around one curve; a loop that comes back to a vertex is a ring of its own.
    void follow(Side side) {
        std::vector<std::int32_t> path;
        for (; !is_done(side.face, side.k) && !patience_.ends(); side = next(side)) {
            is_done(side.face, side.k) = true;
            const std::int32_t tail = mesh_.vertex(side.face, (side.k + 1) % 3);
            if (const std::int32_t place = at(tail); place >= 0) cut(path, place);
            at(tail) = static_cast<std::int32_t>(path.size());
            path.push_back(tail);
        }
        cut(path, 0);
    }

    // Makes a ring of the end of a path.
    void cut(std::vector<std::int32_t>& path, std::int32_t first) {
        found.emplace_back(path.begin() + first, path.end());
        for (const std::int32_t row : found.back()) at(row) = -1;
        path.resize(static_cast<std::size_t>(first));
    }

    // The side of the rim that leaves the head of another one, in the same fan of faces.
    Side next(Side side) {
        const std::int32_t pivot = mesh_.vertex(side.face, (side.k + 2) % 3);
        Side leaving{side.face, (side.k + 1) % 3};
        while (!is_rim(leaving) && !patience_.ends()) {
            const std::int32_t face = mesh_.neighbor(leaving.face, leaving.k);
            const int corner = mesh_.vertex(face, 0) == pivot   ? 0
                               : mesh_.vertex(face, 1) == pivot ? 1
                                                                : 2;
            leaving = {face, (corner + 2) % 3};
        }
        return leaving;
    }

    std::int32_t& at(std::int32_t row) { return place_[static_cast<std::size_t>(row)]; }

    const Triangulated& mesh_;
    Shown shown_;
    Patience& patience_;
    std::vector<bool> is_done_;
    std::vector<std::int32_t> place_;  // in the present path
};

using Ring = std::vector<std::int32_t>;

// A copy, as other threads may write the rows while they are sorted; it can be compared even if
// they put NaN there.
Point place(const Triangulated& mesh, std::int32_t row) {
    const Point p = mesh.points[static_cast<std::size_t>(row)];
    return {p.x == p.x ? p.x : 0, p.y == p.y ? p.y : 0};
}

// Where a ring begins.
struct Start {
    Point first, second;
    const Ring* ring;

    bool operator<(const Start& other) const {
        return before_xy(first, other.first) ||
               (!before_xy(other.first, first) && before_xy(second, other.second));
    }
};

Ring::iterator least_of(const Triangulated& mesh, Ring& ring) {
    return std::min_element(ring.begin(), ring.end(), [&](std::int32_t p, std::int32_t q) {
        return before_xy(place(mesh, p), place(mesh, q));
    });
}

}  // namespace

bool leave_out_from_rim(const std::int32_t* neighbors, std::size_t count,
                        const std::uint8_t* is_long, std::uint8_t* left_out, Interrupt& interrupt) {
    Patience patience(interrupt);
    const auto is_gone = [&](std::int32_t face) { return face < 0 || left_out[face] != 0; };
    const auto is_due = [&](std::int32_t face) {
        for (std::ptrdiff_t i = 3 * std::ptrdiff_t{face}; i < 3 * std::ptrdiff_t{face} + 3; ++i)
            if (is_long[i] && is_gone(neighbors[i])) return true;
        return false;
    };
    std::vector<std::int32_t> pending(count);
    std::iota(pending.begin(), pending.end(), 0);
    while (!pending.empty() && !patience.ends()) {
        const std::int32_t face = pending.back();
        pending.pop_back();
        if (is_gone(face) || !is_due(face)) continue;
        left_out[face] = 1;
        for (int k = 0; k < 3; ++k) {
            const std::int32_t other = neighbors[3 * std::ptrdiff_t{face} + k];
            if (!is_gone(other)) pending.push_back(other);
        }
    }
    return !patience.ends(0) && pending.empty();
}

bool rings(const Triangulated& mesh, Shown shown, Rings& found, Interrupt& interrupt) {
    Patience patience(interrupt);
    RingFinder finder(mesh, shown, patience);
    finder.run();
    if (patience.ends(0)) return false;
    std::vector<Start> order;
    for (auto& ring : finder.found) {
        const auto least = least_of(mesh, ring);
        std::rotate(ring.begin(), least, ring.end());
        order.push_back({place(mesh, ring[0]), place(mesh, ring[1]), &ring});
    }
    std::sort(order.begin(), order.end());
    found.starts = {0};
    for (const Start& each : order) {
        found.rows.insert(found.rows.end(), each.ring->begin(), each.ring->end());
        found.starts.push_back(static_cast<std::int64_t>(found.rows.size()));
    }
    return !patience.ends(0);
}

}  // namespace liftmesh
