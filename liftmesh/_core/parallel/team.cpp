#include "parallel/team.hpp"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include "base/floating_point.hpp"

namespace liftmesh {

namespace {

std::atomic<unsigned> busy = 0;   // threads at work in all teams of the process
std::atomic<unsigned> forks = 0;  // that lead from the first process to this one

// The child of a fork has none of the threads but the one that forked.
[[maybe_unused]] const int forgotten = pthread_atfork(nullptr, nullptr, [] {
    busy = 0;
    ++forks;
});

unsigned claim(Threads threads) {
    unsigned taken = busy.load();
    for (;;) {
        const unsigned left = threads.limit > taken ? threads.limit - taken : 1;
        const unsigned size = std::max(1u, threads.shared ? left : threads.limit);
        if (busy.compare_exchange_weak(taken, taken + size)) return size;
    }
}

}  // namespace

Team::Team(Threads threads, Interrupt& interrupt)
    : heard_(interrupt),
      workers_(std::make_unique<Workers>()),
      size_(claim(threads)),
      forks_(forks) {}

// In a child that was forked amid the run nobody is left to be joined, and who waited at the time
// of the fork would be waited for: the workers are forgotten as they are.
Team::~Team() {
    if (forked()) {
        static_cast<void>(workers_.release());
        return;
    }
    {
        const std::lock_guard lock(mutex_);
        dismissed_ = true;
    }
    workers_->begin.notify_all();
    for (std::thread& worker : workers_->threads) worker.join();
    busy -= size_;
}

bool Team::forked() const {
    return forks != forks_;
}

bool Team::Heard::requested() {
    if (!requested_ && std::this_thread::get_id() == caller_ && source_.requested())
        requested_ = true;
    return requested_;
}

// A system that has no thread left for us gets the same result from fewer.
void Team::hire() {
    std::vector<std::thread>& hired = workers_->threads;
    try {
        while (hired.size() + 1 < size_) hired.emplace_back([this] { serve(); });
    } catch (const std::system_error&) {
        busy -= size_ - static_cast<unsigned>(hired.size()) - 1;
        size_ = static_cast<unsigned>(hired.size()) + 1;
    }
}

void Team::serve() {
    const IeeeArithmetic ieee;
    std::size_t round = 0;
    for (;;) {
        {
            std::unique_lock lock(mutex_);
            workers_->begin.wait(lock, [&] { return dismissed_ || round_ != round; });
            if (dismissed_) return;
            round = round_;
        }
        take_tasks();
        const std::lock_guard lock(mutex_);
        if (--working_ == 0) workers_->end.notify_one();
    }
}

void Team::take_tasks() {
    try {
        for (std::size_t task; (task = next_.fetch_add(1)) < tasks_;) {
            if (heard_.requested()) return;
            (*work_)(task);
        }
    } catch (...) {
        next_ = tasks_;
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::current_exception();
    }
}

bool Team::run(std::size_t tasks, const std::function<void(std::size_t)>& work) {
    if (forked()) return false;
    if (tasks > 1 && size_ > 1 && workers_->threads.empty()) hire();
    work_ = &work;
    tasks_ = tasks;
    next_ = 0;
    const bool alone = tasks < 2 || workers_->threads.empty();
    if (!alone) {
        {
            const std::lock_guard lock(mutex_);
            working_ = workers_->threads.size();
            ++round_;
        }
        workers_->begin.notify_all();
    }
    take_tasks();
    if (!alone && !forked()) wait();
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
    return !heard_.requested();
}

void Team::wait() {
    constexpr std::chrono::milliseconds now_and_then(20);
    std::unique_lock lock(mutex_);
    while (!workers_->end.wait_for(lock, now_and_then, [&] { return working_ == 0; })) {
        lock.unlock();
        heard_.requested();
        if (forked()) return;
        lock.lock();
    }
}

}  // namespace liftmesh
