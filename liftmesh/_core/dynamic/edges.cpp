// Constraints of a changing triangulation: put in as in one under construction
// (constrained/insertion.hpp), and taken out piece by piece (release.hpp).

#include "constrained/insertion.hpp"
#include "dynamic/release.hpp"
#include "dynamic/triangulation.hpp"

namespace liftmesh::dynamic {

namespace {

template <class Item>
void keep_distinct(std::vector<Item>& items) {
    std::sort(items.begin(), items.end());
    items.erase(std::unique(items.begin(), items.end()), items.end());
}

}  // namespace

std::vector<Piece> pieces_between(const Line& line, Point a, Point b) {
    std::vector<Piece> found;
    if (before_xy(b, a)) std::swap(a, b);
    for (auto at = line.find(a); at->first != b;) {
        const Vertex from = at->second;
        found.push_back(piece(from, (++at)->second));
    }
    return found;
}

constrained::Insertion Triangulation::insertion() {
    return {slots_.ground(points_.data(), corner_.data()), slots_.marks(), guard_};
}

std::vector<Piece> Triangulation::insert_constraint(Vertex a, Vertex b) {
    const Piece whole = piece(a, b);
    if (constraints_.contains(whole)) return {};
    if (!has_triangles()) {
        constraints_.add(whole, pieces_between(line_, points_[a], points_[b]));
        return {};
    }
    slots_.keep_marks();
    constrained::Insertion insertion = this->insertion();
    std::vector<Piece> pieces, crossed;
    insertion.follow(a, b, [&](auto span, const auto& edges, const auto& triangles) {
        pieces.push_back(piece(span.from, span.to));
        insertion.reserve(triangles.size());
        for (const Edge e : edges)
            constraints_.for_each(piece(slots_.tail(e), slots_.head(e)),
                                  [&](Piece each) { crossed.push_back(each); });
    });
    keep_distinct(crossed);
    if (!crossed.empty()) return crossed;
    constraints_.add(whole, pieces);
    insertion.insert(a, b, [](auto, const auto&) {});
    return {};
}

void Triangulation::remove_constraint(Vertex a, Vertex b) {
    const Piece whole = piece(a, b);
    if (!has_triangles()) {
        constraints_.remove(whole, pieces_between(line_, points_[a], points_[b]));
        return;
    }
    constrained::Insertion insertion = this->insertion();
    std::vector<Piece> pieces, free;
    insertion.follow(a, b, [&](auto span, const auto&, const auto&) {
        std::size_t wholes = 0;
        pieces.push_back(piece(span.from, span.to));
        constraints_.for_each(pieces.back(), [&](Piece) { ++wholes; });
        if (wholes == 1) free.push_back(pieces.back());
    });
    std::size_t released = 0;
    try {
        for (; released < free.size(); ++released) release(free[released], insertion);
    } catch (...) {
        while (released-- > 0)
            insertion.insert(free[released].first, free[released].second, [](auto, const auto&) {});
        throw;
    }
    constraints_.remove(whole, pieces);
}

// An insertion that puts it in again will take no memory.
void Triangulation::release(Piece piece, constrained::Insertion& insertion) {
    insertion.follow(piece.first, piece.second, [](auto, const auto&, const auto&) {});
    const Edge e = insertion.along();
    Release(points_.data(), slots_, guard_).plan(e, cavity_, patch_);
    insertion.reserve(cavity_.size());
    if (cavity_.empty())
        slots_.unmark(e);
    else
        put(cavity_, patch_, star_triangles_);
}

std::vector<Piece> Triangulation::holders(Vertex v) const {
    std::vector<Vertex> along;
    const auto look = [&](Vertex other) {
        if (other != ghost && constraints_.has(piece(v, other))) along.push_back(other);
    };
    if (constraints_.empty()) return {};
    if (has_triangles()) {
        Edge corner = corner_[v];
        do {
            if (slots_.is_marked(previous(corner))) look(slots_.tail(corner));
            corner = next(slots_.twin(next(corner)));
        } while (corner != corner_[v]);
    } else {
        const auto [a, b] = around(line_.find(points_[v]));
        look(a);
        look(b);
    }
    std::vector<Piece> found, passing;
    for (const Vertex each : along)
        constraints_.for_each(piece(v, each), [&](Piece whole) {
            (whole.first == v || whole.second == v ? found : passing).push_back(whole);
        });
    if (found.empty() && along.size() > 2) found = std::move(passing);
    keep_distinct(found);
    return found;
}

}  // namespace liftmesh::dynamic
