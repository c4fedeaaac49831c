// A thread pool that works through its tasks alone, and has callgrind write down what each of them
// took: it stands in for the kernel's where stages are counted. It tells the kernel that it has the
// threads asked for, so work is divided as it is among so many, and results are the same.
//
// Callgrind writes a file at each request, and begins to count anew: before a list of tasks, what
// the caller did alone since the last one; then a file for each task. Its own work is not counted.

#include "parallel/thread_pool.hpp"

#include <cxxabi.h>
#include <valgrind/callgrind.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

namespace liftmesh {

namespace {

void write_down(const std::string& what) {
    CALLGRIND_TOGGLE_COLLECT;
    CALLGRIND_DUMP_STATS_AT(what.c_str());
    CALLGRIND_TOGGLE_COLLECT;
}

// The mangled name where there is no other, as of a lambda in a template.
std::string name_of(const std::function<void(std::size_t)>& work) {
    int status = 0;
    const char* mangled = work.target_type().name();
    char* name = abi::__cxa_demangle(mangled, nullptr, nullptr, &status);
    std::string result = status == 0 ? name : mangled;
    std::free(name);
    return result;
}

}  // namespace

// A counted run is never forked.
unsigned forks_so_far() {
    return 0;
}

ThreadPool::ThreadPool(Threads threads, Interrupt& interrupt)
    : interrupt_(interrupt), size_(threads.limit), forks_(0) {}

ThreadPool::~ThreadPool() = default;

bool ThreadPool::RelayedInterrupt::requested() {
    return false;
}

bool ThreadPool::run(std::size_t tasks, std::function<void(std::size_t)> work) {
    begin(tasks, std::move(work));
    return finish();
}

void ThreadPool::begin(std::size_t tasks, std::function<void(std::size_t)> work) {
    write_down("alone");
    work_ = std::move(work);
    tasks_ = tasks;
}

bool ThreadPool::finish() {
    ++round_;
    CALLGRIND_TOGGLE_COLLECT;
    const std::string name = std::to_string(round_) + " " + name_of(work_);
    CALLGRIND_TOGGLE_COLLECT;
    for (std::size_t task = 0; task < tasks_; ++task) {
        work_(task);
        write_down(name);
    }
    return true;
}

}  // namespace liftmesh
