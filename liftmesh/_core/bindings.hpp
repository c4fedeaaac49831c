// What all parts of the Python interface use: signals and progress, and arrays that own a buffer.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <new>
#include <utility>
#include <vector>

#include "base/buffer.hpp"
#include "base/status.hpp"

namespace bindings {

namespace nb = nanobind;

// Checks for pending signals and reports progress, about twenty times a second. Python delivers
// signals to its main thread only; on any other thread only an exception from `progress` ends a
// run.
class PythonInterrupt final : public liftmesh::Interrupt {
 public:
    explicit PythonInterrupt(nb::handle progress = nb::none()) : progress_(progress) {}

    bool requested() override {
        const Clock::time_point now = Clock::now();
        if (requested_ || now < due_) return requested_;
        due_ = now + std::chrono::milliseconds(50);
        const nb::gil_scoped_acquire gil;
        requested_ = PyErr_CheckSignals() != 0 || !report_progress() || forked();
        return requested_;
    }
    void expect(std::size_t work) override { expected_ = work; }
    void advance(std::size_t work) override { done_ += work; }

 private:
    using Clock = std::chrono::steady_clock;

    bool report_progress() const {
        if (progress_.is_none() || done_ >= expected_) return true;
        try {
            progress_(static_cast<double>(done_) / static_cast<double>(expected_));
            return true;
        } catch (nb::python_error& error) {
            error.restore();
        } catch (const std::bad_alloc&) {
            PyErr_NoMemory();  // GCOV_EXCL_LINE: between a callback and its number
        }
        return false;
    }

    // The child of a fork made by a signal handler, or by `progress`, cannot continue: it has none
    // of the run's threads.
    bool forked() const {
        if (getpid() == process_) return false;
        // GCOV_EXCL_START: the child of a fork ends without writing its counts
        PyErr_SetString(PyExc_RuntimeError,
                        "the process was forked during a run, which continues in the parent only: "
                        "fork before or after it");
        return true;
        // GCOV_EXCL_STOP
    }

    nb::handle progress_;
    pid_t process_ = getpid();
    Clock::time_point due_ = Clock::now() + std::chrono::milliseconds(50);
    bool requested_ = false;
    std::size_t expected_ = 0;
    std::atomic<std::size_t> done_ = 0;
};

template <class T>
nb::object adopt(liftmesh::Buffer<T> values, std::size_t rows, std::size_t columns) {
    const nb::capsule owner(values.get(), [](void* p) noexcept { liftmesh::Free()(p); });
    T* data = values.release();
    const std::size_t shape[2] = {rows, columns};
    return nb::cast(nb::ndarray<nb::numpy, const T>(data, columns == 1 ? 1 : 2, shape, owner));
}

// The functions that parse and print numbers in text.
void bind_text(nb::module_& m);

}  // namespace bindings
