// Doubles as integers on a common lattice 2^low.
//
// A finite double is mantissa * 2^exponent. Among the coordinates of one predicate call let `low`
// be the least exponent in use and `width` the bits from there to the top of the largest: then each
// coordinate is an integer of at most `width` bits, and each difference one of `width` + 1.
#pragma once

#include "base/point.hpp"
#include "predicates/wide.hpp"

namespace liftmesh {

struct Dyadic {
    std::int64_t mantissa;  // odd, or zero
    int exponent;
};

inline Dyadic dyadic(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    const int biased = static_cast<int>(bits >> 52) & 0x7ff;
    std::uint64_t mantissa = bits & ((std::uint64_t{1} << 52) - 1);
    if (biased != 0) mantissa |= std::uint64_t{1} << 52;
    if (mantissa == 0) return {0, 0};
    const int trailing = std::countr_zero(mantissa);
    const auto odd = static_cast<std::int64_t>(mantissa >> trailing);
    return {bits >> 63 ? -odd : odd, std::max(biased, 1) - 1075 + trailing};
}

inline int bit_length(std::int64_t value) {
    return 64 - std::countl_zero(static_cast<std::uint64_t>(value < 0 ? -value : value));
}

// K coordinates on their common lattice.
template <int K>
class Lattice {
 public:
    explicit Lattice(const std::array<double, K>& values) {
        int low = std::numeric_limits<int>::max();
        int high = std::numeric_limits<int>::min();
        for (int i = 0; i < K; ++i) {
            part_[i] = dyadic(values[i]);
            if (part_[i].mantissa == 0) continue;
            low = std::min(low, part_[i].exponent);
            high = std::max(high, part_[i].exponent + bit_length(part_[i].mantissa));
        }
        low_ = low;
        width_ = high > low ? high - low : 0;
    }

    // Whether differences fit Wide<N> with two bits to spare, as the polynomials require.
    template <int N>
    bool fits() const {
        return width_ + 1 <= 64 * N - 2;
    }

    // A coordinate is an integer of at most so many bits, in units of 2^low.
    int width() const { return width_; }
    int low() const { return low_; }

    // As a mantissa and a power of two, counted from 2^low.
    Dyadic part(int i) const {
        return {part_[i].mantissa, part_[i].mantissa == 0 ? 0 : part_[i].exponent - low_};
    }
    template <int N>
    Wide<N> at(int i) const {
        return shifted<N>(part(i).mantissa, part(i).exponent);
    }

 protected:
    // Makes the lattice as fine as 2^low, and as wide as 2^high.
    void include(int low, int high) {
        if (width_ != 0) {
            high = std::max(high, low_ + width_);
            low = std::min(low, low_);
        }
        low_ = low;
        width_ = high - low;
    }

 private:
    Dyadic part_[K];
    int low_, width_;
};

// Calls work.operator()<N>() with the least width that holds all polynomials of a lattice.
template <int K, class Work>
auto at_width_of(const Lattice<K>& lattice, Work work) {
    if (lattice.template fits<1>()) return work.template operator()<1>();
    if (lattice.template fits<2>()) return work.template operator()<2>();
    if (lattice.template fits<8>()) return work.template operator()<8>();
    return work.template operator()<33>();  // 2 098 bits: every finite double
}

// K points of the plane on the common lattice of their coordinates.
template <int K>
class PlanarLattice : public Lattice<2 * K> {
 public:
    explicit PlanarLattice(const Point (&points)[K]) : Lattice<2 * K>(flat(points)) {}

    Dyadic part_of_x(int i) const { return this->part(2 * i); }
    Dyadic part_of_y(int i) const { return this->part(2 * i + 1); }
    template <int N>
    Wide<N> x(int i) const {
        return this->template at<N>(2 * i);
    }
    template <int N>
    Wide<N> y(int i) const {
        return this->template at<N>(2 * i + 1);
    }

 private:
    static std::array<double, 2 * K> flat(const Point (&points)[K]) {
        std::array<double, 2 * K> values;
        for (int i = 0; i < K; ++i) {
            values[2 * i] = points[i].x;
            values[2 * i + 1] = points[i].y;
        }
        return values;
    }
};

}  // namespace liftmesh
