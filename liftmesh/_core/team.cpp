#include "team.hpp"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include "floating_point.hpp"

namespace liftmesh {

namespace {

std::atomic<unsigned> busy = 0;  // threads at work in all teams of the process

// The child of a fork has none of them.
[[maybe_unused]] const int forgotten = pthread_atfork(nullptr, nullptr, [] { busy = 0; });

unsigned claim(Threads threads) {
    unsigned taken = busy.load();
    for (;;) {
        const unsigned left = threads.limit > taken ? threads.limit - taken : 1;
        const unsigned size = std::max(1u, threads.shared ? left : threads.limit);
        if (busy.compare_exchange_weak(taken, taken + size)) return size;
    }
}

}  // namespace

Team::Team(Threads threads, Interrupt& interrupt) : heard_(interrupt), size_(claim(threads)) {}

Team::~Team() {
    {
        const std::lock_guard lock(mutex_);
        dismissed_ = true;
    }
    begin_.notify_all();
    for (std::thread& worker : workers_) worker.join();
    busy -= size_;
}

bool Team::Heard::requested() {
    if (!requested_ && std::this_thread::get_id() == caller_ && source_.requested())
        requested_ = true;
    return requested_;
}

// A system that has no thread left for us gets the same result from fewer.
void Team::hire() {
    try {
        while (workers_.size() + 1 < size_) workers_.emplace_back([this] { serve(); });
    } catch (const std::system_error&) {
        busy -= size_ - static_cast<unsigned>(workers_.size()) - 1;
        size_ = static_cast<unsigned>(workers_.size()) + 1;
    }
}

void Team::serve() {
    const IeeeArithmetic ieee;
    std::size_t round = 0;
    for (;;) {
        {
            std::unique_lock lock(mutex_);
            begin_.wait(lock, [&] { return dismissed_ || round_ != round; });
            if (dismissed_) return;
            round = round_;
        }
        take_tasks();
        const std::lock_guard lock(mutex_);
        if (--working_ == 0) end_.notify_one();
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
    if (tasks > 1 && size_ > 1 && workers_.empty()) hire();
    work_ = &work;
    tasks_ = tasks;
    next_ = 0;
    const bool alone = tasks < 2 || workers_.empty();
    if (!alone) {
        {
            const std::lock_guard lock(mutex_);
            working_ = workers_.size();
            ++round_;
        }
        begin_.notify_all();
    }
    take_tasks();
    if (!alone) wait();
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
    return !heard_.requested();
}

void Team::wait() {
    constexpr std::chrono::milliseconds now_and_then(20);
    std::unique_lock lock(mutex_);
    while (!end_.wait_for(lock, now_and_then, [&] { return working_ == 0; })) {
        lock.unlock();
        heard_.requested();
        lock.lock();
    }
}

}  // namespace liftmesh
