// The fuzzer's bytes, taken one after the other; zeros beyond their end.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace fuzzing {

class Bytes {
 public:
    Bytes(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}

    bool left() const { return at_ != end_; }
    std::size_t size() const { return static_cast<std::size_t>(end_ - at_); }
    std::uint8_t byte() { return left() ? *at_++ : std::uint8_t{0}; }
    std::int8_t small() { return static_cast<std::int8_t>(byte()); }
    std::uint16_t word() {
        const unsigned low = byte(), high = byte();
        return static_cast<std::uint16_t>(low | high << 8);
    }
    std::int16_t number() { return static_cast<std::int16_t>(word()); }
    double real() {
        std::uint64_t bits = 0;
        for (int i = 0; i < 64; i += 8) bits |= std::uint64_t{byte()} << i;
        return std::bit_cast<double>(bits);
    }

 private:
    const std::uint8_t *at_, *end_;
};

// Numbers without an order that one would see, the same every time.
class Dice {
 public:
    explicit Dice(std::uint64_t seed) : state_(seed) {}

    std::size_t below(std::size_t limit) {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<std::size_t>(state_ >> 33) % limit;
    }

 private:
    std::uint64_t state_;
};

}  // namespace fuzzing
