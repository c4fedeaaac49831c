// The outcome of a run of the kernel, and how a caller can stop it.
#pragma once

#include "base/standard.hpp"

namespace liftmesh {

enum class Status : std::uint8_t { ok, non_finite, too_few, collinear, coplanar, interrupted };

// Polled by long runs. Once `requested` returns true it must do so from then on, and the run ends
// with Status::interrupted. `expect` and `advance` report progress, from any thread.
class Interrupt {
 public:
    virtual ~Interrupt() = default;
    virtual bool requested() = 0;
    virtual void expect(std::size_t /*work, in all*/) {}
    virtual void advance(std::size_t /*work, since the last call*/) {}
};

// For a part of a run, the progress of which is told otherwise.
class QuietInterrupt : public Interrupt {
 public:
    explicit QuietInterrupt(Interrupt& whole) : whole_(whole) {}
    bool requested() override { return whole_.requested(); }

 protected:
    Interrupt& whole_;
};

// For a part of a run, which has been told what to expect of the whole.
class PartInterrupt final : public QuietInterrupt {
 public:
    using QuietInterrupt::QuietInterrupt;
    void advance(std::size_t work) override { whole_.advance(work); }
};

class NoInterrupt final : public Interrupt {
 public:
    bool requested() override { return false; }
};

// The approximate work of each stage for one point, in units of `Interrupt::advance`.
namespace work {
inline constexpr std::size_t sorting = 4, triangulating = 15, compacting = 1;
}

// Polls an interrupt at intervals, for loops of short steps whose number is unknown.
class Patience {
 public:
    explicit Patience(Interrupt& interrupt) : interrupt_(interrupt) {}

    // Counts steps; true if the run should end.
    bool ends(std::size_t steps = 1) {
        constexpr std::size_t asking_every = std::size_t{1} << 14;
        steps_ += steps;
        if (steps_ >= asking_every) {
            steps_ = 0;
            ended_ = interrupt_.requested();
        }
        return ended_;
    }

 private:
    Interrupt& interrupt_;
    std::size_t steps_ = 0;
    bool ended_ = false;
};

}  // namespace liftmesh
