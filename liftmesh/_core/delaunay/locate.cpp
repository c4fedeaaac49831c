#include "delaunay/locate.hpp"

#include "base/buffer.hpp"
#include "base/floating_point.hpp"
#include "delaunay/first_containing.hpp"
#include "delaunay/walk.hpp"
#include "parallel/blocks.hpp"
#include "sorting/sample.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t simplices_per_cell = 16;
constexpr std::size_t starts_per_cell = 2;
constexpr std::size_t short_walk = 48, step_aside = 12;  // steps
constexpr std::size_t queries_per_trial = 128, least_trials = 4, most_trials = 256;
constexpr std::size_t hard_together = 15;                        // queries after one that was hard
constexpr std::size_t queries_per_round = std::size_t{1} << 22;  // bounds the memory of the order
constexpr std::size_t piece_size = std::size_t{1} << 12;
constexpr std::size_t walks_abreast = 48, queries_per_start = 8;
constexpr std::size_t price_of_exact_step = 6;  // in steps that rounded arithmetic decides
constexpr std::size_t triangles_per_step_of_hubs = 2;
constexpr std::size_t steps_per_query = 128;  // roughly, in the map and from there
constexpr std::size_t ahead = 4;              // queries that are fetched from memory in advance

int depth_for(std::size_t simplices) {
    return static_cast<int>(std::bit_width(simplices / simplices_per_cell + 1)) - 1;
}

// In steps of long walks.
std::size_t price_of_map(const Triangulated& mesh) {
    return 3 * std::min(mesh.count, mesh.points.rows) / 2;
}

Splitters splitters_for(const Triangulated& mesh) {
    const int depth = depth_for(mesh.count);
    const IeeeArithmetic ieee;
    std::vector<Point> sample(std::size_t{1} << depth);
    for (std::size_t i = 0; i < sample.size(); ++i)
        sample[i] = mesh.corner(static_cast<std::int32_t>(sample_place(i, mesh.count)),
                                static_cast<int>(i % 3));
    return Splitters(std::move(sample), depth);
}

}  // namespace

Locator::Locator(const Triangulated& triangulated, std::uint64_t secret)
    : mesh_(triangulated),
      splitters_(splitters_for(triangulated)),
      start_(splitters_.cells(), -1),
      secret_(secret),
      map_(price_of_map(triangulated)),
      hubs_(triangulated.count / triangles_per_step_of_hubs) {
    const IeeeArithmetic ieee;
    constexpr std::size_t abreast = 8;
    const std::size_t starts = std::min(mesh_.count, starts_per_cell * splitters_.cells());
    for (std::size_t i = 0; i < starts; i += abreast) {
        Abreast<abreast> corners{};
        std::int32_t simplices[abreast];
        for (std::size_t k = 0; k < abreast; ++k) {
            const std::size_t place = std::min(i + k, starts - 1);
            simplices[k] = static_cast<std::int32_t>(mesh_.count * place / starts);
            const Point corner = mesh_.corner(simplices[k], 0);
            corners[k] = {corner.x, corner.y};
        }
        const auto cells = splitters_.cells(corners);
        for (std::size_t k = 0; k < abreast; ++k) start_[cells[k]] = simplices[k];
    }
    // An empty cell starts where its predecessor does: in kd order they are neighbours.
    std::int32_t last = 0;
    for (std::int32_t& start : start_) last = start = start < 0 ? last : start;
}

// Some queries of one call.
class Locator::Round {
 public:
    Round(Locator& locator, const Queries& queries, std::int32_t* found, ThreadPool& pool,
          const Settled& settled, std::size_t start)
        : locator_(locator),
          mesh_(locator.mesh_),
          queries_(queries),
          found_(found),
          pool_(pool),
          settled_(settled),
          start_(start) {}

    bool run() {
        if (!are_neighbors()) {
            order_ = in_spatial_order(queries_, locator_.splitters_, pool_);
            if (!order_) return false;
        }
        const std::size_t pieces = (queries_.count + piece_size - 1) / piece_size;
        const auto walk = [&](std::size_t i) {
            const std::size_t last = std::min(queries_.count, (i + 1) * piece_size);
            if (walk_through(i * piece_size, last) && settled_) report(i * piece_size, last);
        };
        return pool_.run(pieces, walk) && (hard_.empty() || find_hard()) &&
               (at_hubs_.empty() || find_at_hubs()) && (!settled_ || report_late());
    }

 private:
    struct AtHub {
        std::int32_t vertex;
        std::uint32_t query;
    };
    // Queries that are left for later.
    struct Postponed {
        std::vector<Site> hard;  // a walk does not reach them soon
        std::vector<AtHub> at_hubs;
    };

    // What was found of the queries at some places of the order.
    void report(std::size_t first, std::size_t last) {
        Patience patience(pool_.interrupt());
        for (std::size_t i = first; i < last && !patience.ends(); ++i) {
            if (last - i > 2 * ahead) {
                const std::uint32_t next = query_at(i + 2 * ahead);
                queries_.prefetch(next);
                prefetch(found_ + next);
            }
            report(query_at(i), patience);
        }
    }
    std::uint32_t query_at(std::size_t place) const {
        return order_ ? order_[place].index : static_cast<std::uint32_t>(place);
    }
    void report(std::uint32_t query, Patience& patience) {
        if (found_[query] != unfinished) settled_(start_ + query, found_[query], patience);
    }

    // What was left for later.
    bool report_late() {
        const auto report_some = [&](const auto& late, auto query) {
            return in_blocks(late.size(), piece_size, pool_,
                             [&](std::size_t i, std::size_t last, std::size_t) {
                                 Patience patience(pool_.interrupt());
                                 for (; i < last; ++i) report(query(late[i]), patience);
                             });
        };
        return report_some(hard_, [](const Site& each) { return each.row; }) &&
               report_some(at_hubs_, [](const AtHub& each) { return each.query; });
    }

    // Whether it is a short walk from most queries to the next, judged from a few pairs.
    bool are_neighbors() const {
        const std::size_t pairs = std::min(
            {queries_.count / 2, queries_.count / queries_per_trial + least_trials, most_trials});
        std::size_t near = 0;
        for (std::size_t i = 0; i < pairs; ++i) {
            const std::size_t at = sample_place(i, queries_.count - 1);
            if (!is_finite(queries_[at]) || !is_finite(queries_[at + 1])) continue;
            Walk walk(mesh_);
            walk.begin(queries_[at], locator_.start_[cell(at)]);
            if (!ends_within(short_walk, walk)) continue;
            walk.begin(queries_[at + 1], walk.at());
            near += ends_within(step_aside, walk);
        }
        return near > pairs / 2;
    }

    static bool ends_within(std::size_t steps, Walk& walk) {
        for (walk.look(); walk.step(); walk.look())
            if (steps-- == 0) return false;
        return true;
    }

    // One of several walks, from query to query. In the spatial order each cell has a start of its
    // own; otherwise a cell's start helps where the way from the last query was too long.
    class Lane {
     public:
        Lane(Round& round, std::size_t first, std::size_t last, Postponed& postponed)
            : round_(round), next_(first), last_(last), postponed_(postponed), walk_(round.mesh_) {
            if (!round.order_ && first != last) enter(round.cell(first));
            next();
        }

        void look() {
            if (is_walking_) walk_.look();
        }

        // A step, or the end of a walk and the begin of the next. False once all queries are done.
        bool advance() {
            if (!is_walking_) return false;
            if (walk_.step()) {
                if (++steps_ > short_walk && !may_go_on()) give_up();
            } else {
                settle();
            }
            return is_walking_;
        }

     private:
        void next() {
            for (is_walking_ = false; !is_walking_ && next_ != last_;) {
                take();
                const Point p = round_.queries_[query_];
                if (!is_finite(p)) {
                    round_.found_[query_] = outside;
                } else if (hard_to_come_ > 0) {
                    --hard_to_come_;
                    postpone(p);
                } else {
                    has_jumped_ = round_.order_ != nullptr;
                    begin();
                }
            }
        }

        void take() {
            const Query* order = round_.order_.get();
            query_ = order ? order[next_].index : static_cast<std::uint32_t>(next_);
            if (last_ - next_ > ahead)
                round_.queries_.prefetch(order ? order[next_ + ahead].index : next_ + ahead);
            if (order) {
                __builtin_prefetch(order + next_ + 4 * ahead);
                if (order[next_].cell != cell_) enter(order[next_].cell);
            }
            ++next_;
        }

        void enter(std::uint32_t cell) {
            cell_ = cell;
            start_ = round_.locator_.start_[cell_];
            hard_to_come_ = 0;
        }

        void begin() {
            walk_.begin(round_.queries_[query_], start_);
            steps_ = 0;
            is_walking_ = true;
        }

        // A walk that has not begun in the cell of its query does so first.
        bool may_go_on() {
            if (!has_jumped_ || round_.locator_.map_.credit() == 0) return false;
            const std::size_t exact =
                walk_.exact_steps() - std::exchange(paid_, walk_.exact_steps());
            round_.locator_.map_.pay(1 + exact * price_of_exact_step);
            return true;
        }

        void settle() {
            round_.settle({round_.queries_[query_], query_}, walk_, postponed_);
            start_ = walk_.at();
            next();
        }

        // Where one query is hard, the next ones are probably, too.
        void give_up() {
            if (!has_jumped_) {
                has_jumped_ = true;
                enter(round_.cell(query_));
                return begin();
            }
            postpone(round_.queries_[query_]);
            hard_to_come_ = hard_together;
            next();
        }

        void postpone(Point query) {
            round_.found_[query_] = unfinished;
            postponed_.hard.push_back({query, query_});
        }

        Round& round_;
        std::size_t next_, last_;
        Postponed& postponed_;
        Walk walk_;
        std::uint32_t query_ = 0, cell_ = ~std::uint32_t{0};
        std::int32_t start_ = 0;
        std::size_t steps_ = 0, hard_to_come_ = 0, paid_ = 0;
        bool has_jumped_ = false, is_walking_ = false;
    };

    std::uint32_t cell(std::size_t query) const {
        return static_cast<std::uint32_t>(locator_.splitters_.cell(queries_[query]));
    }

    // Several walks go through a share of the queries each. False if the interrupt came first.
    bool walk_through(std::size_t first, std::size_t last) {
        Patience patience(pool_.interrupt());
        Postponed postponed;
        std::vector<Lane> lanes;
        // Where a walk begins at the last query's end, its first one is the longest.
        const std::size_t each = order_ ? 1 : queries_per_start;
        const std::size_t count = std::min(walks_abreast, (last - first + each - 1) / each);
        lanes.reserve(count);
        for (std::size_t i = 0; i < count; ++i)
            lanes.emplace_back(*this, first + (last - first) * i / count,
                               first + (last - first) * (i + 1) / count, postponed);
        bool are_busy = true;
        while (are_busy && !patience.ends(count)) {
            are_busy = false;
            for (Lane& lane : lanes) lane.look();
            for (Lane& lane : lanes) are_busy |= lane.advance();
        }
        add(postponed);
        return !are_busy;
    }

    void add(const Postponed& postponed) {
        if (postponed.hard.empty() && postponed.at_hubs.empty()) return;
        const std::lock_guard lock(mutex_);
        hard_.insert(hard_.end(), postponed.hard.begin(), postponed.hard.end());
        at_hubs_.insert(at_hubs_.end(), postponed.at_hubs.begin(), postponed.at_hubs.end());
    }

    // Notes where a walk has ended.
    template <class EndedWalk>
    void settle(const Site& query, const EndedWalk& walk, Postponed& postponed) {
        std::int32_t& found = found_[query.row];
        found = walk.is_outside() ? outside : walk.at();
        if (walk.is_outside() || !walk.is_in_doubt()) return;
        std::size_t steps = 2 * Hubs::least_degree;
        found = first_containing(mesh_, query.point, walk.at(), steps);
        if (found == unfinished) settle_at_hub(query, walk.at(), postponed);
    }

    // Goes around a vertex of many triangles while there is credit.
    void settle_at_hub(const Site& query, std::int32_t triangle, Postponed& postponed) {
        if (const std::size_t credit = locator_.hubs_.credit()) {
            std::size_t left = credit;
            found_[query.row] = first_containing(mesh_, query.point, triangle, left);
            locator_.hubs_.pay(credit - left);
            if (found_[query.row] != unfinished) return;
        }
        postponed.at_hubs.push_back({vertex_at(mesh_, query.point, triangle), query.row});
    }

    bool find_hard() {
        Patience patience(pool_.interrupt());
        const auto make = [&] {
            return std::make_unique<const TrapezoidMap>(mesh_, locator_.secret_, patience);
        };
        const TrapezoidMap* map = locator_.map_.get(make, patience);
        if (!map) return false;
        // Few pieces, so that many queries of a trapezoid are in the same.
        const std::size_t most = pool_.size() == 1 ? 1 : 2 * pool_.size();
        const std::size_t pieces = std::min(hard_.size() / 256 + 1, most);
        const auto start = [&](std::size_t i) { return hard_.data() + hard_.size() * i / pieces; };
        return pool_.run(pieces, [&](std::size_t i) { find_hard(*map, start(i), start(i + 1)); });
    }

    void find_hard(const TrapezoidMap& map, Site* first, Site* last) {
        Patience patience(pool_.interrupt());
        Postponed postponed;
        VerticalWalks walks(mesh_, longest_walk_, [&](const Site& query, const VerticalWalk& walk) {
            settle(query, walk, postponed);
        });
        map.descend(first, last, [&](const Bundle& bundle) {
            for (const Site* query = bundle.first; query != bundle.last; ++query)
                found_[query->row] = outside;
            const auto size = static_cast<std::size_t>(bundle.last - bundle.first);
            if (bundle.edge != no_edge && !patience.ends(size * steps_per_query)) walks.add(bundle);
        });
        walks.finish();
        add(postponed);
    }

    bool find_at_hubs() {
        Patience patience(pool_.interrupt());
        const auto make = [&] { return std::make_unique<const Hubs>(mesh_, patience); };
        const Hubs* hubs = locator_.hubs_.get(make, patience);
        if (!hubs) return false;
        for (const AtHub& each : at_hubs_) found_[each.query] = hubs->first_triangle(each.vertex);
        return true;
    }

    Locator& locator_;
    const Triangulated& mesh_;
    const Queries& queries_;
    std::int32_t* found_;
    ThreadPool& pool_;
    const Settled& settled_;
    std::size_t start_;  // queries of former rounds
    Buffer<Query> order_;
    std::mutex mutex_;
    std::vector<Site> hard_;
    std::vector<AtHub> at_hubs_;
    std::atomic<std::size_t> longest_walk_ = mesh_.count;
};

bool Locator::find(const Queries& queries, std::int32_t* found, Threads threads,
                   Interrupt& interrupt, const Settled& settled) {
    const IeeeArithmetic ieee;
    ThreadPool pool(threads.for_rows(queries.count), interrupt);
    for (std::size_t start = 0; start < queries.count; start += queries_per_round) {
        const Queries some{queries.coordinates + 2 * start,
                           std::min(queries_per_round, queries.count - start)};
        if (!Round(*this, some, found + start, pool, settled, start).run()) return false;
    }
    return true;
}

}  // namespace liftmesh
