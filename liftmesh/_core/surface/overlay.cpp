#include "surface/overlay.hpp"

#include "base/floating_point.hpp"
#include "predicates/orient2d.hpp"
#include "predicates/wide.hpp"
#include "surface/common_part.hpp"
#include "surface/flood.hpp"

namespace liftmesh {

namespace {

// A sum of numbers that are not negative, exact and rounded once: in no order of them does it have
// other bits.

class Total {
 public:
    void add(double value) {
        if (!(value >= 0) || std::isinf(value)) {
            is_finite_ = false;
            return;
        }
        const auto bits = std::bit_cast<std::uint64_t>(value);
        const std::uint64_t biased = (bits >> 52) & 0x7ff, fraction = bits & (hidden - 1);
        const std::uint64_t place = biased == 0 ? 0 : biased - 1;  // 2^-1074 is in place 0
        const Uint128 shifted = static_cast<Uint128>(biased == 0 ? fraction : fraction | hidden)
                                << place % 32;
        std::uint64_t* digit = &digits_[place / 32];
        digit[0] += static_cast<std::uint32_t>(shifted);
        digit[1] += static_cast<std::uint32_t>(shifted >> 32);
        digit[2] += static_cast<std::uint32_t>(shifted >> 64);
        if (++additions_ == most_additions) carry();
    }

    // The sum times 2^exponent; NaN if a number was none, or infinite.
    double value(int exponent = 0) const {
        if (!is_finite_) return std::numeric_limits<double>::quiet_NaN();
        Total carried = *this;
        carried.carry();
        return carried.rounded(exponent);
    }

 private:
    static constexpr std::uint64_t hidden = std::uint64_t{1} << 52;
    static constexpr std::uint32_t most_additions = std::uint32_t{1} << 31;
    static constexpr int least_exponent = -1074;

    void carry() {
        std::uint64_t carried = 0;
        for (std::uint64_t& digit : digits_) {
            digit += carried;
            carried = digit >> 32;
            digit &= 0xffffffff;
        }
        additions_ = 0;
    }

    // Four digits are enough, the last of which says whether there are others.
    double rounded(int exponent) const {
        std::size_t top = digits_.size() - 1;
        while (top > 3 && digits_[top] == 0) --top;
        Uint128 lead = 0;
        for (std::size_t i = 0; i < 4; ++i) lead = lead << 32 | digits_[top - i];
        for (std::size_t i = 0; i + 3 < top; ++i) lead |= digits_[i] != 0;
        return std::ldexp(liftmesh::rounded(lead),
                          32 * static_cast<int>(top - 3) + least_exponent + exponent);
    }

    std::array<std::uint64_t, 68> digits_{};  // of 32 bits, and what they are to carry
    std::uint32_t additions_ = 0;
    bool is_finite_ = true;
};

// The power of two that brings numbers near to 1 whose products may leave the doubles.
class Unit {
 public:
    Unit(double greatest, int far) {
        if (!(greatest > 0) || std::abs(std::ilogb(greatest)) <= far) return;
        exponent_ = std::ilogb(greatest);
        first_ = std::ldexp(1.0, -(exponent_ / 2));
        second_ = std::ldexp(1.0, exponent_ / 2 - exponent_);
    }
    int exponent() const { return exponent_; }
    double operator()(double value) const { return value * first_ * second_; }
    Point operator()(Point p) const { return {(*this)(p.x), (*this)(p.y)}; }

 private:
    int exponent_ = 0;
    double first_ = 1, second_ = 1;
};

// The greatest magnitudes of two surfaces.
struct Greatest {
    double place = 0, height = 0;

    void add(const Relief& relief) {
        const Input& points = relief.mesh().points;
        for (std::size_t row = 0; row < points.rows; ++row) {
            const Point p = points[row];
            add(place, p.x);
            add(place, p.y);
            add(height, relief.height_of(static_cast<std::int32_t>(row)));
        }
    }

 private:
    static void add(double& greatest, double value) {
        const double size = std::fabs(value);
        if (size > greatest && std::isfinite(size)) greatest = size;
    }
};

bool is_outside(Point tail, Point head, Point p) {
    return orient2d(tail, head, p) < 0;
}

// Whether a segment and a closed triangle touch: no side of either has all of the other beyond it.
bool touches(const Triangle& t, Point p, Point q) {
    for (std::size_t k = 0; k < 3; ++k)
        if (is_outside(t[k], t[after(k)], p) && is_outside(t[k], t[after(k)], q)) return false;
    const int turns[] = {orient2d(p, q, t[0]), orient2d(p, q, t[1]), orient2d(p, q, t[2])};
    return !(turns[0] > 0 && turns[1] > 0 && turns[2] > 0) &&
           !(turns[0] < 0 && turns[1] < 0 && turns[2] < 0);
}

// With `Real` for lengths.
template <class Real>
class Overlay {
 public:
    Overlay(const Relief& first, const Relief& second, Patience& patience)
        : reliefs_{&first, &second},
          patience_(patience),
          start_(first.mesh().count, Flood<Overlay>::unvisited),
          flood_(*this, start_, second.mesh().count, patience) {
        Greatest greatest;
        greatest.add(first);
        greatest.add(second);
        place_ = Unit(greatest.place, 400);
        height_ = Unit(greatest.height, 100);
    }

    void run(std::int32_t face, std::int32_t other) { flood_.run(face, other); }

    // The same in triangles, in each of which both faces have a point. All faces of the second are
    // reached that touch a face of the first, in the triangle or not: so the first should be the
    // finer one.
    void run(const Parts& parts) {
        for (std::size_t i = 0; i < parts.count && !patience_.ends(); ++i) {
            const double* at = parts.corners + 6 * i;
            const Triangle part = {place_(Point{at[0], at[1]}), place_(Point{at[2], at[3]}),
                                   place_(Point{at[4], at[5]})};
            part_ = &part;
            run(parts.faces[i], parts.others[i]);
            flood_.forget();
        }
    }

    // What overlaps has an area, if only the least double.
    Between found() const {
        const int area = 2 * place_.exponent(), volume = area + height_.exponent();
        constexpr double least = std::numeric_limits<double>::denorm_min();
        const double found = area_.value(area);
        return {above_.value(volume), below_.value(volume),
                overlaps_ && found < least ? least : found};
    }

    // Whether rounded lengths and heights are enough for a 2^40th of the area and the largest rise.
    bool is_sure() const {
        constexpr double most_rounding = 0x1p7;
        const double area = area_.value();
        return rounding_.value() <= most_rounding * area &&
               steepness_.value() <= most_rounding * area * rise_;
    }

    // For the flood.

    Face face(std::size_t mesh, std::int32_t simplex) const {
        Face face = liftmesh::face_of(*reliefs_[mesh], simplex);
        for (SurfaceCorner& corner : face.corners)
            corner = {place_(corner.at), height_(corner.height)};
        face.extent = place_(face.extent);
        return face;
    }

    std::int32_t neighbor(std::size_t mesh, std::int32_t number, const Face& face,
                          std::size_t side) const {
        return reliefs_[mesh]->mesh().neighbor(number, static_cast<int>(face.of_mesh(side)));
    }

    static constexpr Nearness nearness() { return {}; }
    bool is_whole() const { return !part_; }
    bool goes_on(Point tail, Point head) const { return !part_ || touches(*part_, tail, head); }

    void visit(std::int32_t number, std::int32_t other, const FacePair& pair) {
        if (!reliefs_[0]->is_shown(number) || !reliefs_[1]->is_shown(other)) return;
        if (!pair.overlap()) return;
        const Volumes part = CommonPart<Real>(pair).measure(part_);
        overlaps_ = overlaps_ || !part_ || part.area > 0;
        area_.add(part.area);
        above_.add(part.above);
        below_.add(part.below);
        rounding_.add(part.rounding);
        steepness_.add(part.area * part.steepness);
        rise_ = std::max(rise_, part.rise);
    }

 private:
    std::array<const Relief*, 2> reliefs_;
    Patience& patience_;
    std::vector<std::int32_t> start_;
    Flood<Overlay> flood_;
    Unit place_{1, 0}, height_{1, 0};
    const Triangle* part_ = nullptr;
    Total above_, below_, area_, rounding_, steepness_;
    double rise_ = 0;
    bool overlaps_ = false;
};

// False if the interrupt came first.
template <class Real, class... Where>
bool measured(const Relief& first, const Relief& second, Between& found, Interrupt& interrupt,
              const Where&... where) {
    Patience patience(interrupt);
    Overlay<Real> overlay(first, second, patience);
    overlay.run(where...);
    if (patience.ends(0)) return false;
    if constexpr (std::is_same_v<Real, double>)
        if (!overlay.is_sure()) return measured<Long>(first, second, found, interrupt, where...);
    found = overlay.found();
    return true;
}

}  // namespace

bool between(const Relief& first, const Relief& second, std::int32_t face, std::int32_t other,
             Between& found, Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    return measured<double>(first, second, found, interrupt, face, other);
}

bool between_within(const Relief& first, const Relief& second, const Parts& parts, Between& found,
                    Interrupt& interrupt) {
    const IeeeArithmetic ieee;
    return measured<double>(first, second, found, interrupt, parts);
}

}  // namespace liftmesh
