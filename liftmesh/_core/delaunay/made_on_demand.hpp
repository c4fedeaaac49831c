// A part of an index that is built lazily, once the cost of not having it equals the cost of
// building it: both together are about twice the lesser of the two.
//
// One thread makes it, and others that need it meanwhile wait for that. No lock is held, which a
// fork could leave locked in the child for ever: the maker leaves a note, which counts in its own
// process only. Nor does a thread wait for itself: a signal's handler, which runs amid the making,
// may need the part, and makes one of its own.
#pragma once

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
        const Note here{forks_so_far() + 1, number_of_thread()};
        while (!is_made()) {
            Note maker = maker_;
            if (maker.process == here.process && maker.thread != here.thread) {
                if (ends_while_waiting(patience)) return nullptr;
            } else if (maker_.compare_exchange_strong(maker, here)) {
                const Turn turn{maker_, maker};
                if (is_made()) break;
                std::unique_ptr<const Part> made = make();
                if (patience.ends(0)) return nullptr;
                publish(std::move(made));
            }
        }
        return part_;
    }

 private:
    // Who makes it: 1 and the number of forks before the process, and the thread; 0 for nobody.
    struct alignas(8) Note {  // in one word
        std::uint32_t process = 0, thread = 0;
    };
    struct Turn {
        std::atomic<Note>& maker;
        Note before;  // the same thread's, where a handler interrupts it
        ~Turn() { maker = before; }
    };

    static std::uint32_t number_of_thread() {
        static std::atomic<std::uint32_t> threads = 0;
        thread_local const std::uint32_t number = ++threads;
        return number;
    }

    bool is_made() const { return part_.load() != nullptr; }

    // The first counts: others may be in use by then.
    void publish(std::unique_ptr<const Part> made) {
        const Part* none = nullptr;
        if (part_.compare_exchange_strong(none, made.get())) made.release();
    }

    static bool ends_while_waiting(Patience& patience) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return patience.ends(std::size_t{1} << 10);
    }

    std::atomic<const Part*> part_ = nullptr;
    std::atomic<Note> maker_;
    std::atomic<std::int64_t> credit_;
};

}  // namespace liftmesh
