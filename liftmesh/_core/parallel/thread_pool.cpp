#include "parallel/thread_pool.hpp"

#include "base/floating_point.hpp"
#include "base/platform.hpp"

namespace liftmesh {

namespace {

std::atomic<unsigned> busy = 0;  // threads of all pools of the process
std::atomic<unsigned> forks = 0;

// Of its parent's threads the child of a fork has only the one that forked.
// GCOV_EXCL_START: the child of a fork ends without writing its counts
[[maybe_unused]] const bool fork_handler = platform::call_in_forks([] {
    busy = 0;
    ++forks;
});
// GCOV_EXCL_STOP

unsigned claim(Threads threads) {
    unsigned taken = busy.load();
    for (;;) {
        const unsigned left = threads.limit > taken ? threads.limit - taken : 1;
        const unsigned size = std::max(1u, threads.shared ? left : threads.limit);
        if (busy.compare_exchange_weak(taken, taken + size)) return size;
    }
}

}  // namespace

unsigned forks_so_far() {
    return forks;
}

ThreadPool::ThreadPool(Threads threads, Interrupt& interrupt)
    : interrupt_(interrupt), size_(claim(threads)), forks_(forks) {
    if (size_ > 1) workers_ = std::make_unique<Workers>();
}

// In a child that was forked during the run no worker is left to join, and destroying a condition
// variable would wait for threads that waited on it at the time of the fork: the workers are
// leaked.
ThreadPool::~ThreadPool() {
    if (forked()) {
        // GCOV_EXCL_START: the child of a fork ends without writing its counts
        static_cast<void>(workers_.release());
        return;
        // GCOV_EXCL_STOP
    }
    if (has_workers()) stop_workers();
    busy -= size_;
}

void ThreadPool::stop_workers() {
    next_ = tasks_;
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    workers_->begin.notify_all();
    for (std::thread& worker : workers_->threads) worker.join();
}

bool ThreadPool::has_workers() const {
    return workers_ != nullptr && !workers_->threads.empty();
}

bool ThreadPool::forked() const {
    return forks != forks_;
}

bool ThreadPool::RelayedInterrupt::requested() {
    if (!requested_ && std::this_thread::get_id() == caller_ && source_.requested())
        requested_ = true;
    return requested_;
}

// Where the system grants no further thread, fewer give the same result.
void ThreadPool::start_workers() {
    std::vector<std::thread>& started = workers_->threads;
    try {
        while (started.size() + 1 < size_) started.emplace_back([this] { run_worker(); });
    } catch (const std::system_error&) {
        busy -= size_ - static_cast<unsigned>(started.size()) - 1;
        size_ = static_cast<unsigned>(started.size()) + 1;
    }
}

void ThreadPool::run_worker() {
    const IeeeArithmetic ieee;
    std::size_t round = 0;
    for (;;) {
        {
            std::unique_lock lock(mutex_);
            workers_->begin.wait(lock, [&] { return stopping_ || round_ != round; });
            if (stopping_) return;
            round = round_;
        }
        run_tasks();
        const std::lock_guard lock(mutex_);
        if (--working_ == 0) workers_->end.notify_one();
    }
}

void ThreadPool::run_tasks() {
    try {
        for (std::size_t task; (task = next_.fetch_add(1)) < tasks_;) {
            if (interrupt_.requested()) return;
            work_(task);
        }
        // GCOV_EXCL_START: no memory, not even for counts
    } catch (...) {
        next_ = tasks_;
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::current_exception();
        // GCOV_EXCL_STOP
    }
}

bool ThreadPool::run(std::size_t tasks, std::function<void(std::size_t)> work) {
    if (size_ == 1) return run_alone(tasks, work);
    begin(tasks, std::move(work));
    return finish();
}

// What `begin` and `finish` would do, for calls on few points.
bool ThreadPool::run_alone(std::size_t tasks, const std::function<void(std::size_t)>& work) {
    for (std::size_t task = 0; task < tasks && !forked(); ++task) {
        if (interrupt_.requested()) return false;
        work(task);
    }
    return !forked() && !interrupt_.requested();
}

void ThreadPool::begin(std::size_t tasks, std::function<void(std::size_t)> work) {
    if (forked()) return;
    if (tasks > 1 && size_ > 1 && !has_workers()) start_workers();
    work_ = std::move(work);
    tasks_ = tasks;
    next_ = 0;
    alone_ = tasks < 2 || !has_workers();
    if (alone_) return;
    {
        const std::lock_guard lock(mutex_);
        working_ = workers_->threads.size();
        ++round_;
    }
    workers_->begin.notify_all();
}

bool ThreadPool::finish() {
    if (forked()) return false;
    run_tasks();
    if (!alone_ && !forked()) wait();
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
    return !interrupt_.requested();
}

void ThreadPool::wait() {
    constexpr std::chrono::milliseconds poll_interval(20);
    std::unique_lock lock(mutex_);
    while (!workers_->end.wait_for(lock, poll_interval, [&] { return working_ == 0; })) {
        lock.unlock();
        interrupt_.requested();
        if (forked()) return;
        lock.lock();
    }
}

}  // namespace liftmesh
