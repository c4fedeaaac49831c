// A pool of threads that runs a list of tasks; the caller's thread is one of them.
//
// What a task computes never depends on which thread runs it, or when, so no result does. Only the
// caller's thread polls the interrupt; the others read its answer.
#pragma once

#include "base/status.hpp"

namespace liftmesh {

// With fewer rows a further thread costs more than it saves.
inline constexpr std::size_t rows_per_thread = std::size_t{1} << 12;

// How many threads a run may take. Runs with `shared` set stay within the limit together: each
// takes what the others of the process leave, and its caller's thread at least.
struct Threads {
    unsigned limit = 1;
    bool shared = false;

    // At most as many as that many rows can occupy.
    Threads for_rows(std::size_t rows) const {
        return {static_cast<unsigned>(std::clamp<std::size_t>(rows / rows_per_thread, 1, limit)),
                shared};
    }
};

// How many forks lie between the first process and this one.
unsigned forks_so_far();

class ThreadPool {
 public:
    ThreadPool(Threads threads, Interrupt& interrupt);
    ~ThreadPool();
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    unsigned size() const { return size_; }
    Interrupt& interrupt() { return interrupt_; }

    // Calls work(task) for every task below `tasks`. False if the interrupt ended it early.
    // Rethrows the first exception of a task.
    bool run(std::size_t tasks, std::function<void(std::size_t)> work);

    // `run` in two halves: after the first the other threads work, and the caller's is free; with
    // the second it joins them, and waits for the end.
    void begin(std::size_t tasks, std::function<void(std::size_t)> work);
    bool finish();

 private:
    // Any thread may ask; only the caller's thread passes the question on.
    class RelayedInterrupt final : public Interrupt {
     public:
        explicit RelayedInterrupt(Interrupt& source) : source_(source) {}
        bool requested() override;
        // GCOV_EXCL_START: a run calls it before it has a pool
        void expect(std::size_t work) override { source_.expect(work); }
        // GCOV_EXCL_STOP
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

    bool has_workers() const;
    bool forked() const;
    bool run_alone(std::size_t tasks, const std::function<void(std::size_t)>& work);
    void start_workers();
    void stop_workers();
    void run_worker();
    void run_tasks();
    void wait();

    RelayedInterrupt interrupt_;
    std::unique_ptr<Workers> workers_;  // none in a pool of one thread
    unsigned size_;
    unsigned forks_;

    std::mutex mutex_;
    std::size_t round_ = 0;    // number of the current list; the mutex guards it and the next three
    std::size_t working_ = 0;  // workers that have not finished the list
    bool stopping_ = false;
    std::exception_ptr error_;

    std::function<void(std::size_t)> work_;
    std::size_t tasks_ = 0;
    bool alone_ = true;  // none but the caller's thread works on the list
    std::atomic<std::size_t> next_ = 0;
};

}  // namespace liftmesh
