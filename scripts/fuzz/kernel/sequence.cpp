// Points and constraints that come and go as the bytes say: at every checkpoint the triangles are
// those of a fresh run, and, without constraints, canonical by integers of any length.
#include <algorithm>
#include <set>
#include <vector>

#include "changing.hpp"
#include "checks.hpp"
#include "demand.hpp"
#include "encodings.hpp"
#include "predicates/orient2d.hpp"
#include "scatter.hpp"
#include "targets.hpp"

namespace fuzzing {

namespace {

using liftmesh::Status;
using liftmesh::Vertex;

constexpr std::size_t most_steps = 250, most_present = 300, most_wide = 20, most_judged = 60;

class Sequence {
 public:
    explicit Sequence(Bytes& bytes) : bytes_(bytes), next_(encoding(bytes.byte(), bytes)) {}

    void run() {
        for (std::size_t step = 0; bytes_.left() && step < most_steps; ++step) {
            change(bytes_.byte());
            if (is_too_much()) break;
        }
        check();
        empty();
    }

 private:
    void change(unsigned what) {
        const unsigned size = what / 8;
        switch (what % 8) {
            case 0:
                return remove_some(1 + size / 4);
            case 1:
                return remove_batch(size);
            case 2:
                return insert_batch(some(1 + size), ~std::size_t{0});
            case 3:
                return insert_batch(block(2 + size % 8), size < 24 ? ~std::size_t{0} : size - 23);
            case 4:
                return check();
            case 5:
                return size % 4 == 0 ? remove_constraint() : insert_constraint();
            default:
                return insert(some(1));
        }
    }

    Point drawn() {
        const Point p = next_(bytes_);
        return liftmesh::is_finite(p) ? Point{p.x + 0.0, p.y + 0.0} : Point{0, 0};
    }
    std::vector<Point> some(std::size_t count) {
        std::vector<Point> points;
        while (points.size() < count) points.push_back(drawn());
        return points;
    }
    // A square of points, so many that all may be made anew; they lie on each other where the step
    // is lost in rounding.
    std::vector<Point> block(int side) {
        const Point p = drawn(), q = drawn();
        const Point step{(q.x - p.x) / 4, (q.y - p.y) / 4};
        std::vector<Point> points;
        for (int i = 0; i < side; ++i)
            for (int j = 0; j < side; ++j) {
                const Point at{p.x + i * step.x, p.y + j * step.y};
                points.push_back(liftmesh::is_finite(at) ? at : p);
            }
        return points;
    }

    void insert(const std::vector<Point>& points) {
        for (const Point p : points) {
            const Vertex v = mesh_.insert(p);
            demand(mesh_.is_present(v) && mesh_.point(v) == p, "a point is elsewhere");
            demand(mesh_.find(p) == v, "a point is not found");
            present_.insert(v);
        }
    }
    void insert_batch(const std::vector<Point>& points, std::size_t patience) {
        std::vector<Vertex> found(points.size());
        Impatient interrupt(patience);
        const Status status =
            mesh_.insert(liftmesh::dynamic::input_of(points), found.data(), interrupt);
        if (status == Status::interrupted) {
            demand(interrupt.was_requested(), "a batch was interrupted by nobody");
            return look_around();
        }
        for (std::size_t i = 0; i < points.size(); ++i) {
            demand(mesh_.is_present(found[i]) && mesh_.point(found[i]) == points[i],
                   "a point of a batch is elsewhere");
            present_.insert(found[i]);
        }
    }
    void remove_some(std::size_t count) {
        for (; count > 0 && !present_.empty(); --count) {
            const Vertex v = chosen(present_);
            release(v);
            mesh_.remove(v);
            demand(!mesh_.is_present(v), "a removed point is present");
            present_.erase(v);
        }
    }
    template <class Items>
    typename Items::value_type chosen(const Items& items) {
        return *std::next(items.begin(), static_cast<std::ptrdiff_t>(bytes_.byte() % items.size()));
    }
    // Without what a point is needed for.
    void release(Vertex v) {
        for (auto held = mesh_.holders(v); !held.empty(); held = mesh_.holders(v))
            for (const auto [a, b] : held) mesh_.remove_constraint(a, b);
    }
    void insert_constraint() {
        if (present_.empty()) return;
        const Vertex a = chosen(present_), b = chosen(present_);
        if (a == b) return;
        const auto crossed = mesh_.insert_constraint(a, b);
        for (const auto [c, d] : crossed)
            demand(cross(a, b, c, d), "an edge crosses what it does not");
        const bool is_there = mesh_.constraints().contains(liftmesh::dynamic::piece(a, b));
        demand(is_there == crossed.empty(), "a constraint crosses nothing, or is there");
    }
    bool cross(Vertex a, Vertex b, Vertex c, Vertex d) const {
        const auto side = [&](Vertex from, Vertex to, Vertex v) {
            return liftmesh::orient2d(mesh_.point(from), mesh_.point(to), mesh_.point(v));
        };
        return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
    }
    void remove_constraint() {
        if (mesh_.constraints().empty()) return;
        const auto [a, b] = chosen(mesh_.constraints().wholes());
        mesh_.remove_constraint(a, b);
    }
    // Every third one, or all but every third one, or all.
    void remove_batch(unsigned size) {
        std::vector<Vertex> gone;
        std::size_t i = size % 3;
        for (const Vertex v : present_)
            if (++i % 3 == 0 ? size % 4 < 2 : size % 4 > 0) gone.push_back(v);
        for (const Vertex v : gone) release(v);
        Impatient interrupt(size < 24 ? ~std::size_t{0} : size - 23);
        const Status status = mesh_.remove(gone.data(), gone.size(), interrupt);
        demand(status == Status::ok || interrupt.was_requested(),
               "a batch was interrupted by nobody");
        look_around();
        for (const Vertex v : gone)
            demand(status != Status::ok || !present_.contains(v), "a removed point is present");
    }

    // Which points are present after a batch.
    void look_around() {
        present_.clear();
        for (Vertex v = 0; v < mesh_.vertex_end(); ++v)
            if (mesh_.is_present(v)) present_.insert(v);
    }

    bool is_too_much() const {
        std::vector<Point> points;
        for (const Vertex v : present_) points.push_back(mesh_.point(v));
        return points.size() > (are_wide(points) ? most_wide : most_present);
    }

    void check() const {
        demand(mesh_.size() == present_.size(), "points are counted wrongly");
        compare_with_fresh(mesh_);
        if (present_.size() <= most_judged && mesh_.constraints().empty()) judge(mesh_);
    }

    void empty() {
        for (const Vertex v : present_) {
            release(v);
            mesh_.remove(v);
        }
        demand(mesh_.size() == 0 && mesh_.result().triangle_count == 0, "something is left");
    }

    Bytes& bytes_;
    Encoding next_;
    liftmesh::dynamic::Triangulation mesh_;
    std::set<Vertex> present_;
};

}  // namespace

void check_sequence(Bytes bytes) {
    Sequence(bytes).run();
}

}  // namespace fuzzing
