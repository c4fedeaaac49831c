#include "family.hpp"

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <random>

#include "delaunay/delaunay.hpp"
#include "delaunay/locate.hpp"
#include "verify/verify.hpp"

namespace parallel {

namespace {

using liftmesh::Member;
using liftmesh::Regular;
using liftmesh::Status;
using liftmesh::Threads;

class Limited final : public liftmesh::Interrupt {
 public:
    explicit Limited(std::size_t patience = ~std::size_t{0}) : patience_(patience) {}
    bool requested() override { return asked_ >= patience_ || ++asked_ >= patience_; }
    void advance(std::size_t work) override { done_ += work; }

 private:
    std::size_t patience_, asked_ = 0;
    std::atomic<std::size_t> done_ = 0;
};

void demand(bool condition, const Cloud& cloud, const char* member, const char* what) {
    if (condition) return;
    std::fprintf(stderr, "FIND: %s, %s: %s\n", cloud.name.c_str(), member, what);
    std::exit(1);
}

bool same(const Regular& a, const Regular& b) {
    const std::size_t bytes = 3 * a.result.triangle_count * sizeof(std::int32_t);
    if (a.status != b.status || a.result.triangle_count != b.result.triangle_count) return false;
    const auto equal = [&](const auto& x, const auto& y) {
        return bytes == 0 || std::memcmp(x.get(), y.get(), bytes) == 0;
    };
    return a.hidden == b.hidden && a.skipped == b.skipped &&
           a.duplicates.size() == b.duplicates.size() &&
           equal(a.result.simplices, b.result.simplices) &&
           equal(a.result.neighbors, b.result.neighbors);
}

bool locate(const liftmesh::Question& question, Threads threads) {
    const liftmesh::Input points{reinterpret_cast<const std::byte*>(question.points), question.rows,
                                 sizeof(liftmesh::Point), sizeof(double), false};
    liftmesh::Locator locator({points, question.simplices, question.neighbors, question.count},
                              question.queried);
    Limited interrupt;
    return locator.find({reinterpret_cast<const double*>(question.queries), question.queried},
                        question.found, threads, interrupt);
}

void verified(const Cloud& cloud, const char* name, const Member& member, const Regular& found) {
    for (const unsigned limit : {1u, 4u}) {
        const Threads threads{limit, false};
        Limited interrupt;
        const auto ask = [&](const liftmesh::Question& question) {
            return locate(question, threads);
        };
        const liftmesh::Verdict verdict =
            liftmesh::verify(cloud.input(), found.result.simplices.get(),
                             found.result.triangle_count, true, member, ask, threads, interrupt);
        demand(verdict.status == Status::ok && !verdict.flaws.any(), cloud, name,
               "the verifier finds flaws");
        demand(member.kind != Member::Kind::farthest || verdict.hidden == found.hidden.size(),
               cloud, name, "the verifier finds other hidden rows");
    }
}

using Run = std::function<Regular(Threads, liftmesh::Interrupt&)>;

void check(const Cloud& cloud, const char* name, const Member& member, const Run& run) {
    const auto with = [&](unsigned threads, std::size_t patience) {
        Limited interrupt(patience);
        return run({threads, false}, interrupt);
    };
    const Regular alone = with(1, ~std::size_t{0});
    for (const unsigned threads : {2u, 5u})
        demand(same(with(threads, ~std::size_t{0}), alone), cloud, name,
               "threads change the result");
    for (const std::size_t patience : {1u, 3u, 9u, 30u}) {
        const Regular found = with(4, patience);
        demand(found.status == Status::interrupted || same(found, alone), cloud, name,
               "a run that could be interrupted comes to another result");
    }
    if (alone.status == Status::ok) verified(cloud, name, member, alone);
}

// Few distinct values, so that rows at one position weigh the same or not, some hidden.
std::vector<double> values(std::size_t count) {
    std::vector<double> found;
    std::mt19937_64 random(count);
    for (std::size_t i = 0; i < count; ++i)
        found.push_back(static_cast<double>(random() % 5) * 0x1p-18);
    return found;
}

}  // namespace

void check_family(const Cloud& cloud) {
    const liftmesh::Input input = cloud.input();
    const std::vector<double> weights = values(cloud.points.size());
    for (const bool are_radii : {false, true}) {
        const liftmesh::Values given{reinterpret_cast<const std::byte*>(weights.data()),
                                     sizeof(double), false, are_radii};
        const Member member{
            are_radii ? Member::Kind::radii : Member::Kind::weights, weights.data(), {1, 0, 1}};
        check(cloud, are_radii ? "radii" : "weights", member,
              [&](Threads threads, liftmesh::Interrupt& interrupt) {
                  return liftmesh::regular(input, given, true, threads, interrupt);
              });
    }
    check(cloud, "farthest", {Member::Kind::farthest, nullptr, {1, 0, 1}},
          [&](Threads threads, liftmesh::Interrupt& interrupt) {
              return liftmesh::farthest(input, true, threads, interrupt);
          });
    check(cloud, "metric", {Member::Kind::metric, nullptr, {2, 0.5, 1.25}},
          [&](Threads threads, liftmesh::Interrupt& interrupt) {
              return Regular{liftmesh::delaunay({2, 0.5, 1.25}, input, true, threads, interrupt),
                             {}};
          });
}

}  // namespace parallel
