// What is checked, and why that suffices:
//
// - of the disks of a triangle none is in another, and a circle touches them in their order;
// - every side of a triangle, or of the hull, is the reverse of one other;
// - the arc that is the dual of an edge leads from the circle on its right to that on its left
//   (disk_edge.hpp);
// - the arcs at infinity cover one direction once;
// - every other disk is in a further one, or is equal to one that has triangles.
//
// Seen from the centre c of a disk, the arcs around it, one after the other, lead counter-clockwise
// without a gap, over directions of which each has one point of the arc: they bound a cell that is
// star-shaped about c, holds it, and winds around it once or more. Count the cells that cover a
// point of the plane. The count changes only where the point crosses an arc, of which both disks
// have the same, with their cells on either side: so it is the same everywhere, and far out along
// the x-axis it is 1. So the cells tile the plane.
//
// Let d(x) be the distance of x from the disk in whose cell it lies. Arcs are where two distances
// are equal, so d is continuous, and it changes by 1 for each unit of length at most. Assume that a
// disk q is nearer to x, d_q(x) < d(x). On the way from x to its centre c, d_q falls by 1 for each
// unit of length, and d by no more: d_q(c) < d(c). But c is in the cell of q, where they are equal.
// So each cell is the true one. That no disk enters a circle follows, and nothing but arcs and
// infinity had to be looked at.
//
// The same holds of disks that are made smaller as the rule for ties says: if each edge passes with
// this rule, then the graph is the canonical one.
//
// A row that is said to be hidden must be in another, not equal to it, so among those that contain
// it there is one that is not hidden. Which row that may be is asked of `apollonius`; it is a hint,
// and decided exactly.

#include "verify/disks.hpp"

#include "base/floating_point.hpp"
#include "parallel/blocks.hpp"
#include "verify/disk_edge.hpp"

namespace liftmesh {

namespace {

using apollonius::Disk;
using apollonius::infinity;

constexpr std::size_t disks_block = std::size_t{1} << 12;
constexpr std::int32_t at_infinity = -1;

// A side of a triangle or of the hull, by its place: 3 t + k is opposite corner k of triangle t,
// and places of the hull follow. The hull's triangles have infinity as their third corner.
struct Side {
    std::int32_t tail, head;
    std::size_t place;

    std::pair<std::int32_t, std::int32_t> ends() const { return {tail, head}; }
    std::pair<std::int32_t, std::int32_t> reversed() const { return {head, tail}; }
};

enum class Use : std::uint8_t { none, vertex, hidden, duplicate };

class DiskVerification {
 public:
    DiskVerification(const DiskGraph& graph, ThreadPool& pool)
        : graph_(graph),
          pool_(pool),
          given_(apollonius::scaled({graph.disks.begin(), graph.disks.end()})),
          is_flawed_(triangles()),
          use_(graph.disks.size(), Use::none) {}

    bool check(std::uint64_t secret) {
        const std::size_t hiding = graph_.hidden.empty() ? 0 : graph_.disks.size();
        pool_.interrupt().expect(triangles() + hiding);
        check_indices();
        if (flaws().any()) return true;
        return check_triangles() && pair_sides() && check_edges() && check_winding() &&
               check_circles() && check_rows(secret);
    }
    DiskVerdict verdict() { return std::move(verdict_); }

 private:
    using Found = FlawsOf<DiskFlaw>;

    std::size_t triangles() const { return graph_.simplices.size() / 3; }
    std::size_t hull_size() const { return graph_.hull.size() / 2; }
    Found& flaws() { return verdict_.flaws; }

    const Disk& disk(std::int32_t row) const {
        return row == at_infinity ? infinity : given_.disks[static_cast<std::size_t>(row)];
    }
    std::int32_t corner(std::size_t triangle, unsigned k) const {
        return graph_.simplices[3 * triangle + k % 3];
    }
    Side side(std::size_t triangle, unsigned k) const {
        return {corner(triangle, k + 1), corner(triangle, k + 2), 3 * triangle + k};
    }
    // The side of the hull's triangle: the reverse of the pair, as infinity is on its left.
    Side hull_side(std::size_t at) const {
        return {graph_.hull[2 * at + 1], graph_.hull[2 * at], 3 * triangles() + at};
    }
    std::size_t next_on_hull(std::size_t at) const { return at + 1 < hull_size() ? at + 1 : 0; }
    std::int32_t apex(std::size_t place) const {
        return place < 3 * triangles() ? graph_.simplices[place] : at_infinity;
    }

    // Calls work(first, last, found) for blocks of so many items, and adds up what they find.
    template <class Work>
    bool in_blocks(std::size_t count, Work work) {
        std::vector<Found> found(blocks(count, disks_block));
        const bool done = liftmesh::in_blocks(
            count, disks_block, pool_, [&](std::size_t first, std::size_t last, std::size_t task) {
                work(first, last, found[task]);
            });
        for (const Found& part : found) flaws().add(part);
        return done;
    }

    void check_indices() {
        const auto rows = static_cast<std::int32_t>(graph_.disks.size());
        const auto count = static_cast<std::int32_t>(triangles());
        const std::array lists{graph_.simplices, graph_.neighbors, graph_.hull, graph_.hidden,
                               graph_.duplicates};
        for (std::size_t list = 0; list < lists.size(); ++list) {
            const bool names_triangles = list == 1;
            const std::int32_t low = names_triangles ? -1 : 0,
                               high = names_triangles ? count : rows;
            for (std::size_t i = 0; i < lists[list].size(); ++i)
                if (lists[list][i] < low || lists[list][i] >= high)
                    flaws().add(DiskFlaw::invalid_index, {list, i});
        }
    }

    bool check_triangles() {
        return in_blocks(triangles(), [&](std::size_t first, std::size_t last, Found& found) {
            for (std::size_t t = first; t < last; ++t) {
                const DiskFlaw flaw = flaw_of_triangle(t);
                if (flaw == DiskFlaw::kinds) continue;
                is_flawed_[t] = 1;
                found.add(flaw, {t, 0});
            }
        });
    }

    bool is_within(std::int32_t a, std::int32_t b) const {
        return given_.signs.contains(disk(a), disk(b)) || given_.signs.contains(disk(b), disk(a));
    }

    DiskFlaw flaw_of_triangle(std::size_t t) const {
        const std::int32_t a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
        if (is_within(a, b) || is_within(b, c) || is_within(c, a)) return DiskFlaw::degenerate;
        if (given_.signs.conflicts(disk(a), disk(b), disk(c), infinity)) return DiskFlaw::no_circle;
        return DiskFlaw::kinds;
    }

    // Fills outer_, the sides that have the hull beyond them, and hull_twin_.
    bool pair_sides() {
        const bool done =
            in_blocks(triangles(), [&](std::size_t first, std::size_t last, Found& found) {
                for (std::size_t place = 3 * first; place < 3 * last; ++place)
                    if (graph_.neighbors[place] >= 0 && twin(place) == nowhere)
                        found.add(DiskFlaw::wrong_neighbors, {place, 0});
            });
        if (done) pair_hull();
        return done;
    }

    // The side of the neighbour that is the reverse of this one, and beyond which it names this
    // one.
    std::size_t twin(std::size_t place) const {
        const Side own = side(place / 3, place % 3);
        const auto beyond = static_cast<std::size_t>(graph_.neighbors[place]);
        for (unsigned k = 0; k < 3; ++k)
            if (side(beyond, k).ends() == own.reversed() &&
                graph_.neighbors[3 * beyond + k] == static_cast<std::int32_t>(place / 3))
                return 3 * beyond + k;
        return nowhere;
    }

    void pair_hull() {
        check_hull_cycle();
        std::vector<Side> outer, hull;
        for (std::size_t at = 0; at < hull_size(); ++at) hull.push_back(hull_side(at));
        for (std::size_t place = 0; place < 3 * triangles(); ++place)
            if (graph_.neighbors[place] < 0) outer.push_back(side(place / 3, place % 3));
        sort(outer);
        sort(hull);
        for (const Side& each : outer)
            if (!only(each.reversed(), hull) || !only(each.ends(), outer))
                flaws().add(DiskFlaw::wrong_neighbors, {each.place, 0});
        hull_twin_.assign(hull_size(), nowhere);
        for (const Side& each : hull) {
            const Side* other = only(each.reversed(), outer);
            if (!other && !only(each.ends(), outer)) other = only(each.reversed(), hull);
            const std::size_t at = each.place - 3 * triangles();
            if (!other || !only(each.ends(), hull)) flaws().add(DiskFlaw::wrong_hull, {at, 0});
            hull_twin_[at] = other ? other->place : nowhere;
        }
    }

    static void sort(std::vector<Side>& sides) {
        std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
            return std::pair(a.ends(), a.place) < std::pair(b.ends(), b.place);
        });
    }

    // The side with these ends, if there is exactly one.
    static const Side* only(const std::pair<std::int32_t, std::int32_t>& ends,
                            const std::vector<Side>& sorted) {
        const auto less = [](const Side& a, const auto& b) { return a.ends() < b; };
        const auto found = std::lower_bound(sorted.begin(), sorted.end(), ends, less);
        const auto is_such = [&](auto at) { return at != sorted.end() && at->ends() == ends; };
        return is_such(found) && !is_such(found + 1) ? &*found : nullptr;
    }

    void check_hull_cycle() {
        for (std::size_t at = 0; at < hull_size(); ++at) {
            const std::int32_t tail = graph_.hull[2 * at], head = graph_.hull[2 * at + 1];
            if (head != graph_.hull[2 * next_on_hull(at)] || is_within(tail, head))
                flaws().add(DiskFlaw::wrong_hull, {at, 0});
        }
    }

    bool is_sound(std::size_t place) const {
        return place >= 3 * triangles() || !is_flawed_[place / 3];
    }

    bool check_edges() {
        if (flaws().any(DiskFlaw::wrong_neighbors) || flaws().any(DiskFlaw::wrong_hull))
            return true;
        const bool done =
            in_blocks(triangles(), [&](std::size_t first, std::size_t last, Found& found) {
                for (std::size_t place = 3 * first; place < 3 * last; ++place) {
                    if (graph_.neighbors[place] < 0) continue;
                    const std::size_t other = twin(place);
                    if (place < other) check_edge(side(place / 3, place % 3), other, found);
                }
                pool_.interrupt().advance(last - first);
            });
        return done && check_hull_edges();
    }

    bool check_hull_edges() {
        return in_blocks(hull_size(), [&](std::size_t first, std::size_t last, Found& found) {
            for (std::size_t at = first; at < last; ++at) {
                const Side own = hull_side(at);
                const std::size_t other = hull_twin_[at];
                if (other < own.place) check_edge(own, other, found);
                const std::size_t next = next_on_hull(at);
                add(judge(given_.signs, disk(own.tail), infinity, disk(hull_side(next).tail),
                          disk(own.head)),
                    own.place + hull_size(), found);
            }
        });
    }

    // Of the edge of a side, and the place of the one on its right.
    void check_edge(const Side& own, std::size_t other, Found& found) const {
        if (!is_sound(own.place) || !is_sound(other)) return;
        add(judge(given_.signs, disk(own.tail), disk(own.head), disk(apex(own.place)),
                  disk(apex(other))),
            own.place, found);
    }

    static void add(DiskEdge verdict, std::size_t place, Found& found) {
        if (verdict == DiskEdge::right) return;
        const FlawPlace at{place, 0};
        if (verdict == DiskEdge::entered) found.add(DiskFlaw::not_delaunay, at);
        if (verdict == DiskEdge::backwards) found.add(DiskFlaw::wrong_order, at);
        if (verdict == DiskEdge::tied) found.add(DiskFlaw::not_canonical, at);
    }

    bool has_flaws_of_edges() const {
        const auto& found = verdict_.flaws;
        return found.any(DiskFlaw::wrong_neighbors) || found.any(DiskFlaw::wrong_hull) ||
               found.any(DiskFlaw::not_delaunay) || found.any(DiskFlaw::wrong_order);
    }

    bool check_winding() {
        if (has_flaws_of_edges() || (triangles() == 0 && hull_size() == 0)) return true;
        std::size_t windings = 0;
        for (std::size_t at = 0; at < hull_size(); ++at) {
            const Side own = hull_side(at), next = hull_side(next_on_hull(at));
            windings += holds_x_axis(given_.signs, disk(own.tail), disk(next.tail), disk(own.head));
        }
        if (windings != 1) flaws().add(DiskFlaw::boundary_winding, {0, windings});
        return true;
    }

    bool check_circles() {
        return in_blocks(triangles(), [&](std::size_t first, std::size_t last, Found& found) {
            for (std::size_t t = first; t < last; ++t)
                if (!is_flawed_[t] && !has_its_circle(t))
                    found.add(DiskFlaw::other_circles, {t, 0});
        });
    }

    bool has_its_circle(std::size_t t) const {
        unsigned k = 0;
        for (unsigned i = 1; i < 3; ++i)
            if (corner(t, i) < corner(t, k)) k = i;
        const apollonius::Circle c = apollonius::circle_of(
            {disk(corner(t, k)), disk(corner(t, k + 1)), disk(corner(t, k + 2))}, given_.scale);
        const double* const own = &graph_.circles[3 * t];
        return own[0] == c.x && own[1] == c.y && own[2] == c.radius;
    }

    bool check_rows(std::uint64_t secret) {
        for (const std::int32_t row : graph_.simplices) use(row) = Use::vertex;
        for (const std::int32_t row : graph_.hull) use(row) = Use::vertex;
        if (!check_hidden(secret)) return false;
        check_duplicates();
        const auto unused = std::count(use_.begin(), use_.end(), Use::none);
        const bool is_alone = triangles() == 0 && hull_size() == 0 && unused == 1;
        for (std::size_t row = 0; row < use_.size() && !is_alone; ++row)
            if (use_[row] == Use::none) flaws().add(DiskFlaw::missing_vertices, {row, 0});
        verdict_.vertices =
            is_alone ? 1
                     : static_cast<std::size_t>(std::count(use_.begin(), use_.end(), Use::vertex));
        return true;
    }
    Use& use(std::int32_t row) { return use_[static_cast<std::size_t>(row)]; }

    bool check_hidden(std::uint64_t secret) {
        if (graph_.hidden.empty()) return true;
        PartInterrupt interrupt(pool_.interrupt());
        const auto found =
            apollonius::apollonius({graph_.disks.begin(), graph_.disks.end()}, secret, interrupt);
        if (found.status == Status::interrupted) return false;
        std::vector<std::int32_t> container(graph_.disks.size(), at_infinity);
        for (const auto& [row, other] : found.hidden)
            container[row] = static_cast<std::int32_t>(other);
        for (const std::int32_t row : graph_.hidden) {
            const Use before = std::exchange(use(row), Use::hidden);
            if (before != Use::none) {
                add_hidden(row, before == Use::vertex ? NotHidden::has_triangles
                                                      : NotHidden::listed_twice);
            } else if (!is_hidden_in(row, container[static_cast<std::size_t>(row)])) {
                add_hidden(row, NotHidden::in_no_other);
            }
        }
        return true;
    }
    void add_hidden(std::int32_t row, NotHidden why) {
        flaws().add(DiskFlaw::wrong_hidden,
                    {static_cast<std::size_t>(row), static_cast<std::size_t>(why)});
    }
    bool is_hidden_in(std::int32_t row, std::int32_t other) const {
        return other != at_infinity && !(disk(row) == disk(other)) &&
               given_.signs.contains(disk(other), disk(row));
    }

    void check_duplicates() {
        for (std::size_t i = 0; i + 1 < graph_.duplicates.size(); i += 2) {
            const std::int32_t row = graph_.duplicates[i], first = graph_.duplicates[i + 1];
            const bool is_free = use(row) == Use::none && first < row;
            use(row) = Use::duplicate;
            if (!(is_free && disk(row) == disk(first) && stands_for_others(first)))
                flaws().add(DiskFlaw::wrong_duplicates,
                            {static_cast<std::size_t>(row), static_cast<std::size_t>(first)});
        }
    }
    // A disk that is alone has no triangles.
    bool stands_for_others(std::int32_t row) {
        return use(row) == (triangles() + hull_size() > 0 ? Use::vertex : Use::none);
    }

    static constexpr std::size_t nowhere = ~std::size_t{0};

    const DiskGraph& graph_;
    ThreadPool& pool_;
    apollonius::Scaled given_;
    std::vector<std::uint8_t> is_flawed_;
    std::vector<std::size_t> hull_twin_;
    std::vector<Use> use_;
    DiskVerdict verdict_;
};

}  // namespace

DiskVerdict verify(const DiskGraph& graph, std::uint64_t secret, Threads threads,
                   Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    ThreadPool pool(threads.for_rows(graph.disks.size()), interrupt);
    DiskVerification verification(graph, pool);
    if (verification.check(secret)) return verification.verdict();
    DiskVerdict interrupted;
    interrupted.status = Status::interrupted;
    return interrupted;
}

}  // namespace liftmesh
