#include "dynamic/constraints.hpp"

namespace liftmesh::dynamic {

void Constraints::add(Piece whole, const std::vector<Piece>& pieces) {
    try {
        wholes_.insert(whole);
        for (const Piece each : pieces) parts_.insert({each, whole});
    } catch (...) {
        remove(whole, pieces);
        throw;
    }
}

void Constraints::remove(Piece whole, const std::vector<Piece>& pieces) noexcept {
    wholes_.erase(whole);
    for (const Piece each : pieces) parts_.erase({each, whole});
}

void Constraints::split(Piece both, Vertex v) {
    const Piece one = piece(both.first, v), other = piece(v, both.second);
    try {
        for_each(both, [&](Piece whole) { parts_.insert({one, whole}); });
    } catch (...) {
        erase(one);
        throw;
    }
    rename(both, other);
}

void Constraints::unite(Vertex a, Vertex between, Vertex b) noexcept {
    erase(piece(a, between));
    rename(piece(between, b), piece(a, b));
}

void Constraints::erase(Piece each) noexcept {
    for (auto at = first_of(each); at != parts_.end(); at = first_of(each)) parts_.erase(at);
}

void Constraints::rename(Piece before, Piece after) noexcept {
    for (auto at = first_of(before); at != parts_.end(); at = first_of(before))
        put(parts_.extract(at), after);
}

}  // namespace liftmesh::dynamic
