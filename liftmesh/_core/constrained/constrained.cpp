#include "constrained/constrained.hpp"

#include "base/floating_point.hpp"
#include "constrained/insertion.hpp"
#include "constrained/rounds.hpp"
#include "delaunay/divide_conquer.hpp"
#include "predicates/orient2d.hpp"
#include "sorting/counting_sort.hpp"
#include "sorting/patient_sort.hpp"

namespace liftmesh {

namespace constrained {

namespace {

// An edge between vertices of the construction.
struct Placed {
    Vertex a, b;
    EdgeId edge;
    auto operator<=>(const Placed&) const = default;
};

// A piece, and an edge that it is part of.
struct Membership {
    Piece piece;
    EdgeId edge;
    auto operator<=>(const Membership&) const = default;
};

// A span of an edge that crosses others, at a triangle that it meets.
struct Visit {
    TriangleId triangle;
    EdgeId edge;
    Span span;
};

// Sorts items, whose numbers key(item) are below `keys` and ascend with them.
template <class Item, class Key>
bool sort(std::vector<Item>& items, std::size_t keys, ThreadPool& pool, Key key) {
    constexpr std::size_t stretch = 8;  // numbers in a bucket
    const auto bucket = [&](const Item& item) { return key(item) / stretch; };
    std::vector<Item> sorted(items.size());
    CountingSort by_bucket(items.size(), 1, keys / stretch + 1, pool);
    const auto visit_items = [&](const Share&, auto visit) {
        std::for_each(items.begin(), items.end(), visit);
    };
    const auto store = [&](std::size_t place, const Item& item) { sorted[place] = item; };
    if (!by_bucket.sort(visit_items, bucket, store)) return false;
    const std::vector<std::size_t> starts = std::move(by_bucket).starts();
    for (std::size_t i = 0; i + 1 < starts.size(); ++i)
        std::sort(sorted.data() + starts[i], sorted.data() + starts[i + 1]);
    items = std::move(sorted);
    return true;
}

class Constraints {
 public:
    Constraints(const Delaunay& start, Construction& mesh, std::size_t rows, Guard guard,
                ThreadPool& pool)
        : mesh_(mesh),
          rows_(rows),
          guard_(guard),
          pool_(pool),
          patience_(pool.interrupt()),
          marks_(2 * mesh.count - 2),
          vertex_of_row_(allocate<Vertex>(rows)) {
        std::fill_n(vertex_of_row_.get(), rows, ghost);
        for (std::size_t v = 0; v < mesh.count; ++v)
            vertex_of_row_[mesh.rows[v]] = static_cast<Vertex>(v);
        for (const Duplicate& each : start.duplicates)
            vertex_of_row_[each.row] = vertex_of_row_[each.kept];
    }

    Mark* marks() { return marks_.data(); }

    // False if interrupted, or if the edges cannot be put in: then the result says why.
    bool run(const std::int32_t* edges, std::size_t count, Constrained& result) {
        if (!place(edges, count, result)) return false;
        if (!result.unplaced.empty() || !has_triangles()) return true;
        Insertion insertion(mesh_, marks_.data(), guard_);
        if (!insert(insertion)) return false;
        const auto first_row = [](const Membership& each) { return each.piece.first; };
        if (!sort(memberships_, rows_, pool_, first_row)) return false;
        if (!crossing_.empty()) return find_crossings(insertion, result.crossings);
        list(result);
        return true;
    }

 private:
    bool has_triangles() const {
        const Edge across = mesh_.twins[edge(mesh_.some_ghost, 2)];
        return mesh_.vertices[triangle_of(across) + 2] != ghost;
    }

    // In the order of their ends: neighbours in the plane are neighbours in memory.
    bool place(const std::int32_t* edges, std::size_t count, Constrained& result) {
        placed_.reserve(count);
        for (std::size_t i = 0; i < count; ++i) {
            const auto id = static_cast<EdgeId>(i);
            const Vertex a = vertex_of_row_[edges[2 * i]], b = vertex_of_row_[edges[2 * i + 1]];
            if (a == ghost || b == ghost)
                result.unplaced.push_back(id);
            else if (a == b)
                result.zero_length.push_back(id);
            else
                placed_.push_back({std::min(a, b), std::max(a, b), id});
        }
        return sort(placed_, mesh_.count, pool_, [](const Placed& each) { return each.a; });
    }

    // In the order of their ends, until they turn out to cross many triangles: then in rounds.
    bool insert(Insertion& insertion) {
        constexpr std::size_t many = 16, least = 256;
        memberships_.reserve(placed_.size());
        if (!mark_those_there(insertion)) return false;
        std::size_t done = 0, met = 0;
        for (; done < placed_.size() && met <= many * (done + least); ++done) {
            met += insert(placed_[done], insertion);
            if (patience_.ends()) return false;
        }
        if (done < placed_.size() && !crossing_.empty()) {
            begin_anew();
            done = 0;
        }
        const std::span<Placed> rest = std::span(placed_).subspan(done);
        return rest.empty() || (sort_by_lines(rest) && Rounds(rest.size()).run([&](std::size_t i) {
                   insert(rest[i], insertion);
                   return !patience_.ends();
               }));
    }

    // All edges again, in a random order, where a few are in the way of many that meet many
    // triangles: put in first, as sides of a polygon across thin faces, they would keep out all of
    // those, and each would be followed through all triangles. What crosses is in no way else.
    void begin_anew() {
        placed_.insert(placed_.end(), there_.begin(), there_.end());
        std::fill(marks_.begin(), marks_.end(), Mark{0});
        memberships_.clear();
        crossing_.clear();
    }

    // Edges that triangles have already come first, as far as this looks: they change nothing, and
    // what crosses many of them is known as such before it takes these triangles away. Where next
    // to none are there, looking for them takes a tenth of the time, and ends early.
    bool mark_those_there(Insertion& insertion) {
        constexpr std::size_t few = 32, least = 2048;
        std::size_t left = 0;
        while (left + there_.size() < placed_.size() && left <= few * there_.size() + least) {
            if (patience_.ends()) return false;
            const Placed each = placed_[left + there_.size()];
            if (insertion.mark_if_there(each.a, each.b)) {
                memberships_.push_back({piece({each.a, each.b}), each.edge});
                there_.push_back(each);
            } else {
                placed_[left++] = each;
            }
        }
        const auto first = placed_.begin() + static_cast<std::ptrdiff_t>(left);
        placed_.erase(first, first + static_cast<std::ptrdiff_t>(there_.size()));
        return true;
    }

    bool sort_by_lines(std::span<Placed> edges) const {
        struct Keyed {
            std::uint64_t key;
            Placed edge;
        };
        const Point* points = mesh_.points.get();
        Bounds box = Bounds::nothing();
        for (std::size_t v = 0; v < mesh_.count; ++v) box.add(pair(points + v));
        const LineOrder order(box);
        std::vector<Keyed> keyed;
        keyed.reserve(edges.size());
        for (const Placed& each : edges)
            keyed.push_back({order(points[each.a], points[each.b]), each});
        const auto is_less = [](const Keyed& one, const Keyed& other) {
            return one.key < other.key;
        };
        if (!patient_sort(keyed, is_less, pool_.interrupt())) return false;
        for (std::size_t i = 0; i < edges.size(); ++i) edges[i] = keyed[i].edge;
        return true;
    }

    // Returns how many triangles it met.
    std::size_t insert(const Placed& edge, Insertion& insertion) {
        std::size_t met = 0;
        bool crosses = false;
        insertion.insert(edge.a, edge.b, [&](Span span, const std::vector<Edge>& crossed) {
            met += insertion.met();
            crosses |= !crossed.empty();
            memberships_.push_back({piece(span), edge.edge});
        });
        if (crosses) crossing_.push_back(edge);
        return met;
    }

    Piece piece(Span span) const {
        const auto [first, second] = std::minmax({mesh_.rows[span.from], mesh_.rows[span.to]});
        return {first, second};
    }

    void list(Constrained& result) const {
        result.pieces.reserve(memberships_.size());
        result.starts.reserve(memberships_.size() + 1);
        result.members.reserve(memberships_.size());
        for (const Membership& each : memberships_) {
            if (result.pieces.empty() || result.pieces.back() != each.piece) {
                result.pieces.push_back(each.piece);
                result.starts.push_back(static_cast<std::uint32_t>(result.members.size()));
            }
            result.members.push_back(each.edge);
        }
        result.starts.push_back(static_cast<std::uint32_t>(result.members.size()));
    }

    // Each edge that was found to cross another is followed through all that are in by now. Two of
    // them cross in a triangle that both meet.
    bool find_crossings(Insertion& insertion, std::vector<Crossing>& crossings) {
        std::vector<Visit> visits;
        for (const Placed& each : crossing_) {
            insertion.follow(
                each.a, each.b,
                [&](Span span, const auto& crossed, const std::vector<TriangleId>& met) {
                    for (const Edge e : crossed) add_members(insertion.ends(e), each, crossings);
                    for (const TriangleId t : met) visits.push_back({t, each.edge, span});
                });
            if (patience_.ends(1 + visits.size() / 64)) return false;
        }
        const auto is_less = [](const Visit& one, const Visit& other) {
            return std::tie(one.triangle, one.edge) < std::tie(other.triangle, other.edge);
        };
        if (!patient_sort(visits, is_less, pool_.interrupt())) return false;
        for (std::size_t i = 0, last = 0; i < visits.size(); i = last) {
            while (last < visits.size() && visits[last].triangle == visits[i].triangle) ++last;
            if (!compare({&visits[i], last - i}, crossings)) return false;
        }
        if (!patient_sort(crossings, std::less<>(), pool_.interrupt())) return false;
        crossings.erase(std::unique(crossings.begin(), crossings.end()), crossings.end());
        return true;
    }

    // Compares all spans that meet a triangle, but not those of a star with each other.
    bool compare(std::span<Visit> visits, std::vector<Crossing>& crossings) {
        const Vertex center = most_common_end(visits);
        const auto star = std::partition(visits.begin(), visits.end(), [&](const Visit& each) {
            return each.span.from != center && each.span.to != center;
        });
        for (auto one = visits.begin(); one != star; ++one) {
            for (auto other = one + 1; other != visits.end(); ++other)
                if (cross(one->span, other->span)) add(one->edge, other->edge, crossings);
            if (patience_.ends(1 + visits.size() / 16)) return false;
        }
        return true;
    }

    static Vertex most_common_end(std::span<const Visit> visits) {
        std::vector<Vertex> ends;
        for (const Visit& each : visits) ends.insert(ends.end(), {each.span.from, each.span.to});
        std::sort(ends.begin(), ends.end());
        std::size_t most = 0;
        Vertex found = ends[0];
        for (auto at = ends.begin(); at != ends.end();) {
            const auto after = std::upper_bound(at, ends.end(), *at);
            if (static_cast<std::size_t>(after - at) > most) {
                most = static_cast<std::size_t>(after - at);
                found = *at;
            }
            at = after;
        }
        return found;
    }

    void add_members(Span ends, const Placed& other, std::vector<Crossing>& crossings) const {
        const Membership least{piece(ends), 0};
        auto at = std::lower_bound(memberships_.begin(), memberships_.end(), least);
        for (; at != memberships_.end() && at->piece == least.piece; ++at)
            add(at->edge, other.edge, crossings);
    }

    static void add(EdgeId one, EdgeId other, std::vector<Crossing>& crossings) {
        if (one != other) crossings.push_back({std::min(one, other), std::max(one, other)});
    }

    bool cross(Span s, Span t) const {
        if (s.from == t.from || s.from == t.to || s.to == t.from || s.to == t.to) return false;
        const auto parts = [this](Span line, Span ends) {
            const Point a = mesh_.points[line.from], b = mesh_.points[line.to];
            return orient2d(a, b, mesh_.points[ends.from]) * orient2d(a, b, mesh_.points[ends.to]) <
                   0;
        };
        return parts(s, t) && parts(t, s);
    }

    Construction& mesh_;
    std::size_t rows_;
    Guard guard_;
    ThreadPool& pool_;
    Patience patience_;
    std::vector<Mark> marks_;
    Buffer<Vertex> vertex_of_row_;
    std::vector<Placed> placed_, there_, crossing_;
    std::vector<Membership> memberships_;
};

}  // namespace

}  // namespace constrained

Constrained constrained_delaunay(const Input& input, const std::int32_t* edges, std::size_t count,
                                 bool skip_non_finite, Threads threads, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    ThreadPool pool(threads.for_rows(input.rows), interrupt);
    interrupt.expect(input.rows * (work::sorting + work::triangulating + work::compacting));
    Order order;
    Constrained result;
    static_cast<Delaunay&>(result) = start(input, skip_non_finite, pool, order);
    if (result.status != Status::ok) return result;
    Construction mesh;
    const Guard guard = order.scale.guard;
    result.status = divide_and_conquer(Paraboloid{}, guard, order, pool, mesh);
    if (result.status != Status::ok) return result;
    constrained::Constraints constraints(result, mesh, input.rows, guard, pool);
    if (!constraints.run(edges, count, result)) {
        result.status = Status::interrupted;
        return result;
    }
    if (!result.unplaced.empty() || !result.crossings.empty()) return result;
    mesh.marks = constraints.marks();
    result.status = compact(std::move(mesh), pool, result.result);
    result.marks.assign(mesh.marks, mesh.marks + result.result.triangle_count);
    return result;
}

}  // namespace liftmesh
