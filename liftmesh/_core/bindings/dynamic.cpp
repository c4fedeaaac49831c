// Triangulations that take points in and out, for Python.

#include "bindings/python.hpp"
#include "dynamic/triangulation.hpp"
#include "simplification/simplify.hpp"

namespace bindings {

namespace {

using liftmesh::Status;
using liftmesh::Vertex;

using liftmesh::dynamic::Piece;
using Edges = Array<const std::int32_t, 2>;

// Its caller sees to it that no two calls run at once, that rows are finite, vertices there, and
// ends of constraints distinct.
class DynamicMesh {
 public:
    void insert(const PlanarRows& rows, const ChangingIds& found) {
        const Input input = read(rows);
        if (input.rows != found.shape(0)) throw std::invalid_argument("lengths differ");
        auto* vertices = reinterpret_cast<Vertex*>(found.data());
        run([&](liftmesh::Interrupt& stop) { return mesh_.insert(input, vertices, stop); });
    }

    void remove(const ChangingIds& numbers) {
        const auto* vertices = reinterpret_cast<const Vertex*>(numbers.data());
        run([&](liftmesh::Interrupt& stop) {
            return mesh_.remove(vertices, numbers.shape(0), stop);
        });
    }

    // Puts in one after the other, up to one that crosses others: how many are in, and the others.
    nb::tuple insert_constraints(const Edges& edges) {
        std::size_t done = 0;
        std::vector<Piece> crossed;
        run([&](liftmesh::Interrupt& stop) {
            liftmesh::Patience patience(stop);
            for (; done < edges.shape(0); ++done) {
                if (patience.ends(64)) return Status::interrupted;
                const std::int32_t* ends = edges.data() + 2 * done;
                crossed = mesh_.insert_constraint(static_cast<Vertex>(ends[0]),
                                                  static_cast<Vertex>(ends[1]));
                if (!crossed.empty()) break;
            }
            return Status::ok;
        });
        return nb::make_tuple(done, array_of<std::int32_t>(crossed));
    }

    // False if there is none.
    bool remove_constraint(Vertex a, Vertex b) {
        if (!mesh_.constraints().contains(liftmesh::dynamic::piece(a, b))) return false;
        run([&](liftmesh::Interrupt&) {
            mesh_.remove_constraint(a, b);
            return Status::ok;
        });
        return true;
    }

    // The first place of a number that constraints hold, and these.
    nb::tuple first_held(const ChangingIds& numbers) const {
        std::size_t i = 0;
        std::vector<Piece> holders;
        if (!mesh_.constraints().empty())
            for (; i < numbers.shape(0) && holders.empty(); ++i)
                holders = mesh_.holders(static_cast<Vertex>(numbers.data()[i]));
        return nb::make_tuple(i - !holders.empty(), array_of<std::int32_t>(holders));
    }

    // All; their pieces, and those of each piece: starts and members.
    nb::tuple constraints() const {
        const auto& all = mesh_.constraints();
        const std::vector<Piece> wholes(all.wholes().begin(), all.wholes().end());
        std::vector<Piece> pieces;
        std::vector<std::int32_t> starts, members;
        for (const auto& [piece, whole] : all.parts()) {
            if (pieces.empty() || pieces.back() != piece) {
                pieces.push_back(piece);
                starts.push_back(static_cast<std::int32_t>(members.size()));
            }
            const auto at = std::lower_bound(wholes.begin(), wholes.end(), whole);
            members.push_back(static_cast<std::int32_t>(at - wholes.begin()));
        }
        starts.push_back(static_cast<std::int32_t>(members.size()));
        return nb::make_tuple(array_of<std::int32_t>(wholes), array_of<std::int32_t>(pieces),
                              as_array(starts), as_array(members));
    }

    // Of each triangle: bit k, whether the edge opposite vertex k is a constraint.
    nb::object marks() const { return as_array(mesh_.marks()); }

    // The vertex at each position, or -1.
    void find(const Pairs& positions, const ChangingIds& found) const {
        run([&](liftmesh::Interrupt& stop) {
            Vertex last = liftmesh::ghost;
            const auto look = [&](std::size_t i) {
                const Point p = point(positions, i);
                const Vertex v = mesh_.find({p.x + 0.0, p.y + 0.0}, last);
                found.data()[i] = static_cast<std::int32_t>(v);
                if (v != liftmesh::ghost) last = v;
            };
            return liftmesh::for_each_in_blocks(found.shape(0), stop, look) ? Status::ok
                                                                            : Status::interrupted;
        });
    }

    std::size_t count() const { return mesh_.size(); }
    std::size_t end() const { return mesh_.vertex_end(); }

    // The place of the first number without a vertex; -1 if there is none.
    std::ptrdiff_t first_absent(const ChangingIds& numbers) const {
        for (std::size_t i = 0; i < numbers.shape(0); ++i)
            if (!mesh_.is_present(static_cast<Vertex>(numbers.data()[i])))
                return static_cast<std::ptrdiff_t>(i);
        return -1;
    }

    // The position of each number; NaN where it has no vertex.
    nb::object points() const {
        const double nan = std::numeric_limits<double>::quiet_NaN();
        auto values = liftmesh::allocate<double>(2 * mesh_.vertex_end());
        for (Vertex v = 0; v < mesh_.vertex_end(); ++v) {
            const Point p = mesh_.is_present(v) ? mesh_.point(v) : Point{nan, nan};
            values[2 * std::size_t{v}] = p.x;
            values[2 * std::size_t{v} + 1] = p.y;
        }
        return adopt(std::move(values), mesh_.vertex_end(), 2);
    }

    nb::tuple triangles() const {
        auto result = unlocked(nb::none(), [&](auto&) { return mesh_.result(); });
        auto [simplices, neighbors, hull] = arrays(result);
        return nb::make_tuple(simplices, neighbors, hull);
    }

 private:
    // call(interrupt) without the GIL.
    template <class Call>
    static void run(Call call) {
        raise_if(unlocked(nb::none(), call) == Status::interrupted);
    }

    liftmesh::dynamic::Triangulation mesh_;
};

// The rows that stay, whether no sample exceeds the tolerance, and how many vertices there were
// before the last pass.
template <class Run>
nb::tuple simplified(const Pairs& points, const Numbers& heights, const Ids& hull,
                     const std::int32_t* edges, std::size_t edge_count, nb::handle progress,
                     Run run) {
    if (points.shape(0) != heights.shape(0)) throw std::invalid_argument("lengths differ");
    const liftmesh::simplification::Terrain terrain{
        reinterpret_cast<const Point*>(points.data()),
        heights.data(),
        heights.shape(0),
        hull.data(),
        hull.shape(0),
        edges,
        edge_count,
    };
    auto found = unlocked(progress, [&](auto& interrupt) { return run(terrain, interrupt); });
    raise_if(found.status == liftmesh::Status::interrupted);
    return nb::make_tuple(skipped(found.rows), found.is_within, found.inserted);
}

nb::tuple simplify(const Pairs& points, const Numbers& heights, const Ids& hull, const Edges& edges,
                   double tolerance, std::size_t most, bool prunes, nb::handle progress) {
    const auto run = [&](const auto& terrain, auto& interrupt) {
        return liftmesh::simplification::simplify(terrain, tolerance, most, prunes, interrupt);
    };
    return simplified(points, heights, hull, edges.data(), edges.shape(0), progress, run);
}

nb::tuple thin(const Pairs& points, const Numbers& heights, const Ids& hull, std::size_t most,
               nb::handle progress) {
    const auto run = [&](const auto& terrain, auto& interrupt) {
        return liftmesh::simplification::thin(terrain, most, interrupt);
    };
    return simplified(points, heights, hull, nullptr, 0, progress, run);
}

}  // namespace

void bind_dynamic(nb::module_& m) {
    m.def("simplify", &simplify, "points"_a, "heights"_a, "hull"_a, "edges"_a, "tolerance"_a,
          "most"_a, "prunes"_a, "progress"_a.none());
    m.def("thin", &thin, "points"_a, "heights"_a, "hull"_a, "most"_a, "progress"_a.none());
    nb::class_<DynamicMesh>(m, "DynamicMesh")
        .def(nb::init<>())
        .def("insert", &DynamicMesh::insert, "rows"_a, "found"_a)
        .def("remove", &DynamicMesh::remove, "numbers"_a)
        .def("insert_constraints", &DynamicMesh::insert_constraints, "edges"_a)
        .def("remove_constraint", &DynamicMesh::remove_constraint, "a"_a, "b"_a)
        .def("first_held", &DynamicMesh::first_held, "numbers"_a)
        .def("constraints", &DynamicMesh::constraints)
        .def("marks", &DynamicMesh::marks)
        .def("find", &DynamicMesh::find, "positions"_a, "found"_a)
        .def("count", &DynamicMesh::count)
        .def("end", &DynamicMesh::end)
        .def("first_absent", &DynamicMesh::first_absent, "numbers"_a)
        .def("points", &DynamicMesh::points)
        .def("triangles", &DynamicMesh::triangles);
}

}  // namespace bindings
