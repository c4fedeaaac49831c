// Contours, rims, rings and volumes, each found once more in the plainest way.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "checks.hpp"
#include "demand.hpp"
#include "ground.hpp"
#include "surface/contours.hpp"
#include "surface/facet.hpp"
#include "surface/overlay.hpp"
#include "surface/rim.hpp"

namespace fuzzing {

namespace {

using Segment = std::array<double, 4>;

// What a level makes of a face: a step from the side that leads down to the one that leads up.
struct Step {
    Segment ends;
    std::int32_t from, to;  // faces beyond, or -1

    bool has_length() const { return ends[0] != ends[2] || ends[1] != ends[3]; }
};

using Steps = std::map<std::int32_t, Step>;

Steps steps_at(const Ground& ground, double level) {
    Steps found;
    for (std::int32_t face = 0; face < ground.count(); ++face) {
        if (!ground.relief.is_shown(face)) continue;
        Step step{{}, -1, -1};
        bool crosses = false;
        for (int k = 0; k < 3; ++k) {
            const auto tail = ground.relief.corner(face, (k + 1) % 3),
                       head = ground.relief.corner(face, (k + 2) % 3);
            if ((tail.height >= level) == (head.height >= level)) continue;
            crosses = true;
            const bool leads_down = tail.height >= level;
            const Point at = liftmesh::crossing(tail, head, level);
            std::copy_n(std::array{at.x, at.y}.begin(), 2, &step.ends[leads_down ? 0 : 2]);
            (leads_down ? step.from : step.to) = ground.side(face, k).beyond;
        }
        if (crosses) found[face] = step;
    }
    return found;
}

struct Chains {
    std::size_t open = 0, closed = 0;
};

// How many lines there are of more than one point.
Chains chains_of(const Steps& steps) {
    Chains found;
    std::set<std::int32_t> seen;
    const auto follow = [&](std::int32_t face) {
        bool has_length = false;
        while (face >= 0 && seen.insert(face).second) {
            has_length |= steps.at(face).has_length();
            face = steps.at(face).to;
        }
        return has_length;
    };
    for (const auto& [face, step] : steps)
        if (step.from < 0) found.open += follow(face);
    for (const auto& [face, step] : steps)
        if (!seen.contains(face)) found.closed += follow(face);
    return found;
}

void check_level(const Ground& ground, const liftmesh::Contours& lines, std::int32_t number,
                 double level) {
    std::vector<Segment> expected, found;
    const Steps steps = steps_at(ground, level);
    for (const auto& [face, step] : steps)
        if (step.has_length()) expected.push_back(step.ends);
    Chains chains;
    for (std::size_t line = 0; line < lines.levels.size(); ++line) {
        if (lines.levels[line] != number) continue;
        const auto first = static_cast<std::size_t>(lines.starts[line]),
                   last = static_cast<std::size_t>(lines.starts[line + 1]);
        demand(last - first >= 2, "a line of one point");
        ++(lines.is_closed[line] ? chains.closed : chains.open);
        demand(!lines.is_closed[line] || lines.points[first] == lines.points[last - 1],
               "a closed line is open");
        for (std::size_t i = first; i + 1 < last; ++i) {
            const Point p = lines.points[i], q = lines.points[i + 1];
            found.push_back({p.x, p.y, q.x, q.y});
        }
    }
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    demand(found == expected, "lines have other segments than faces");
    const Chains wanted = chains_of(steps);
    demand(chains.open == wanted.open && chains.closed == wanted.closed,
           "segments are chained to other lines");
}

// Heights of vertices, and some between.
std::vector<double> drawn_levels(const Scatter& at, Bytes& asked) {
    std::set<double> found;
    for (int i = 0; i < 4; ++i) {
        const double p = at.heights[asked.byte() % at.size()],
                     q = at.heights[asked.byte() % at.size()];
        found.insert({p, p / 2 + q / 2});
    }
    return {found.begin(), found.end()};
}

liftmesh::Contours lines_of(const Ground& ground, const std::vector<double>& levels) {
    liftmesh::Contours found;
    Impatient interrupt;
    demand(contours(ground.relief, levels.data(), levels.size(), found, {}, interrupt),
           "lines end early");
    return found;
}

bool are_same(const liftmesh::Contours& a, const liftmesh::Contours& b) {
    return a.starts == b.starts && a.levels == b.levels && a.is_closed == b.is_closed &&
           std::equal(a.points.get(), a.points.get() + a.starts.back(), b.points.get());
}

std::vector<std::array<std::int32_t, 2>> rim_of(const Ground& ground) {
    std::vector<std::array<std::int32_t, 2>> found;
    for (std::int32_t face = 0; face < ground.count(); ++face)
        for (int k = 0; k < 3 && ground.relief.is_shown(face); ++k)
            if (const Side side = ground.side(face, k); side.beyond < 0)
                found.push_back({side.tail, side.head});
    std::sort(found.begin(), found.end());
    return found;
}

void check_rings(const Ground& ground) {
    liftmesh::Rings found;
    Impatient interrupt;
    demand(rings(ground.mesh, {ground.left_out.data()}, found, interrupt), "rings end early");
    std::vector<std::array<std::int32_t, 2>> sides;
    for (std::size_t ring = 0; ring + 1 < found.starts.size(); ++ring) {
        const auto first = found.rows.begin() + found.starts[ring],
                   last = found.rows.begin() + found.starts[ring + 1];
        demand(std::set<std::int32_t>(first, last).size() == static_cast<std::size_t>(last - first),
               "a ring visits a vertex twice");
        for (auto at = first; at != last; ++at)
            sides.push_back({*at, at + 1 == last ? *first : at[1]});
    }
    std::sort(sides.begin(), sides.end());
    demand(sides == rim_of(ground), "rings are not the rim");
}

// One face after the other that has a long side beyond which there is none.
std::vector<std::uint8_t> without_long_sides(const Ground& ground,
                                             const std::vector<std::uint8_t>& is_long) {
    std::vector<std::uint8_t> left_out = ground.left_out;
    const auto is_shown = [&](std::int32_t face) {
        return face >= 0 && !left_out[static_cast<std::size_t>(face)];
    };
    for (bool changes = true; changes;) {
        changes = false;
        for (std::int32_t face = 0; face < ground.count(); ++face)
            for (int k = 0; k < 3; ++k)
                if (is_shown(face) && !is_shown(ground.mesh.neighbor(face, k)) &&
                    is_long[static_cast<std::size_t>(3 * face + k)]) {
                    left_out[static_cast<std::size_t>(face)] = 1;
                    changes = true;
                }
    }
    return left_out;
}

}  // namespace

void check_lines(const Ground& ground, const Ground& other, Bytes& asked) {
    const std::vector<double> levels = drawn_levels(ground.at, asked);
    const liftmesh::Contours found = lines_of(ground, levels);
    demand(are_same(found, lines_of(other, levels)), "the order of rows changes a line");
    for (std::size_t i = 0; i < levels.size(); ++i)
        check_level(ground, found, static_cast<std::int32_t>(i), levels[i]);
}

void check_rim(const Ground& ground, Dice& dice) {
    check_rings(ground);
    const auto parts = static_cast<std::int32_t>(2 + dice.below(4));
    std::vector<std::uint8_t> is_long(3 * ground.mesh.count);
    for (std::int32_t face = 0; face < ground.count(); ++face)
        for (int k = 0; k < 3; ++k) {
            const Side side = ground.side(face, k);  // long from both faces
            is_long[static_cast<std::size_t>(3 * face + k)] =
                (7 * std::max(side.tail, side.head) + std::min(side.tail, side.head)) % parts == 0;
        }
    std::vector<std::uint8_t> left_out = ground.left_out;
    Impatient interrupt;
    demand(liftmesh::leave_out_from_rim(ground.mesh.neighbors, ground.mesh.count, is_long.data(),
                                        left_out.data(), interrupt),
           "trimming ends early");
    demand(left_out == without_long_sides(ground, is_long), "other faces are left out");
}

// The second surface has the same points, and no face left out: where the first has faces, what is
// above and below changes places with the surfaces, and nothing is between a surface and itself.
void check_volumes(const Ground& ground, const Ground& lowered) {
    if (ground.at.is_wide) return;
    liftmesh::Between there{}, back{}, own{};
    Impatient interrupt;
    demand(between(ground.relief, lowered.relief, 0, 0, there, interrupt) &&
               between(lowered.relief, ground.relief, 0, 0, back, interrupt) &&
               between(ground.relief, ground.relief, 0, 0, own, interrupt),
           "volumes end early");
    const auto [least, greatest] =
        std::minmax_element(ground.at.heights.begin(), ground.at.heights.end());
    const double most = there.area * (*greatest - *least + 9);
    if (!(most < 1e200) || !(there.area > 1e-200)) return;
    const auto are_near = [](double a, double b, double size) {
        return std::fabs(a - b) <= 1e-6 * size;
    };
    demand(are_near(there.area, back.area, there.area) && are_near(own.area, back.area, own.area),
           "areas differ");
    demand(are_near(there.above, back.below, most) && are_near(there.below, back.above, most),
           "volumes depend on which surface is the first");
    demand(are_near(own.above + own.below, 0, most), "a surface is above itself");
}

}  // namespace fuzzing
