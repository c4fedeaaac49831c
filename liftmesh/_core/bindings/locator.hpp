// Point location as Python sees it.
#pragma once

#include "bindings/python.hpp"
#include "delaunay/locate.hpp"

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
