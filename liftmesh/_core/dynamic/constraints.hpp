// The constraints of a triangulation that changes: edges between vertices, which must be in it as a
// whole or in pieces; and for each piece all constraints that it is part of.
#pragma once

#include <set>

#include "constrained/constrained.hpp"

namespace liftmesh::dynamic {

using constrained::Piece;

inline Piece piece(Vertex a, Vertex b) {
    return {std::min(a, b), std::max(a, b)};
}

// A piece, and a constraint that it is part of.
struct Part {
    Piece piece, whole;
    auto operator<=>(const Part&) const = default;
};

class Constraints {
 public:
    using Parts = std::set<Part>;

    bool empty() const { return wholes_.empty(); }
    bool contains(Piece whole) const { return wholes_.contains(whole); }
    const std::set<Piece>& wholes() const { return wholes_; }
    const Parts& parts() const { return parts_; }

    bool has(Piece each) const { return first_of(each) != parts_.end(); }
    // Calls visit(whole) for each constraint that a piece is part of.
    template <class Visit>
    void for_each(Piece of, Visit visit) const {
        for (auto at = first_of(of); at != parts_.end() && at->piece == of; ++at) visit(at->whole);
    }

    // Where memory fails, these change nothing.
    void add(Piece whole, const std::vector<Piece>& pieces);
    void split(Piece both, Vertex v);

    // These take no memory.
    void remove(Piece whole, const std::vector<Piece>& pieces) noexcept;
    void unite(Vertex a, Vertex between, Vertex b) noexcept;
    // Takes all parts anew, whose pieces get other numbers.
    template <class Number>
    void renew(Parts& fresh, Number number) noexcept {
        parts_.clear();
        while (!fresh.empty()) {
            const Piece old = fresh.begin()->piece;
            put(fresh.extract(fresh.begin()), piece(number(old.first), number(old.second)));
        }
    }

 private:
    Parts::const_iterator first_of(Piece each) const {
        const auto at = parts_.lower_bound({each, {}});
        return at != parts_.end() && at->piece == each ? at : parts_.end();
    }
    void put(Parts::node_type part, Piece name) noexcept {
        part.value().piece = name;
        parts_.insert(std::move(part));
    }
    void erase(Piece each) noexcept;
    void rename(Piece before, Piece after) noexcept;

    std::set<Piece> wholes_;
    Parts parts_;
};

}  // namespace liftmesh::dynamic
