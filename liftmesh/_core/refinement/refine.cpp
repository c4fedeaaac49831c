#include "refinement/refine.hpp"

#include <unordered_set>

#include "base/floating_point.hpp"
#include "predicates/orient2d.hpp"
#include "refinement/measures.hpp"
#include "refinement/queues.hpp"

namespace liftmesh::refinement {

namespace {

using dynamic::BorderEdge;
using dynamic::nothing;

constexpr std::int32_t outside = -1;  // in place of a region
constexpr std::int32_t given = -2;    // in place of the piece that a vertex divides

double greatest_of(const Input& input) {
    double greatest = 0;
    for (std::size_t row = 0; row < input.rows; ++row)
        for (const double each : {input[row].x, input[row].y})
            if (std::isfinite(each)) greatest = std::max(greatest, std::abs(each));
    return greatest;
}

// A triangle over its shortest side.
struct Shape {
    Edge base;
    double base2, longest2, twice_area;
    double height;  // of the centre of its circle over the base, in lengths of the base
    bool is_sharp;
};

class Refinement {
 public:
    Refinement(const Start& start, const Wanted& wanted, Interrupt& interrupt);

    Status run();
    Refined result();

 private:
    struct Place {
        TriangleId triangle;
        Edge blocked = nothing;  // the constraint that is in the way
        bool is_vertex = false;
    };

    const dynamic::Slots& slots() const { return mesh_.slots(); }
    Point at(Vertex v) const { return mesh_.point(v); }
    std::int32_t& region(TriangleId t) { return region_[slot_of(t)]; }
    bool is_inside(TriangleId t) const { return region_[slot_of(t)] != outside; }
    // By position; the ghost is last.
    bool is_before(Vertex a, Vertex b) const {
        return a != ghost && (b == ghost || before_xy(at(a), at(b)));
    }
    Vector between(Vertex a, Vertex b) const { return measures_.between(at(a), at(b)); }

    void begin(const Start& start);
    void in_order(std::vector<TriangleId>& triangles) const;
    void look_at_all();
    void tell();
    bool does_step();

    Shape shape(TriangleId t) const;
    std::optional<Waiting> need(TriangleId t);
    void look_at(TriangleId t);
    void push(std::vector<Waiting>& all);
    void measure();
    bool is_between_constraints(Edge base) const;
    std::int32_t piece_at(Vertex a, Vertex b) const;

    void treat(const Waiting& waiting);
    bool is_gone(const Waiting& waiting) const;
    Point center(const Shape& shape) const;
    Place walk(Edge base, Point p) const;
    bool is_right_of(Edge e, Point p) const {
        return orient2d(at(slots().tail(e)), at(slots().head(e)), p) < 0;
    }
    bool is_marked_at(Edge e, Point p) const;
    void add(Point p);
    Vertex fill(Point p, std::int32_t piece);
    void stamp(const std::vector<TriangleId>& triangles);

    bool is_encroached(Edge e, Point p) const;
    void look_at_side(Edge e);
    bool ask_to_split(Edge e);
    void split(const Part& part);
    void clear_circle(const Part& part);
    bool remove_apex(Edge e);
    bool is_narrow(Edge e, Edge beside) const;
    bool has_narrow_corner(Edge e) const;
    Point place(const Part& part, Edge e) const;
    bool can_be_seen(Point p) const;
    TriangleId find_beside(Edge e, Point p) const;
    bool dig_across(const Part& part, Edge e, Point p);
    bool is_at_border(Vertex v) const;
    void insert_on(const Part& part, Edge e, Point middle);
    void divide(const Part& part, std::int32_t left, std::int32_t right);
    void look_around();
    bool conforms();

    Row row(Vertex v) const { return v < rows_.size() ? rows_[v] : name_[v - rows_.size()]; }
    static std::uint64_t key(const Part& part) {
        return std::uint64_t{part.first} << 32 | part.second;
    }

    const Wanted& wanted_;
    Interrupt& interrupt_;
    Patience patience_;
    std::size_t told_ = 0;
    Measures measures_;
    double sharp_, wide_, off_center_;
    std::vector<double> largest_;
    std::size_t given_rows_;
    std::span<const constrained::Piece> pieces_;

    dynamic::Triangulation mesh_;
    std::vector<Row> rows_;             // of the first vertices
    std::vector<std::int32_t> region_;  // of slots
    std::vector<std::uint32_t> stamp_;  // of slots: when they were filled
    std::uint32_t time_ = 0;
    std::vector<std::int32_t> divided_;  // by vertices
    std::size_t made_ = 0;
    bool is_capped_ = false;
    Buckets waiting_;
    Parts parts_;
    std::vector<Waiting> unmeasured_;
    std::unordered_set<std::uint64_t> stuck_;  // parts that cannot be split

    std::vector<Edge> in_the_way_;
    dynamic::Star star_;
    dynamic::Patch patch_;
    std::vector<TriangleId> fresh_;
    std::vector<Row> name_;  // of the vertices that were added
};

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
    wide_ = wanted.is_conforming ? 0 : of_twice * of_twice;
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
        for (unsigned k = 0; k < 3; ++k) look_at_side(edge(t, k));
    }
    push(found);
}

void Refinement::push(std::vector<Waiting>& all) {
    std::sort(all.begin(), all.end(), Order(mesh_));
    for (const Waiting& each : all) waiting_.push(each);
}

Status Refinement::run() {
    look_at_all();
    while (does_step()) {
        if (patience_.ends(256)) return Status::interrupted;
        if (made_ % 1024 == 0) tell();
    }
    return Status::ok;
}

// How far it is, by what waits now: more may.
void Refinement::tell() {
    constexpr std::size_t whole = 1000;
    if (told_ == 0) interrupt_.expect(whole);
    const std::size_t now = whole * made_ / (made_ + waiting_.size() + 1);
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
    } else if (!waiting_.empty())
        treat(waiting_.pop());
    else if (!unmeasured_.empty())
        measure();
    else if (!wanted_.is_conforming || conforms())
        return false;
    return !is_capped_;
}

// --- triangles ---------------------------------------------------------------------------------

Shape Refinement::shape(TriangleId t) const {
    Vector side[3];
    double length2[3];
    for (unsigned k = 0; k < 3; ++k) {
        side[k] = between(slots().tail(edge(t, k)), slots().head(edge(t, k)));
        length2[k] = square(side[k]);
    }
    const auto apex = [&](unsigned k) { return at(slots().vertex(t, k)); };
    unsigned base = 0;
    for (unsigned k = 1; k < 3; ++k)
        if (length2[k] < length2[base] ||
            (length2[k] == length2[base] && before_xy(apex(k), apex(base))))
            base = k;
    const Vector onward = side[(base + 1) % 3], back = side[(base + 2) % 3];
    const Corner corner(onward, {-back.x, -back.y});
    const double area = cross(onward, back);
    return {edge(t, base), length2[base],         *std::max_element(length2, length2 + 3),
            area,          corner.dot / 2 / area, corner.is_less(sharp_)};
}

// Whether the triangle over a base cannot be helped: its ends are as far from the corner of the two
// pieces that they divide.
bool Refinement::is_between_constraints(Edge base) const {
    const Vertex a = slots().tail(base), b = slots().head(base);
    if (divided_[a] < 0 || divided_[b] < 0 || divided_[a] == divided_[b]) return false;
    const constrained::Piece& one = pieces_[static_cast<std::size_t>(divided_[a])];
    const constrained::Piece& other = pieces_[static_cast<std::size_t>(divided_[b])];
    Row corner;
    if (one.first == other.first || one.first == other.second)
        corner = one.first;
    else if (one.second == other.first || one.second == other.second)
        corner = one.second;
    else
        return false;
    const auto found = std::lower_bound(rows_.begin(), rows_.end(), corner);
    const auto v = static_cast<Vertex>(found - rows_.begin());
    const double to_a = square(between(v, a)), to_b = square(between(v, b));
    return to_a < 1.001 * to_b && to_b < 1.001 * to_a;
}

// What is to be split. Lengths are measured later, of many triangles at once.
std::optional<Waiting> Refinement::need(TriangleId t) {
    if (!is_inside(t)) return {};
    const Shape found = shape(t);
    const Edge base = found.base;
    const Waiting named{found.base2, base, stamp_[slot_of(t)]};
    if (found.is_sharp) return is_between_constraints(base) ? std::nullopt : std::optional(named);
    if (!largest_.empty() && found.twice_area / 2 > largest_[static_cast<std::size_t>(region(t))])
        return named;
    if (wanted_.lengths) unmeasured_.push_back(named);
    return {};
}

void Refinement::look_at(TriangleId t) {
    if (const auto found = need(t)) waiting_.push(*found);
}

bool Refinement::is_gone(const Waiting& waiting) const {
    const TriangleId t = triangle_of(waiting.base);
    return slots().is_free(t) || stamp_[slot_of(t)] != waiting.stamp;
}

// Asks for the lengths that are wanted in all triangles that are new.
void Refinement::measure() {
    std::erase_if(unmeasured_, [this](const Waiting& each) { return is_gone(each); });
    std::vector<Point> centroids;
    std::vector<std::int32_t> regions;
    std::vector<double> lengths(unmeasured_.size());
    for (const Waiting& each : unmeasured_) {
        const Point p = at(slots().tail(each.base)), q = at(slots().head(each.base)),
                    r = at(slots().apex(each.base));
        centroids.push_back({p.x / 3 + q.x / 3 + r.x / 3, p.y / 3 + q.y / 3 + r.y / 3});
        regions.push_back(region(triangle_of(each.base)));
    }
    wanted_.lengths(centroids, regions, lengths.data());
    std::vector<Waiting> long_ones;
    for (std::size_t i = 0; i < lengths.size(); ++i) {
        const Shape found = shape(triangle_of(unmeasured_[i].base));
        const double most = std::numbers::sqrt2 * measures_.scaled(lengths[i]);
        if (found.longest2 > most * most) long_ones.push_back(unmeasured_[i]);
    }
    unmeasured_.clear();
    push(long_ones);
}

// --- points in triangles -----------------------------------------------------------------------

// The centre of the circle, or a place nearer to the base.
Point Refinement::center(const Shape& shape) const {
    const Vertex a = slots().tail(shape.base), b = slots().head(shape.base);
    const Vector base = between(a, b);
    const double height = std::min(shape.height, off_center_);
    return measures_.moved(at(a), {base.x / 2 - base.y * height, base.y / 2 + base.x * height});
}

void Refinement::treat(const Waiting& waiting) {
    if (is_gone(waiting)) return;
    if (made_ >= wanted_.most) {
        is_capped_ = true;
        return;
    }
    const TriangleId t = triangle_of(waiting.base);
    const Point p = center(shape(t));
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return;
    const Place found = walk(waiting.base, p);
    if (found.is_vertex) return;
    in_the_way_.clear();
    if (found.blocked != nothing) {
        in_the_way_.push_back(found.blocked);
    } else {
        mesh_.dig(p, found.triangle);
        for (const BorderEdge& each : mesh_.border())
            if (slots().is_marked(each.beyond) && is_encroached(each.beyond, p))
                in_the_way_.push_back(each.beyond);
    }
    if (in_the_way_.empty()) return add(p);
    bool is_asked = false;
    for (const Edge e : in_the_way_) is_asked |= ask_to_split(e);
    if (is_asked) waiting_.push(waiting);
}

bool Refinement::is_marked_at(Edge e, Point p) const {
    return slots().is_marked(e) && orient2d(at(slots().tail(e)), at(slots().head(e)), p) == 0;
}

// From a triangle to a point, up to a constraint. The way depends on positions alone.
Refinement::Place Refinement::walk(Edge base, Point p) const {
    Edge tried[3] = {base, next(base), previous(base)};
    unsigned first = 0;
    while (true) {
        Edge crossed = nothing;
        for (unsigned k = first; k < 3 && crossed == nothing; ++k)
            if (is_right_of(tried[k], p)) crossed = tried[k];
        const TriangleId t = triangle_of(tried[0]);
        if (crossed == nothing) {
            for (const Edge e : tried) {
                if (at(slots().apex(e)) == p) return {t, nothing, true};
                if (is_marked_at(e, p)) return {t, e};
            }
            return {t};
        }
        if (slots().is_marked(crossed)) return {t, crossed};
        const Edge from = slots().twin(crossed);
        tried[0] = from;
        tried[1] = next(from);
        tried[2] = previous(from);
        first = 1;
    }
}

void Refinement::add(Point p) {
    const std::int32_t inside = region(mesh_.cavity()[0]);
    fill(p, no_piece);
    for (const TriangleId t : mesh_.star()) region(t) = inside;
    look_around();
}

Vertex Refinement::fill(Point p, std::int32_t piece) {
    const Vertex v = mesh_.fill(p);
    ++made_;
    if (v >= divided_.size()) divided_.resize(v + std::size_t{1});
    divided_[v] = piece;
    region_.resize(slot_of(slots().end()), outside);
    stamp(mesh_.star());
    return v;
}

void Refinement::stamp(const std::vector<TriangleId>& triangles) {
    stamp_.resize(slot_of(slots().end()));
    ++time_;
    for (const TriangleId t : triangles) stamp_[slot_of(t)] = time_;
}

// The triangles around the last point, from the border's first one in the plane on.
void Refinement::look_around() {
    const auto& border = mesh_.border();
    std::size_t first = 0;
    for (std::size_t i = 1; i < border.size(); ++i)
        if (is_before(border[i].tail, border[first].tail)) first = i;
    for (std::size_t step = 0; step < border.size(); ++step) {
        const std::size_t i = (first + step) % border.size();
        const TriangleId t = mesh_.star()[i];
        if (slots().is_ghost(t)) continue;
        look_at_side(slots().twin(border[i].beyond));
        look_at(t);
    }
}

// --- constraints -------------------------------------------------------------------------------

// Whether a point is so near to a constraint that this is to be split.
bool Refinement::is_encroached(Edge e, Point p) const {
    const auto to = [&](Vertex v) { return measures_.between(p, at(v)); };
    return Corner(to(slots().tail(e)), to(slots().head(e))).is_wide(wide_);
}

// A side of a triangle, seen from inside.
void Refinement::look_at_side(Edge e) {
    const TriangleId t = triangle_of(e);
    if (!slots().is_marked(e) || slots().is_ghost(t)) return;
    if (!is_inside(t) && !wanted_.is_conforming) return;
    if (is_encroached(e, at(slots().apex(e)))) ask_to_split(e);
}

// False if it cannot be split.
bool Refinement::ask_to_split(Edge e) {
    Vertex a = slots().tail(e), b = slots().head(e);
    if (before_xy(at(b), at(a))) std::swap(a, b);
    const Part part{square(between(a, b)), a, b};
    if (!stuck_.empty() && stuck_.contains(key(part))) return false;
    parts_.push(part);
    return true;
}

// Whether another constraint ends at the tail of an edge, in a small angle inside; `beside` is that
// edge of the triangle on its left which ends there, or starts on its right.
bool Refinement::is_narrow(Edge e, Edge beside) const {
    constexpr double of_sixty_degrees2 = 0.25;
    if (!is_inside(triangle_of(beside)) || !slots().is_marked(beside)) return false;
    const Vertex corner = slots().tail(e);
    const Vertex other =
        slots().tail(beside) == corner ? slots().head(beside) : slots().tail(beside);
    return Corner(between(corner, slots().head(e)), between(corner, other))
        .is_less(of_sixty_degrees2);
}

// At the tail of an edge.
bool Refinement::has_narrow_corner(Edge e) const {
    return is_narrow(e, previous(e)) || is_narrow(e, next(slots().twin(e)));
}

Point Refinement::place(const Part& part, Edge e) const {
    const bool at_first = has_narrow_corner(e), at_second = has_narrow_corner(slots().twin(e));
    const Point a = at(part.first), b = at(part.second);
    if (at_first == at_second) return middle(a, b);
    return at_first ? at_shell(a, b, measures_) : at_shell(b, a, measures_);
}

// The piece that a part belongs to.
std::int32_t Refinement::piece_at(Vertex a, Vertex b) const {
    for (const Vertex v : {a, b})
        if (divided_[v] >= 0) return divided_[v];
    const auto [first, second] = std::minmax({rows_[a], rows_[b]});
    const auto found =
        std::lower_bound(pieces_.begin(), pieces_.end(), constrained::Piece{first, second});
    return static_cast<std::int32_t>(found - pieces_.begin());
}

void Refinement::split(const Part& part) {
    Edge e = mesh_.edge_between(part.first, part.second);
    if (e == nothing || !slots().is_marked(e)) return;
    if (made_ >= wanted_.most) {
        is_capped_ = true;
        return;
    }
    if (!wanted_.is_conforming) {
        clear_circle(part);
        e = mesh_.edge_between(part.first, part.second);
    }
    insert_on(part, e, place(part, e));
}

// Takes out points that were added, and that no constraint needs, near to one that is to be split.
void Refinement::clear_circle(const Part& part) {
    const auto side = [&] { return mesh_.edge_between(part.first, part.second); };
    if (has_narrow_corner(side()) || has_narrow_corner(slots().twin(side()))) return;
    while (remove_apex(side())) {
    }
    while (remove_apex(slots().twin(side()))) {
    }
}

bool Refinement::remove_apex(Edge e) {
    const TriangleId t = triangle_of(e);
    if (!is_inside(t)) return false;
    const Vertex v = slots().apex(e);
    if (divided_[v] != no_piece) return false;
    if (dot(between(v, slots().tail(e)), between(v, slots().head(e))) >= 0) return false;
    const std::int32_t inside = region(t);
    mesh_.find_star(v, star_);
    mesh_.plan(star_, patch_);
    mesh_.replace(v, star_, patch_, fresh_);
    for (const TriangleId each : fresh_) region(each) = inside;
    stamp(fresh_);
    in_order(fresh_);
    for (const TriangleId each : fresh_) {
        for (unsigned k = 0; k < 3; ++k) look_at_side(edge(each, k));
        look_at(each);
    }
    return true;
}

// Whether all of the border of the cavity can be seen from a point, which is off the line of the
// part that it divides as far as it was rounded.
bool Refinement::can_be_seen(Point p) const {
    return std::all_of(mesh_.border().begin(), mesh_.border().end(), [&](const BorderEdge& each) {
        return each.tail == ghost || each.head == ghost ||
               orient2d(at(each.tail), at(each.head), p) > 0;
    });
}

// The triangle that a point beside the middle of an edge is in, which may be a ghost; or `nothing`
// if that is behind a constraint, or far.
TriangleId Refinement::find_beside(Edge e, Point p) const {
    constexpr unsigned far = 16;
    TriangleId t = triangle_of(slots().is_ghost(triangle_of(e)) ? slots().twin(e) : e);
    for (unsigned step = 0; step < far; ++step) {
        if (slots().is_ghost(t)) return t;
        Edge crossed = nothing;
        bool is_in = true;
        for (unsigned k = 0; k < 3; ++k) {
            if (!is_right_of(edge(t, k), p)) continue;
            is_in = false;
            if (!slots().is_marked(edge(t, k))) crossed = edge(t, k);
        }
        if (is_in) return t;
        if (crossed == nothing) break;
        t = triangle_of(slots().twin(crossed));
    }
    return nothing;
}

// Digs the cavity of a point that divides a part; false if it was rounded so far from it that the
// ends cannot be seen from there.
bool Refinement::dig_across(const Part& part, Edge e, Point p) {
    if (p == at(part.first) || p == at(part.second)) return false;
    mesh_.unmark(e);
    const TriangleId t = find_beside(e, p);
    if (t != nothing) mesh_.dig(p, t);
    if (t != nothing && can_be_seen(p) && is_at_border(part.first) && is_at_border(part.second))
        return true;
    mesh_.mark(e);
    return false;
}

bool Refinement::is_at_border(Vertex v) const {
    const auto& border = mesh_.border();
    return std::any_of(border.begin(), border.end(),
                       [v](const BorderEdge& each) { return each.tail == v; });
}

void Refinement::insert_on(const Part& part, Edge e, Point middle) {
    constexpr std::size_t places = 9;
    const std::int32_t left = region(triangle_of(e)), right = region(triangle_of(slots().twin(e)));
    for (std::size_t i = 0; i < places; ++i) {
        const Point p = beside(middle, i);
        if (!dig_across(part, e, p)) continue;
        const Vertex v = fill(p, piece_at(part.first, part.second));
        divide(part, left, right);
        look_around();
        for (const Vertex end : {part.first, part.second}) {
            const Edge half = mesh_.edge_between(end, v);
            look_at_side(half);
            look_at_side(slots().twin(half));
        }
        return;
    }
    stuck_.insert(key(part));
}

// The star of a new vertex between the ends of a part: what is left of it has one region, what is
// right of it the other.
void Refinement::divide(const Part& part, std::int32_t left, std::int32_t right) {
    const auto& border = mesh_.border();
    std::size_t i = 0;
    while (border[i].tail != part.second) ++i;
    std::int32_t inside = left;
    for (std::size_t step = 0; step < border.size(); ++step, i = (i + 1) % border.size()) {
        const TriangleId t = mesh_.star()[i];
        if (border[i].tail == part.first) inside = right;
        if (border[i].tail == part.first || border[i].tail == part.second)
            mesh_.mark(slots().opposite(t, border[i].head));
        region(t) = slots().is_ghost(t) ? outside : inside;
    }
}

// Whether all constraints are in the triangulation without constraints; else some are to be split.
bool Refinement::conforms() {
    bool all = true;
    const Guard guard = Guard::anywhere();
    for (TriangleId t = 0; t < slots().end(); t += words_per_triangle) {
        if (slots().is_free(t) || slots().is_ghost(t)) continue;
        for (unsigned k = 0; k < 3; ++k) {
            const Edge e = edge(t, k), f = slots().twin(e);
            if (!slots().is_marked(e) || slots().apex(f) == ghost || f < e) continue;
            if (incircle_canonical(at(slots().vertex(t, 0)), at(slots().vertex(t, 1)),
                                   at(slots().vertex(t, 2)), at(slots().apex(f)), guard))
                all &= !ask_to_split(e);
        }
    }
    return all;
}

// --- the result --------------------------------------------------------------------------------

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
    for (TriangleId t = 0; t < slots().end(); t += words_per_triangle) {
        if (slots().is_free(t) || slots().is_ghost(t)) continue;
        found.regions.push_back(region(t));
        Cause cause = Cause::none;
        if (is_inside(t)) {
            const Shape its = shape(t);
            if (its.is_sharp)
                cause = is_between_constraints(its.base) ? Cause::between_constraints
                        : is_capped_                     ? Cause::cap
                                                         : Cause::precision;
        }
        found.causes.push_back(cause);
    }
    found.is_capped = is_capped_;
    return found;
}

}  // namespace

Refined refine(const Start& start, const Wanted& wanted, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    Refinement refinement(start, wanted, interrupt);
    const Status status = refinement.run();
    Refined found;
    if (status == Status::ok)
        found = refinement.result();
    else
        found.status = status;
    return found;
}

}  // namespace liftmesh::refinement
