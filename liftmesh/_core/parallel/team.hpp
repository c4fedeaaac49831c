// Threads that work off a list of tasks together, the caller's thread among them.
//
// What a task computes never depends on who runs it or when, so neither does any result. Only the
// caller's thread asks whether the run is to end; the others see its answer.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "base/status.hpp"

namespace liftmesh {

// A thread for fewer would cost more than it saves.
inline constexpr std::size_t rows_per_thread = std::size_t{1} << 12;

// How many threads a run may take. Runs that share do not exceed the limit together: each takes
// what the others of the process leave, and its caller's thread at least.
struct Threads {
    unsigned limit = 1;
    bool shared = false;

    // No more than so many rows are worth.
    Threads for_rows(std::size_t rows) const {
        return {static_cast<unsigned>(std::clamp<std::size_t>(rows / rows_per_thread, 1, limit)),
                shared};
    }
};

class Team {
 public:
    Team(Threads threads, Interrupt& interrupt);
    ~Team();
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

    unsigned size() const { return size_; }
    Interrupt& interrupt() { return heard_; }

    // work(task) for every task below `tasks`. False where the interrupt ended it early. Rethrows
    // the first exception of a task.
    bool run(std::size_t tasks, const std::function<void(std::size_t)>& work);

 private:
    // Asked by any thread, passed on by the caller's alone.
    class Heard final : public Interrupt {
     public:
        explicit Heard(Interrupt& source) : source_(source) {}
        bool requested() override;
        void expect(std::size_t work) override { source_.expect(work); }
        void advance(std::size_t work) override { source_.advance(work); }

     private:
        Interrupt& source_;
        std::thread::id caller_ = std::this_thread::get_id();
        std::atomic<bool> requested_ = false;
    };

    struct Workers {
        std::vector<std::thread> threads;
        std::condition_variable begin, end;
    };

    bool forked() const;
    void hire();
    void serve();
    void take_tasks();
    void wait();

    Heard heard_;
    std::unique_ptr<Workers> workers_;
    unsigned size_;
    unsigned forks_;

    std::mutex mutex_;
    std::size_t round_ = 0;    // counts the lists; guarded by the mutex, as the next three
    std::size_t working_ = 0;  // workers not yet through with the list
    bool dismissed_ = false;
    std::exception_ptr error_;

    const std::function<void(std::size_t)>* work_ = nullptr;
    std::size_t tasks_ = 0;
    std::atomic<std::size_t> next_ = 0;
};

}  // namespace liftmesh
