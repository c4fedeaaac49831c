// What verifiers have found, as Python lists.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>

#include "bindings.hpp"
#include "verify/flaws.hpp"

namespace bindings {

// The count and the first places of each kind of flaw, in the order of the enumeration.
template <class Kind>
nb::list as_list(const liftmesh::FlawsOf<Kind>& flaws) {
    nb::list kinds;
    for (std::size_t kind = 0; kind < static_cast<std::size_t>(Kind::kinds); ++kind) {
        const liftmesh::FlawPlaces& places = flaws[static_cast<Kind>(kind)];
        nb::list first;
        for (const liftmesh::FlawPlace& place : places.first())
            first.append(nb::make_tuple(place.at, place.other));
        kinds.append(nb::make_tuple(places.count(), first));
    }
    return kinds;
}

}  // namespace bindings
