#include "constrained/pocket.hpp"

#include "base/buffer.hpp"
#include "predicates/orient2d.hpp"
#include "sorting/sample.hpp"

namespace liftmesh::constrained {

namespace {

constexpr std::size_t short_chain = 64, longest_in_cache = 1 << 12;

}  // namespace

void Pocket::reserve(std::size_t vertices) {
    for (auto* each : {&chain_, &round_, &later_, &order_, &stack_}) each->reserve(vertices + 1);
    at_.reserve(vertices);
    side_.reserve(vertices);
    link_.reserve(vertices);
    is_listed_.reserve(vertices);
    border_.reserve(vertices);
}

// What the next corners that come back will read.
void Pocket::foresee(std::size_t restored) const {
    constexpr std::size_t first = 32, second = 20, third = 12, last = 4;
    if (restored < first) return;
    prefetch(&link_[order_[restored - first]]);
    prefetch(&at_[order_[restored - first]]);
    const auto before = [&](std::size_t early) { return link_[order_[restored - early]].previous; };
    prefetch(&side_[before(second)]);
    const Edge side = side_[before(third)];
    prefetch(ground_->vertices + side);
    prefetch(ground_->twins + side);
    const Vertex* corners = ground_->vertices + triangle_of(side_[before(last)]);
    for (int k = 0; k < 3; ++k) prefetch(ground_->points + corners[k]);
}

void Pocket::fill(Ground& ground, Guard guard) {
    ground_ = &ground;
    guard_ = guard;
    link();
    order_.clear();
    if (chain_.size() > 3) cut_corners();
    const auto last = static_cast<Index>(chain_.size() - 1);
    const Index middle = link_[0].next;
    const TriangleId t = make(chain_[0], chain_[middle], chain_[last]);
    connect(edge(t, 2), open | 0);
    connect(edge(t, 0), open | middle);
    connect(edge(t, 1), open | last);
    const bool is_long = chain_.size() > longest_in_cache;
    for (std::size_t i = order_.size(); i-- > 0;) {
        if (is_long) foresee(i);
        restore(order_[i]);
    }
}

void Pocket::link() {
    const auto count = static_cast<Index>(chain_.size());
    if (at_.size() < count) {  // never less, so that none is set to zero again
        at_.resize(count);
        side_.resize(count);
        link_.resize(count);
    }
    for (Index i = 0; i < count; ++i) {
        at_[i] = ground_->points[chain_[i]];
        link_[i] = {i + 1, i - 1};
    }
    link_[count - 1].next = 0;
}

bool Pocket::is_convex(Index i) const {
    return orient2d(at_[link_[i].previous], at_[i], at_[link_[i].next]) > 0;
}

Pocket::Link Pocket::cut(Index i) {
    order_.push_back(i);
    const Link around = link_[i];
    link_[around.previous].next = around.next;
    link_[around.next].previous = around.previous;
    return around;
}

// Round and round: after each corner that goes, the next one stays for this round. Any order will
// do for so few, and chance takes time.
void Pocket::cut_short_chain(std::size_t many) {
    const auto last = static_cast<Index>(chain_.size() - 1);
    for (Index i = 0; order_.size() < many;) {
        i = link_[i].next == last ? link_[0].next : link_[i].next;
        if (is_convex(i)) i = cut(i).next % last;
    }
}

// In rounds, each along the chain: of the corners that may go about every second one goes. So each
// round of those that come back goes along the chain, too, and finds what it reads in the cache.
// Corners are looked at again once a neighbour has gone.
void Pocket::cut_corners() {
    const std::size_t many = chain_.size() - 3;  // are cut off
    if (chain_.size() <= short_chain) {
        cut_short_chain(many);
        return;
    }
    round_.resize(chain_.size() + 1);
    later_.resize(chain_.size() + 1);
    std::iota(round_.begin(), round_.end(), Index{1});
    is_listed_.assign(chain_.size(), 1);
    draws_ = 0;
    std::size_t count = chain_.size() - 2;
    while (order_.size() < many) {
        later_count_ = 0;
        for (std::size_t first = 0; first < count; first += drawn_.size()) {
            const std::size_t some = std::min(drawn_.size(), count - first);
            for (const Index i : draw({&round_[first], some})) {
                is_listed_[i] = 0;
                if (order_.size() == many || !is_convex(i)) continue;
                const auto [after, before] = cut(i);
                list(before);
                list(after);
            }
        }
        count = later_count_;
        std::swap(round_, later_);
    }
}

// About every second one; the others are left for the next round. No branch depends on chance.
std::span<const Pocket::Index> Pocket::draw(std::span<const Index> some) {
    std::uint64_t random = random_number(draws_++, 0);
    std::size_t count = 0;
    for (const Index i : some) {
        drawn_[count] = later_[later_count_] = i;
        count += random & 1;
        later_count_ += ~random & 1;
        random /= 2;
    }
    return {drawn_.data(), count};
}

// For the next round. The ends are never listed.
void Pocket::list(Index i) {
    later_[later_count_] = i;
    later_count_ += !is_listed_[i];
    is_listed_[i] = 1;
}

bool Pocket::conflicts(TriangleId t, Point p) const {
    const Vertex* corner = ground_->vertices + t;
    return incircle_canonical(ground_->points[corner[0]], ground_->points[corner[1]],
                              ground_->points[corner[2]], p, guard_);
}

// The triangles in conflict with a corner that comes back are a path or a tree that begins at the
// side on which it stands. Their border is met in order.
void Pocket::dig(Point p, Edge side) {
    const Vertex* vertices = ground_->vertices;
    border_.clear();
    stack_.clear();
    for (Word x = side;;) {
        if (!(x & open) && conflicts(triangle_of(x), p)) {
            ground_->free.push_back(triangle_of(x));
            stack_.push_back(ground_->twins[next(x)]);
            x = ground_->twins[previous(x)];
            continue;
        }
        if (x & open) {  // seen from inside the polygon
            const Index i = x & ~open;
            border_.push_back({chain_[link_[i].next], chain_[i], x});
        } else {
            border_.push_back({vertices[next(x)], vertices[previous(x)], x});
        }
        if (stack_.empty()) return;
        x = stack_.back();
        stack_.pop_back();
    }
}

void Pocket::restore(Index i) {
    const Index before = link_[i].previous;
    const Vertex v = chain_[i];
    dig(at_[i], side_[before]);
    link_[before].next = i;
    link_[link_[i].next].previous = i;
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
