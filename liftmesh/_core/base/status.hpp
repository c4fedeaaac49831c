// What a run of the kernel came to, and how a caller can stop it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace liftmesh {

enum class Status : std::uint8_t { ok, non_finite, too_few, collinear, interrupted };

// Asked now and then from long runs. Once the answer is true it stays so, and the run ends with
// Status::interrupted. Who wants to know how far a run has come is told as well, by any thread.
class Interrupt {
 public:
    virtual ~Interrupt() = default;
    virtual bool requested() = 0;
    virtual void expect(std::size_t /*work, in all*/) {}
    virtual void advance(std::size_t /*work, since the last call*/) {}
};

// What the stages of a run take for each point, about, in the unit of `Interrupt::advance`.
namespace work {
inline constexpr std::size_t arranging = 4, triangulating = 15, emitting = 1;
}

// Asks once in a while, for loops whose steps are quick and whose number is not known.
class Patience {
 public:
    explicit Patience(Interrupt& interrupt) : interrupt_(interrupt) {}

    // Counts steps; true where the run is to end.
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
