// A part of an index that is made once doing without it has cost as much as making it would: so
// both together cost at most twice what the better of the two would have cost.
//
// One thread makes it, and others that need it meanwhile wait for that. No lock is held, which a
// fork could leave locked in the child for ever: the maker leaves a note that counts in its own
// process only.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>

#include "base/status.hpp"
#include "parallel/thread_pool.hpp"

namespace liftmesh {

template <class Part>
class MadeOnDemand {
 public:
    explicit MadeOnDemand(std::size_t price) : credit_(static_cast<std::int64_t>(price)) {}
    MadeOnDemand(const MadeOnDemand&) = delete;
    MadeOnDemand& operator=(const MadeOnDemand&) = delete;
    ~MadeOnDemand() { delete part_.load(); }

    // How many steps may still be taken without it; none if there are none, or if it is made.
    std::size_t credit() const {
        const std::int64_t left = is_made() ? 0 : credit_.load(std::memory_order_relaxed);
        return left > 0 ? static_cast<std::size_t>(left) : 0;
    }
    void pay(std::size_t steps) {
        credit_.fetch_sub(static_cast<std::int64_t>(steps), std::memory_order_relaxed);
    }

    // What make() returns, as a unique_ptr, if it is not made yet. Null if the interrupt came
    // first.
    template <class Make>
    const Part* get(const Make& make, Patience& patience) {
        const unsigned here = forks_so_far() + 1;
        while (!is_made()) {
            unsigned maker = maker_;
            if (maker == here) {
                if (ends_while_waiting(patience)) return nullptr;
            } else if (maker_.compare_exchange_strong(maker, here)) {
                const Turn turn{maker_};
                if (is_made()) break;
                std::unique_ptr<const Part> made = make();
                if (patience.ends(0)) return nullptr;
                part_ = made.release();
            }
        }
        return part_;
    }

 private:
    struct Turn {
        std::atomic<unsigned>& maker;
        ~Turn() { maker = 0; }
    };

    bool is_made() const { return part_.load() != nullptr; }

    static bool ends_while_waiting(Patience& patience) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return patience.ends(std::size_t{1} << 10);
    }

    std::atomic<const Part*> part_ = nullptr;
    std::atomic<unsigned> maker_ = 0;  // 1 and the forks before the process of the thread; 0: none
    std::atomic<std::int64_t> credit_;
};

}  // namespace liftmesh
