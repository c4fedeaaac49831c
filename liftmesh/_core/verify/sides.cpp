#include "verify/sides.hpp"

#include "predicates/lift.hpp"
#include "predicates/lifted_side.hpp"
#include "predicates/seen_from_base.hpp"

namespace liftmesh {

namespace {

template <class Lift>
constexpr bool has_values = std::is_same_v<typename Lift::Value, double>;

template <class Lift>
class SidesBy final : public Sides {
 public:
    SidesBy(const Lift& lift, const Point* points, const double* values, Guard guard)
        : lift_(lift), points_(points), values_(values), guard_(guard) {}

    int side(Row a, Row b, Row c, Row d) const override {
        const auto [value, error] = filter(a, b, c, d);
        if (std::fabs(value) > error + guard_.margin()) return value > 0 ? 1 : -1;
        if constexpr (std::is_same_v<Lift, Farthest>)
            return -incircle_exact(points_[a], points_[b], points_[c], points_[d], guard_);
        else
            return lifted_side_exact(lift_, site(a), site(b), site(c), site(d), guard_);
    }

 private:
    struct Filter {
        double value, error;
    };

    Filter filter(Row a, Row b, Row c, Row d) const {
        if constexpr (has_values<Lift>) {
            const LiftedBase<Lift> base(at(a), values_[a], at(b), values_[b]);
            return {base.below(base.place(at(c), values_[c]), base.place(at(d), values_[d])),
                    base.error_of_below(at(c), values_[c], at(d), values_[d])};
        } else {
            const Base<Lift> base(lift_, at(a), at(b));
            return {below(base.place(at(c)), base.place(at(d))),
                    error_of_below<Lift>(base.bound(at(c)), base.bound(at(d)))};
        }
    }

    Pair at(Row row) const { return pair(points_[row]); }
    Lifted<Lift> site(Row row) const {
        if constexpr (has_values<Lift>)
            return {points_[row], values_[row]};
        else
            return {points_[row], {}};
    }

    Lift lift_;
    const Point* points_;
    const double* values_;
    Guard guard_;
};

}  // namespace

Range range_of_values(const Member& member, const Range& values) {
    return member.kind == Member::Kind::weights ? as_coordinates(ByWeight{}, values)
                                                : as_coordinates(ByRadius{}, values);
}

double scaled_value(const Member& member, double value, const Scale& scale) {
    return member.kind == Member::Kind::weights ? scaled(ByWeight{}, value, scale)
                                                : scaled(ByRadius{}, value, scale);
}

std::unique_ptr<Sides> make_sides(const Member& member, const Point* points, const double* values,
                                  Guard guard) {
    switch (member.kind) {
        case Member::Kind::delaunay:
        case Member::Kind::constrained:
            return nullptr;
        case Member::Kind::weights:
            return std::make_unique<SidesBy<ByWeight>>(ByWeight{}, points, values, guard);
        case Member::Kind::radii:
            return std::make_unique<SidesBy<ByRadius>>(ByRadius{}, points, values, guard);
        case Member::Kind::farthest:
            return std::make_unique<SidesBy<Farthest>>(Farthest{}, points, values, guard);
        case Member::Kind::metric: {
            ByMetric by = member.metric;
            const Guard fitted = fit(by, guard);
            return std::make_unique<SidesBy<ByMetric>>(by, points, values, fitted);
        }
    }
    return nullptr;
}

}  // namespace liftmesh
