#include "refinement/refine.hpp"

#include "base/floating_point.hpp"
#include "refinement/refinement.hpp"

namespace liftmesh::refinement {

namespace {

double greatest_of(const Input& input) {
    double greatest = 0;
    for (std::size_t row = 0; row < input.rows; ++row)
        for (const double each : {input[row].x, input[row].y})
            if (std::isfinite(each)) greatest = std::max(greatest, std::abs(each));
    return greatest;
}

}  // namespace

Refinement::Refinement(const Start& start, const Wanted& wanted, Interrupt& interrupt)
    : wanted_(wanted),
      interrupt_(interrupt),
      patience_(interrupt),
      measures_(greatest_of(start.input)),
      given_rows_(start.input.rows),
      pieces_(start.mesh.pieces),
      parts_(Order(mesh_)) {
    for (const double each : wanted.largest)
        largest_.push_back(measures_.scaled(measures_.scaled(each)));
    begin(start);
    constexpr double nearer = 0.49;  // than 0.5, where the angle would just be the wanted one
    constexpr double none = std::numeric_limits<double>::infinity();
    const double cosine = wanted.cosine, cosine2 = cosine * cosine;
    const double of_twice = std::max(2 * cosine2 - 1, 0.0);
    sharp_ = cosine < 1 ? cosine2 : none;
    constexpr double margin = 1e-4;  // half a degree beyond the right angle
    wide_ = wanted.is_conforming ? margin : of_twice * of_twice;
    off_center_ = cosine < 1 ? nearer * std::sqrt((1 + cosine) / (1 - cosine)) : none;
}

// Slots are handed out from the last one down, ghosts after all others.
void Refinement::begin(const Start& start) {
    rows_ = mesh_.adopt(start.input, start.mesh);
    divided_.assign(rows_.size(), given);
    region_.assign(slot_of(slots().end()), outside);
    stamp_.assign(region_.size(), 0);
    for (std::size_t i = 0; i < start.regions.size(); ++i)
        region_[region_.size() - 1 - i] = start.regions[i];
}

// By position of their corners.
void Refinement::in_order(std::vector<TriangleId>& triangles) const {
    const auto corners = [this](TriangleId t) {
        std::array<Vertex, 3> found;
        for (unsigned k = 0; k < 3; ++k) found[k] = slots().vertex(t, k);
        std::sort(found.begin(), found.end(), [this](auto a, auto b) { return is_before(a, b); });
        return found;
    };
    std::sort(triangles.begin(), triangles.end(), [&](TriangleId one, TriangleId other) {
        const auto a = corners(one), b = corners(other);
        return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(),
                                            [this](auto v, auto w) { return is_before(v, w); });
    });
}

void Refinement::look_at_all() {
    std::vector<Waiting> found;
    for (TriangleId t = 0; t < slots().end(); t += words_per_triangle) {
        if (slots().is_free(t) || slots().is_ghost(t)) continue;
        if (const auto each = need(t)) found.push_back(*each);
        if (!largest_.empty() && is_inside(t))
            expect(shape(t).twice_area / 2, largest_[static_cast<std::size_t>(region(t))]);
        for (unsigned k = 0; k < 3; ++k) look_at_side(edge(t, k));
    }
    push(found);
}

void Refinement::push(std::vector<Waiting> all) {
    std::sort(all.begin(), all.end(), Order(mesh_));
    for (const Waiting& each : all) waiting_.push(each);
}

Status Refinement::run() {
    look_at_all();
    while (does_step()) {
        if (patience_.ends(256)) return Status::interrupted;
        if (made_ % 1024 == 0) {
            const auto expected = static_cast<std::size_t>(std::min(expected_, 1e15));
            const std::size_t all = expected > made_ ? expected : made_ + waiting_.size() + 1;
            tell(0, made_, std::min(all, wanted_.most + 1));
        }
    }
    return Status::ok;
}

// Brings what is next near: the triangle after the next one, and what is around the next one.
void Refinement::prefetch() const {
    constexpr std::size_t early = 3;
    const auto next = waiting_.next(early);
    if (next.size() < early) return;
    const TriangleId t = triangle_of(next[0].base);
    mesh_.prefetch(t);
    liftmesh::prefetch(stamp_.data() + slot_of(t));
    mesh_.prefetch_around(triangle_of(next[early - 1].base));
}

// Of a triangle that is larger than asked for: how many points are to be added in it, about.
void Refinement::expect(double area, double largest) {
    constexpr double points = 0.8;
    if (area > largest) expected_ += points * area / largest;
}

// How far it is: while points are added, by how many are expected, else by what waits now.
void Refinement::tell(std::size_t stage, std::size_t done, std::size_t all) {
    constexpr std::size_t whole = 1000;
    if (told_ == 0) interrupt_.expect(whole * (1 + wanted_.rounds));
    const std::size_t now = whole * stage + whole * done / all;
    if (now <= told_) return;
    interrupt_.advance(now - told_);
    told_ = now;
}

// False at the end.
bool Refinement::does_step() {
    if (!parts_.empty()) {
        const Part first = parts_.top();
        parts_.pop();
        split(first);
    } else if (!waiting_.empty()) {
        const Waiting first = waiting_.pop();
        prefetch();
        treat(first);
    } else if (!unmeasured_.empty())
        push(too_long());
    else if (!wanted_.is_conforming || conforms())
        return false;
    return !is_capped_;
}

Refined Refinement::result() {
    Refined found;
    const std::size_t first = rows_.size();
    name_.assign(mesh_.vertex_end() - first, 0);
    for (Vertex v = static_cast<Vertex>(first); v < mesh_.vertex_end(); ++v) {
        if (!mesh_.is_present(v)) continue;
        name_[v - first] = static_cast<Row>(given_rows_ + found.added.size());
        found.added.push_back(at(v));
        found.divided.push_back(divided_[v]);
    }
    found.result = mesh_.result();
    found.marks = mesh_.marks();
    const auto rename = [&](Buffer<std::int32_t>& corners, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i)
            corners[i] = static_cast<std::int32_t>(row(static_cast<Vertex>(corners[i])));
    };
    rename(found.result.simplices, 3 * found.result.triangle_count);
    rename(found.result.hull, found.result.hull_count);
    sharp_ *= 1 - 0x1p-40;  // those in doubt, too
    constexpr double least2 = 0x1p-400;
    constexpr std::size_t at_once = std::size_t{1} << 16;
    std::vector<std::uint32_t> number(wanted_.lengths ? region_.size() : 0);  // of slots
    unmeasured_.clear();
    found.regions.reserve(found.marks.size());
    found.causes.reserve(found.marks.size());
    found.is_large.reserve(found.marks.size());
    const auto list_too_long = [&] {
        for (const Waiting& each : too_long(true))
            found.is_large[number[slot_of(triangle_of(each.base))]] = true;
    };
    for (TriangleId t = 0; t < slots().end(); t += words_per_triangle) {
        if (slots().is_free(t) || slots().is_ghost(t)) continue;
        if (wanted_.lengths) number[slot_of(t)] = static_cast<std::uint32_t>(found.regions.size());
        found.regions.push_back(region(t));
        bool is_large = false;
        Cause cause = Cause::none;
        if (is_inside(t)) {
            const Shape its = shape(t);
            is_large = is_listed_for_area(its.base);
            if (wanted_.lengths) unmeasured_.push_back({its.base2, its.base, stamp_[slot_of(t)]});
            const bool is_lost = its.base2 < least2;
            if (its.is_sharp || is_lost)
                cause = is_blamed(is_lost ? surely_shortest(t) : its.base)
                            ? Cause::between_constraints
                        : is_capped_ ? Cause::cap
                                     : Cause::precision;
        }
        found.causes.push_back(cause);
        found.is_large.push_back(is_large);
        if (unmeasured_.size() == at_once) list_too_long();
    }
    if (!unmeasured_.empty()) list_too_long();
    found.is_capped = is_capped_;
    return found;
}

Refined refine(const Start& start, const Wanted& wanted, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    Refinement refinement(start, wanted, interrupt);
    Status status = refinement.run();
    if (status == Status::ok) status = refinement.smooth();
    Refined found;
    if (status == Status::ok)
        found = refinement.result();
    else
        found.status = status;
    return found;
}

}  // namespace liftmesh::refinement
