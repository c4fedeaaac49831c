// Point location as Python sees it.
#pragma once

#include "bindings/python.hpp"
#include "delaunay/locate.hpp"
#include "surface/natural.hpp"

namespace bindings {

// Keeps the arrays it reads alive.
class PyLocator {
 public:
    PyLocator(PlanarRows points, Triples simplices, Triples neighbors)
        : points_(std::move(points)),
          simplices_(std::move(simplices)),
          neighbors_(std::move(neighbors)),
          locator_(make()) {}

    liftmesh::Locator& locator() { return locator_; }

    void find(const Pairs& queries, const ChangingIds& found, unsigned threads, bool shared) {
        if (queries.shape(0) != found.shape(0)) throw std::invalid_argument("lengths differ");
        run_unlocked([&](auto& interrupt) {
            return locator_.find({queries.data(), queries.shape(0)}, found.data(),
                                 {threads, shared}, interrupt);
        });
    }

    // Starts, rows and weights of the natural neighbours of each query; None if rows were written
    // since they were triangulated.
    nb::object natural_weights(const Pairs& queries, unsigned threads, bool shared) {
        const liftmesh::Queries given{queries.data(), queries.shape(0)};
        const liftmesh::Threads limit{threads, shared};
        liftmesh::NaturalWeights found;
        run_unlocked([&](auto& interrupt) {
            const auto simplices = liftmesh::allocate<std::int32_t>(given.count);
            return locator_.find(given, simplices.get(), limit, interrupt) &&
                   liftmesh::natural_weights(locator_.mesh(), given, simplices.get(), found, limit,
                                             interrupt);
        });
        if (!found.is_sound) return nb::none();
        return nb::make_tuple(as_array(found.starts), as_array(found.rows),
                              as_array(found.weights));
    }

 private:
    liftmesh::Locator make() const {
        const liftmesh::Triangulated triangulated{read(points_), simplices_.data(),
                                                  neighbors_.data(), simplices_.shape(0)};
        const nb::gil_scoped_release unlocked;
        return liftmesh::Locator(triangulated, new_secret());
    }

    PlanarRows points_;
    Triples simplices_, neighbors_;
    liftmesh::Locator locator_;
};

}  // namespace bindings
