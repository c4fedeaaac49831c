#include "surface/face_pair.hpp"

#include "predicates/orient2d.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t none = 3;
constexpr double unit = 0x1p-52;
// Of the move where turns count as zero: sides that are one but for rounding are on the same side
// of it. It is none that grids and decimals have.
constexpr double slope = 0x1.3c6ef372fe94fp-1;

}  // namespace

Face face_of(const Relief& relief, std::int32_t simplex) {
    const SurfaceCorner corners[3] = {relief.corner(simplex, 0), relief.corner(simplex, 1),
                                      relief.corner(simplex, 2)};
    std::size_t first = before_xy(corners[1].at, corners[0].at) ? 1 : 0;
    if (before_xy(corners[2].at, corners[first].at)) first = 2;
    const auto [low_y, high_y] = std::minmax({corners[0].at.y, corners[1].at.y, corners[2].at.y});
    const double width =
        std::max(corners[tail_of(first)].at.x, corners[head_of(first)].at.x) - corners[first].at.x;
    return {{corners[first], corners[tail_of(first)], corners[head_of(first)]},
            first,
            std::max(width, high_y - low_y)};
}

bool is_near(double turn, Point tail, Point head, Point at, Nearness nearness) {
    const auto size = [nearness](double a, double b, double c) {
        return std::max({std::fabs(a), std::fabs(b), std::fabs(c), nearness.least});
    };
    return std::fabs(turn) <= nearness.units * unit *
                                  (size(at.x, tail.x, head.x) * std::fabs(head.y - tail.y) +
                                   size(at.y, tail.y, head.y) * std::fabs(head.x - tail.x));
}

bool is_flat(const Face& face, Nearness nearness) {
    for (std::size_t k = 0; k < 3; ++k) {
        const Point at = face.at(k), tail = face.at(tail_of(k)), head = face.at(head_of(k));
        const double turn = (tail.x - at.x) * (head.y - at.y) - (tail.y - at.y) * (head.x - at.x);
        if (is_near(turn, tail, head, at, nearness)) return true;
    }
    return false;
}

FacePair::FacePair(const Face& first, const Face& second, Nearness nearness)
    : faces_{&first, &second},
      nearness_(nearness),
      reach_(2 * unit * nearness.units * nearness.largest * std::max(first.extent, second.extent)) {
    Point apart[3][3];
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            apart[i][j] = {first.at(i).x - second.at(j).x, first.at(i).y - second.at(j).y};
    for (std::size_t side = 0; side < 3; ++side)
        for (std::size_t i = 0; i < 3; ++i) {
            set_turn(0, side, i, apart[tail_of(side)][i], apart[head_of(side)][i]);
            set_turn(1, side, i, apart[i][tail_of(side)], apart[i][head_of(side)]);
        }
    for (std::size_t side = 0; side < 3; ++side) {
        set_sides(0, side);
        set_sides(1, side);
    }
}

// From the ends of a side relative to a corner of the other face.
void FacePair::set_turn(std::size_t face, std::size_t side, std::size_t corner, Point tail,
                        Point head) {
    constexpr double bound = 0x1p-51, underflow = 0x1p-960;
    const double left = tail.x * head.y, right = tail.y * head.x;
    Turn& turn = turns_[face][side][corner];
    turn = {left - right, std::fabs(left) + std::fabs(right)};
    const double error = bound * turn.size + underflow;
    int sign = (turn.value > 0) - (turn.value < 0);
    if (std::fabs(turn.value) <= error + reach_) {
        const Face& of = *faces_[face];
        const Point from = of.at(tail_of(side)), to = of.at(head_of(side)),
                    at = faces_[1 - face]->at(corner);
        if (std::fabs(turn.value) <= error) {
            sign = from == at || to == at ? 0 : orient2d_exact(from, to, at);
            turn = {sign * std::numeric_limits<double>::denorm_min(),
                    std::numeric_limits<double>::infinity()};
        }
        if (nearness_.units > 0 && is_near(left - right, from, to, at, nearness_)) turn.value = 0;
    }
    Sides& sides = sides_[face][side];
    sides.positive |= static_cast<std::uint8_t>((sign > 0) << corner);
    sides.negative |= static_cast<std::uint8_t>((sign < 0) << corner);
}

void FacePair::set_sides(std::size_t face, std::size_t side) {
    Sides& sides = sides_[face][side];
    std::uint8_t right = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double value = turns_[face][side][i].value;
        sides.above |= static_cast<std::uint8_t>((value > 0) << i);
        right |= static_cast<std::uint8_t>((value < 0) << i);
    }
    sides.left = sides.above;
    if ((sides.above | right) == all) return;
    const Point tail = faces_[face]->at(tail_of(side)), head = faces_[face]->at(head_of(side));
    bool is_down = head.y < tail.y || (head.y == tail.y && head.x > tail.x);
    if (nearness_.units > 0) is_down = slope * (head.x - tail.x) > head.y - tail.y;
    if (is_down == (face == 0)) sides.left = static_cast<std::uint8_t>(all & ~right);
}

// The side of the other face to which the outline goes over from a side; `none` if to no one.
std::size_t FacePair::exit(std::size_t face, std::size_t side) const {
    const auto has = [](const Sides& sides, std::size_t corner) {
        return sides.left >> corner & 1;
    };
    const Sides& about = sides_[face][side];
    for (std::size_t next = 0; next < 3; ++next) {
        const Sides& other = sides_[1 - face][next];
        if (has(other, tail_of(side)) && !has(other, head_of(side)) && !has(about, tail_of(next)) &&
            has(about, head_of(next)))
            return next;
    }
    return none;
}

// If a corner is on a side, it is the crossing.
FacePair::Corner FacePair::crossing(std::size_t face, std::size_t side,
                                    std::size_t other_side) const {
    const std::size_t sides[2] = {face == 0 ? side : other_side, face == 0 ? other_side : side};
    for (std::size_t number = 0; number < 2; ++number)
        for (const std::size_t end : {tail_of(sides[number]), head_of(sides[number])})
            if (turns_[1 - number][sides[1 - number]][end].value == 0)
                return {false, number, end, 0};
    return {true, 0, sides[0], sides[1]};
}

// From where the outline leaves a side of a face, until it comes back to there.
void FacePair::follow(std::size_t face, std::size_t side, std::size_t other,
                      Outline& outline) const {
    const std::size_t first_face = face, first_side = side;
    std::size_t next = other;
    do {
        if (next != none) {
            outline.add(crossing(face, side, next));
            face = 1 - face;
            side = next;
        } else {
            outline.add({false, face, head_of(side), 0});
            side = after(side);
        }
        next = exit(face, side);
    } while (outline.count < Outline::most &&
             !(face == first_face && side == first_side && next == other));
}

FacePair::Outline FacePair::outline() const {
    Outline outline;
    for (std::size_t side = 0; side < 3; ++side)
        if (const std::size_t other = exit(0, side); other != none) {
            follow(0, side, other, outline);
            return outline;
        }
    const bool is_inside = (sides_[1][0].left & sides_[1][1].left & sides_[1][2].left & 1) != 0;
    for (std::size_t k = 0; k < 3; ++k) outline.add({false, is_inside ? 0u : 1u, k, 0});
    return outline;
}

}  // namespace liftmesh
