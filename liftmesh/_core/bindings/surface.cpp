// The Python interface of surfaces.

#include "bindings/locator.hpp"
#include "bindings/python.hpp"
#include "surface/contours.hpp"
#include "surface/overlay.hpp"
#include "surface/overlay_mesh.hpp"
#include "surface/passage.hpp"
#include "surface/relief.hpp"
#include "surface/rim.hpp"
#include "surface/sample.hpp"

namespace bindings {

namespace {

using Flags = Array<const std::uint8_t>;
using HeightColumn = nb::ndarray<const double, nb::ndim<1>, nb::device::cpu>;
using Doubles = Array<double>;
using DoublePairs = Array<double, 2>;

using Triangles = Array<const double, 3, 2>;
using Pixels = nb::ndarray<nb::ndim<3>, nb::c_contig, nb::device::cpu>;

const std::uint8_t* flags(const std::optional<Flags>& given, std::size_t count) {
    if (!given) return nullptr;
    if (given->shape(0) != count) throw std::invalid_argument("lengths differ");
    return given->data();
}

liftmesh::Natural natural_named(std::string_view method) {
    if (method == "linear") return liftmesh::Natural::linear;
    if (method == "nearest") return liftmesh::Natural::nearest;
    if (method == "nearest beyond") return liftmesh::Natural::nearest_beyond;
    if (method == "laplace") return liftmesh::Natural::laplace;
    if (method == "sibson") return liftmesh::Natural::sibson;
    throw std::invalid_argument("unknown method");
}

// Keeps the arrays it reads alive.
class PyRelief {
 public:
    PyRelief(PlanarRows points, Triples simplices, Triples neighbors, HeightColumn heights,
             std::optional<Flags> left_out)
        : points_(std::move(points)),
          simplices_(std::move(simplices)),
          neighbors_(std::move(neighbors)),
          heights_(std::move(heights)),
          left_out_(std::move(left_out)),
          relief_(mesh(), read_heights(), flags(left_out_, simplices_.shape(0))) {}

    void sample(PyLocator& locator, const Pairs& queries, const Doubles& heights,
                std::string_view method, unsigned threads, bool shared) const {
        if (queries.shape(0) != heights.shape(0)) throw std::invalid_argument("lengths differ");
        const liftmesh::Queries given{queries.data(), queries.shape(0)};
        const liftmesh::Threads limit{threads, shared};
        run_unlocked([&](auto& interrupt) {
            if (method == "linear")
                return sample_heights(relief_, locator.locator(), given, heights.data(), limit,
                                      interrupt);
            return sample_natural(relief_, locator.locator(), given, natural_named(method),
                                  heights.data(), limit, interrupt);
        });
    }

    // Starts, rows and weights of each query; None if rows were written since they were
    // triangulated.
    nb::object weights(PyLocator& locator, const Pairs& queries, std::string_view method,
                       unsigned threads, bool shared) const {
        liftmesh::PointWeights found;
        run_unlocked([&](auto& interrupt) {
            return sample_weights(relief_, locator.locator(), {queries.data(), queries.shape(0)},
                                  natural_named(method), found, {threads, shared}, interrupt);
        });
        if (!found.is_sound) return nb::none();
        return nb::make_tuple(as_array(found.starts), as_array(found.rows),
                              as_array(found.weights));
    }

    void gradients(PyLocator& locator, const Pairs& queries, const DoublePairs& gradients,
                   unsigned threads, bool shared) const {
        if (queries.shape(0) != gradients.shape(0)) throw std::invalid_argument("lengths differ");
        run_unlocked([&](auto& interrupt) {
            return sample_gradients(relief_, locator.locator(), {queries.data(), queries.shape(0)},
                                    gradients.data(), {threads, shared}, interrupt);
        });
    }

    void owners(PyLocator& locator, const Pairs& queries, const Array<std::int32_t>& faces,
                unsigned threads, bool shared) const {
        if (queries.shape(0) != faces.shape(0)) throw std::invalid_argument("lengths differ");
        run_unlocked([&](auto& interrupt) {
            return sample_owners(relief_, locator.locator(), {queries.data(), queries.shape(0)},
                                 faces.data(), {threads, shared}, interrupt);
        });
    }

    // Fills rows x columns x 1: heights as float64 or float32, or the owners as int32; or x 2: the
    // gradients as float64.
    void scan(PyLocator& locator, const std::array<double, 6>& transform, std::int32_t first_row,
              const Pixels& pixels, unsigned threads, bool shared) const {
        const auto [a, b, c, d, e, f] = transform;
        const auto side = [&](std::size_t axis) {
            if (pixels.shape(axis) == 0 || pixels.shape(axis) > most_pixels)
                throw std::invalid_argument("too many pixels, or none");
            return static_cast<std::int32_t>(pixels.shape(axis));
        };
        const liftmesh::Grid grid{a, b, c, d, e, f, first_row, side(0), side(1)};
        const liftmesh::Threads limit{threads, shared};
        run_unlocked([&](auto& interrupt) {
            const auto fill = [&](auto scan_all, auto* out) {
                return scan_all(relief_, locator.locator(), grid, out, limit, interrupt);
            };
            const auto heights = [](auto&&... given) { return liftmesh::scan_heights(given...); };
            const bool single = pixels.shape(2) == 1;
            if (single && pixels.dtype() == nb::dtype<double>())
                return fill(heights, static_cast<double*>(pixels.data()));
            if (single && pixels.dtype() == nb::dtype<float>())
                return fill(heights, static_cast<float*>(pixels.data()));
            if (single && pixels.dtype() == nb::dtype<std::int32_t>())
                return fill(liftmesh::scan_owners, static_cast<std::int32_t*>(pixels.data()));
            if (pixels.shape(2) == 2 && pixels.dtype() == nb::dtype<double>())
                return fill(liftmesh::scan_gradients, static_cast<double*>(pixels.data()));
            throw std::invalid_argument("unknown type of pixels");
        });
    }

    nb::tuple contours(const Numbers& levels, unsigned threads, bool shared) const {
        liftmesh::Contours found;
        run_unlocked([&](auto& interrupt) {
            return liftmesh::contours(relief_, levels.data(), levels.shape(0), found,
                                      {threads, shared}, interrupt);
        });
        auto points = liftmesh::reuse<double>(std::move(found.points));
        const auto count = static_cast<std::size_t>(found.starts.back());
        return nb::make_tuple(adopt(std::move(points), count, 2), as_array(found.starts),
                              as_array(found.levels), as_array(found.is_closed));
    }

    // NaN if a height of a face is not finite.
    nb::tuple height_range(unsigned threads, bool shared) const {
        liftmesh::HeightRange found;
        run_unlocked([&](auto& interrupt) {
            return liftmesh::height_range(relief_, found, {threads, shared}, interrupt);
        });
        return nb::make_tuple(found.least, found.greatest);
    }

    // From this surface to another one: above, below and area. The faces touch each other.
    nb::tuple between(const PyRelief& other, std::int32_t face, std::int32_t touching) const {
        check_face(face);
        other.check_face(touching);
        liftmesh::Between found{};
        run_unlocked([&](auto& interrupt) {
            return liftmesh::between(relief_, other.relief_, face, touching, found, interrupt);
        });
        return nb::make_tuple(found.above, found.below, found.area);
    }

    // The overlay as a mesh: points and rises over the other surface, triangles with neighbours and
    // constrained sides, how many rows are crossings, and their displacement. None if it is not
    // sound.
    nb::object overlay(const PyRelief& other, std::int32_t face, std::int32_t touching,
                       unsigned threads, bool shared, nb::handle progress) const {
        check_face(face);
        other.check_face(touching);
        liftmesh::OverlayMesh found;
        run_unlocked(
            [&](auto& interrupt) {
                return liftmesh::overlay_mesh(relief_, other.relief_, face, touching, found,
                                              {threads, shared}, interrupt);
            },
            progress);
        if (!found.is_sound) return nb::none();
        return nb::make_tuple(
            adopt(liftmesh::reuse<double>(std::move(found.points)), found.rows, 2),
            adopt(std::move(found.rises), found.rows, 1),
            adopt(std::move(found.simplices), found.triangles, 3),
            adopt(std::move(found.neighbors), found.triangles, 3),
            adopt(std::move(found.bits), found.triangles, 1), found.crossings, found.displacement);
    }

    // The same in triangles that do not overlap, each with a face of both that it touches.
    nb::tuple between_within(const PyRelief& other, const Triangles& parts, const Ids& faces,
                             const Ids& touching) const {
        const std::size_t count = parts.shape(0);
        if (faces.shape(0) != count || touching.shape(0) != count)
            throw std::invalid_argument("lengths differ");
        for (std::size_t i = 0; i < count; ++i) {
            check_face(faces.data()[i]);
            other.check_face(touching.data()[i]);
        }
        liftmesh::Between found{};
        run_unlocked([&](auto& interrupt) {
            return liftmesh::between_within(relief_, other.relief_,
                                            {parts.data(), faces.data(), touching.data(), count},
                                            found, interrupt);
        });
        return nb::make_tuple(found.above, found.below, found.area);
    }

 private:
    void check_face(std::int32_t simplex) const {
        if (simplex < 0 || static_cast<std::size_t>(simplex) >= simplices_.shape(0))
            throw std::invalid_argument("there is no such face");
    }
    static constexpr std::size_t most_pixels = std::size_t{1} << 30;  // a side

    liftmesh::Triangulated mesh() const {
        return {read(points_), simplices_.data(), neighbors_.data(), simplices_.shape(0)};
    }
    liftmesh::Heights read_heights() const {
        if (heights_.shape(0) != points_.shape(0)) throw std::invalid_argument("lengths differ");
        return {reinterpret_cast<const std::byte*>(heights_.data()),
                heights_.stride(0) * static_cast<std::ptrdiff_t>(sizeof(double))};
    }

    PlanarRows points_;
    Triples simplices_, neighbors_;
    HeightColumn heights_;
    std::optional<Flags> left_out_;
    liftmesh::Relief relief_;
};

using FlagTriples = Array<const std::uint8_t, 3>;

void leave_out_from_rim(const Triples& neighbors, const FlagTriples& is_long,
                        const ChangingFlags& left_out) {
    const std::size_t count = neighbors.shape(0);
    if (is_long.shape(0) != count || left_out.shape(0) != count)
        throw std::invalid_argument("lengths differ");
    run_unlocked([&](auto& interrupt) {
        return liftmesh::leave_out_from_rim(neighbors.data(), count, is_long.data(),
                                            left_out.data(), interrupt);
    });
}

nb::tuple rings(const PlanarRows& points, const Triples& simplices, const Triples& neighbors,
                const std::optional<Flags>& left_out) {
    const liftmesh::Triangulated mesh{read(points), simplices.data(), neighbors.data(),
                                      simplices.shape(0)};
    liftmesh::Rings found;
    run_unlocked([&](auto& interrupt) {
        return liftmesh::rings(mesh, {flags(left_out, mesh.count)}, found, interrupt);
    });
    return nb::make_tuple(as_array(found.rows), as_array(found.starts));
}

// Which segments touch which triangles, from one of these; -1 if there is none.
nb::tuple passages(const PlanarRows& points, const Triples& simplices, const Triples& neighbors,
                   const Array<const double, 4>& ends, const Ids& starts) {
    const liftmesh::Triangulated mesh{read(points), simplices.data(), neighbors.data(),
                                      simplices.shape(0)};
    const std::size_t count = starts.shape(0);
    if (ends.shape(0) != count) throw std::invalid_argument("lengths differ");
    for (std::size_t i = 0; i < count; ++i)
        if (starts.data()[i] >= 0 && static_cast<std::size_t>(starts.data()[i]) >= mesh.count)
            throw std::invalid_argument("there is no such face");
    liftmesh::Passages found;
    run_unlocked([&](auto& interrupt) {
        return liftmesh::find_passages(mesh, {ends.data(), starts.data(), count}, found, interrupt);
    });
    return nb::make_tuple(as_array(found.segments), as_array(found.faces));
}

}  // namespace

void bind_surface(nb::module_& m) {
    m.def("leave_out_from_rim", &leave_out_from_rim, "neighbors"_a, "is_long"_a, "left_out"_a);
    m.def("rings", &rings, "points"_a, "simplices"_a, "neighbors"_a, "left_out"_a.none());
    m.def("passages", &passages, "points"_a, "simplices"_a, "neighbors"_a, "ends"_a, "starts"_a);
    nb::class_<PyRelief>(m, "Relief")
        .def(nb::init<PlanarRows, Triples, Triples, HeightColumn, std::optional<Flags>>(),
             "points"_a, "simplices"_a, "neighbors"_a, "heights"_a, "left_out"_a.none())
        .def("sample", &PyRelief::sample, "locator"_a, "queries"_a, "heights"_a, "method"_a,
             "threads"_a, "shared"_a)
        .def("weights", &PyRelief::weights, "locator"_a, "queries"_a, "method"_a, "threads"_a,
             "shared"_a)
        .def("gradients", &PyRelief::gradients, "locator"_a, "queries"_a, "gradients"_a,
             "threads"_a, "shared"_a)
        .def("owners", &PyRelief::owners, "locator"_a, "queries"_a, "faces"_a, "threads"_a,
             "shared"_a)
        .def("between", &PyRelief::between, "other"_a, "face"_a, "touching"_a)
        .def("overlay", &PyRelief::overlay, "other"_a, "face"_a, "touching"_a, "threads"_a,
             "shared"_a, "progress"_a.none())
        .def("between_within", &PyRelief::between_within, "other"_a, "parts"_a, "faces"_a,
             "touching"_a)
        .def("height_range", &PyRelief::height_range, "threads"_a, "shared"_a)
        .def("contours", &PyRelief::contours, "levels"_a, "threads"_a, "shared"_a)
        .def("scan", &PyRelief::scan, "locator"_a, "transform"_a, "first_row"_a, "pixels"_a,
             "threads"_a, "shared"_a);
}

}  // namespace bindings
