#include "delaunay/locate.hpp"

#include <algorithm>
#include <bit>
#include <mutex>

#include "base/floating_point.hpp"
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
constexpr std::size_t ahead = 4;  // queries that are fetched from memory in advance

int depth_for(std::size_t simplices) {
    return static_cast<int>(std::bit_width(simplices / simplices_per_cell + 1)) - 1;
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

Locator::Locator(const Triangulated& triangulated)
    : mesh_(triangulated),
      splitters_(splitters_for(triangulated)),
      start_(splitters_.cells(), -1),
      credit_(static_cast<std::int64_t>(triangulated.count / 4)) {
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

Locator::~Locator() {
    delete index_.load();
}

// Two threads that need it at once make one each, and the first to finish keeps it: a lock held
// during a fork would never be released in the child.
const Locator::Index* Locator::index(Patience& patience) {
    if (const Index* ready = index_.load()) return ready;
    std::unique_ptr<const Index> made(new Index{{mesh_, patience}, {mesh_, patience}});
    if (patience.ends()) return nullptr;
    const Index* ready = nullptr;
    return index_.compare_exchange_strong(ready, made.get()) ? made.release() : ready;
}

// Some queries of one call.
class Locator::Round {
 public:
    Round(Locator& locator, const Queries& queries, std::int32_t* found, ThreadPool& pool)
        : locator_(locator), mesh_(locator.mesh_), queries_(queries), found_(found), pool_(pool) {}

    bool run() {
        if (!are_neighbors()) {
            order_ = in_spatial_order(queries_, locator_.splitters_, pool_);
            if (!order_) return false;
        }
        const std::size_t pieces = (queries_.count + piece_size - 1) / piece_size;
        const auto walk = [&](std::size_t i) {
            walk_through(i * piece_size, std::min(queries_.count, (i + 1) * piece_size));
        };
        return pool_.run(pieces, walk) && (hard_.empty() || find_hard());
    }

 private:
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
        Lane(Round& round, std::size_t first, std::size_t last, std::vector<Site>& hard)
            : round_(round), next_(first), last_(last), hard_(hard), walk_(round.mesh_) {
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
                    round_.found_[query_] = Walk::outside;
                } else if (hard_to_come_ > 0) {
                    --hard_to_come_;
                    hard_.push_back({p, query_});
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
        bool may_go_on() { return has_jumped_ && round_.locator_.credit_-- > 0; }

        void settle() {
            const std::int32_t answer = walk_.answer(nullptr);
            if (answer == Walk::unfinished) return give_up();
            round_.found_[query_] = answer;
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
            hard_.push_back({round_.queries_[query_], query_});
            hard_to_come_ = hard_together;
            next();
        }

        Round& round_;
        std::size_t next_, last_;
        std::vector<Site>& hard_;
        Walk walk_;
        std::uint32_t query_ = 0, cell_ = ~std::uint32_t{0};
        std::int32_t start_ = 0;
        std::size_t steps_ = 0, hard_to_come_ = 0;
        bool has_jumped_ = false, is_walking_ = false;
    };

    std::uint32_t cell(std::size_t query) const {
        return static_cast<std::uint32_t>(locator_.splitters_.cell(queries_[query]));
    }

    // Several walks go through a share of the queries each.
    void walk_through(std::size_t first, std::size_t last) {
        Patience patience(pool_.interrupt());
        std::vector<Site> hard;
        std::vector<Lane> lanes;
        // Where a walk begins at the last query's end, its first one is the longest.
        const std::size_t each = order_ ? 1 : queries_per_start;
        const std::size_t count = std::min(walks_abreast, (last - first + each - 1) / each);
        lanes.reserve(count);
        for (std::size_t i = 0; i < count; ++i)
            lanes.emplace_back(*this, first + (last - first) * i / count,
                               first + (last - first) * (i + 1) / count, hard);
        for (bool are_busy = true; are_busy && !patience.ends(count);) {
            are_busy = false;
            for (Lane& lane : lanes) lane.look();
            for (Lane& lane : lanes) are_busy |= lane.advance();
        }
        add(hard);
    }

    void add(const std::vector<Site>& hard) {
        if (hard.empty()) return;
        const std::lock_guard lock(mutex_);
        hard_.insert(hard_.end(), hard.begin(), hard.end());
    }

    bool find_hard() {
        Patience patience(pool_.interrupt());
        const Index* index = locator_.index(patience);
        if (!index) return false;
        const std::size_t pieces = std::min<std::size_t>(hard_.size() / 256 + 1, 8 * pool_.size());
        const auto start = [&](std::size_t i) { return hard_.data() + hard_.size() * i / pieces; };
        return pool_.run(pieces, [&](std::size_t i) { find_hard(*index, start(i), start(i + 1)); });
    }

    void find_hard(const Index& index, Site* first, Site* last) {
        Patience patience(pool_.interrupt());
        Walk walk(mesh_);
        index.edges.descend(first, last, [&](Site* from, Site* to, std::int32_t start) {
            for (const Site* query = from; query != to && !patience.ends(); ++query) {
                found_[query->row] = Walk::outside;
                if (start < 0) continue;
                walk.begin(query->point, start);
                walk_to_end(walk, patience);
                found_[query->row] = std::max(walk.answer(&index.hubs), Walk::outside);
                start = walk.at();
            }
        });
    }

    // A walk longer than the triangulation means that the arrays were modified. What is found is
    // meaningless then, and the next walks end soon.
    void walk_to_end(Walk& walk, Patience& patience) {
        std::size_t steps = 0;
        for (walk.look(); walk.step(); walk.look()) {
            if (patience.ends()) return;
            if (++steps <= longest_walk_) continue;
            longest_walk_ = short_walk;
            return;
        }
    }

    Locator& locator_;
    const Triangulated& mesh_;
    const Queries& queries_;
    std::int32_t* found_;
    ThreadPool& pool_;
    Buffer<Query> order_;
    std::mutex mutex_;
    std::vector<Site> hard_;
    std::atomic<std::size_t> longest_walk_ = mesh_.count;
};

bool Locator::find(const Queries& queries, std::int32_t* found, Threads threads,
                   Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    ThreadPool pool(threads.for_rows(queries.count), interrupt);
    for (std::size_t start = 0; start < queries.count; start += queries_per_round) {
        const Queries some{queries.coordinates + 2 * start,
                           std::min(queries_per_round, queries.count - start)};
        if (!Round(*this, some, found + start, pool).run()) return false;
    }
    return true;
}

}  // namespace liftmesh
