#include "constrained/pocket.hpp"

#include "predicates/orient2d.hpp"

namespace liftmesh::constrained {

void Pocket::reserve(std::size_t vertices) {
    for (auto* each : {&chain_, &side_, &next_, &previous_, &round_, &later_, &order_, &stack_})
        each->reserve(vertices);
    is_listed_.reserve(vertices);
    border_.reserve(vertices);
}

void Pocket::fill(Ground& ground, Guard guard) {
    ground_ = &ground;
    guard_ = guard;
    side_.assign(chain_.size(), 0);
    const auto last = static_cast<Index>(chain_.size() - 1);
    Index middle = 1;
    if (chain_.size() > 3) {
        cut_corners();
        middle = next_[0];
    }
    const TriangleId t = make(chain_[0], chain_[middle], chain_[last]);
    connect(edge(t, 2), open | 0);
    connect(edge(t, 0), open | middle);
    connect(edge(t, 1), open | last);
    if (chain_.size() > 3)
        for (std::size_t i = order_.size(); i-- > 0;) restore(order_[i]);
}

bool Pocket::is_convex(Index i) const {
    return orient2d(at(previous_[i]), at(i), at(next_[i])) > 0;
}

// In rounds, each along the chain: of the corners that may go about every second one goes. So each
// round of those that come back goes along the chain, too, and finds what it reads in the cache.
// Corners are looked at again once a neighbour has gone.
void Pocket::cut_corners() {
    const auto last = static_cast<Index>(chain_.size() - 1);
    next_.resize(chain_.size());
    previous_.resize(chain_.size());
    for (Index i = 0; i <= last; ++i) next_[i] = i + 1, previous_[i] = i - 1;
    next_[last] = 0;
    round_.resize(chain_.size() - 2);
    std::iota(round_.begin(), round_.end(), Index{1});
    is_listed_.assign(chain_.size(), 1);
    order_.clear();
    random_ = golden_section;
    while (order_.size() + 3 < chain_.size()) {
        later_.clear();
        for (const Index i : round_) {
            is_listed_[i] = 0;
            if (order_.size() + 3 == chain_.size() || !is_convex(i)) continue;
            if (draw()) {
                list(i);
                continue;
            }
            order_.push_back(i);
            next_[previous_[i]] = next_[i];
            previous_[next_[i]] = previous_[i];
            list(previous_[i]);
            list(next_[i]);
        }
        std::swap(round_, later_);
    }
}

// For the next round. The ends are never listed.
void Pocket::list(Index i) {
    if (is_listed_[i]) return;
    is_listed_[i] = 1;
    later_.push_back(i);
}

// A linear congruential generator of Knuth, whose upper bits are random.
bool Pocket::draw() {
    random_ = random_ * 6364136223846793005u + 1442695040888963407u;
    return random_ >> 63;
}

// The triangles in conflict with a corner that comes back are a path or a tree that begins at the
// side on which it stands. Their border is met in order.
void Pocket::dig(Vertex v, Edge side) {
    const Point p = ground_->points[v];
    const Vertex* vertices = ground_->vertices;
    border_.clear();
    stack_.assign(1, side);
    while (!stack_.empty()) {
        const Word x = stack_.back();
        stack_.pop_back();
        if (x & open) {  // seen from inside the polygon
            const Index i = x & ~open;
            border_.push_back({chain_[next_[i]], chain_[i], x});
            continue;
        }
        const TriangleId t = triangle_of(x);
        const Vertex* corner = vertices + t;
        const Point a = ground_->points[corner[0]], b = ground_->points[corner[1]],
                    c = ground_->points[corner[2]];
        if (!incircle_canonical(a, b, c, p, guard_)) {
            border_.push_back({vertices[next(x)], vertices[previous(x)], x});
            continue;
        }
        ground_->free.push_back(t);
        stack_.push_back(ground_->twins[next(x)]);
        stack_.push_back(ground_->twins[previous(x)]);
    }
}

void Pocket::restore(Index i) {
    const Index before = previous_[i];
    const Vertex v = chain_[i];
    dig(v, side_[before]);
    next_[before] = i;
    previous_[next_[i]] = i;
    Edge left = 0;
    for (std::size_t k = 0; k < border_.size(); ++k) {
        const auto [tail, head, beyond] = border_[k];
        const TriangleId t = make(v, head, tail);
        connect(edge(t, 0), beyond);
        connect(edge(t, 1), k == 0 ? open | before : left);
        left = edge(t, 2);
    }
    connect(left, open | i);
}

TriangleId Pocket::make(Vertex a, Vertex b, Vertex c) {
    const TriangleId t = ground_->free.back();
    ground_->free.pop_back();
    const Vertex corners[3] = {a, b, c};
    for (unsigned k = 0; k < 3; ++k) {
        ground_->vertices[t + k] = corners[k];
        ground_->corner[corners[k]] = edge(t, k);
    }
    return t;
}

void Pocket::connect(Edge e, Word beyond) {
    ground_->twins[e] = beyond;
    if (beyond & open)
        side_[beyond & ~open] = e;
    else
        ground_->twins[beyond] = e;
}

}  // namespace liftmesh::constrained
