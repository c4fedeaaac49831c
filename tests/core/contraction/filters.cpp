// What the kernel's filters say of questions on the standard input. A question is eight doubles,
// the points a, b, c, d; an answer nine, in the order of `answer`.

#include <array>
#include <cstdio>

#include "predicates/incircle.hpp"
#include "predicates/orient2d.hpp"
#include "predicates/seen_from_base.hpp"

namespace {

using namespace liftmesh;

using Question = std::array<Point, 4>;
using Answer = std::array<double, 9>;

// Three filters, each a value and its error; then the signs that come out in the end.
Answer answer(const Question& question) {
    const auto& [a, b, c, d] = question;
    const Guard guard = Guard::in_window();
    const InCircleFilter circle = incircle_filter(a, b, c, d);
    const Base base(Paraboloid{}, pair(a), pair(b));
    const Pair p = pair(c), q = pair(d);
    const Pair low = least(least(pair(a), pair(b)), least(p, q));
    const Pair high = greatest(greatest(pair(a), pair(b)), greatest(p, q));
    return {base.place(p)[0],
            Certainty::within(low, high, guard).of_distance,
            below(base.place(p), base.place(q)),
            error_of_below<Paraboloid>(base.bound(p), base.bound(q)),
            circle.det,
            circle.error,
            static_cast<double>(orient2d(a, b, c)),
            static_cast<double>(incircle_exact(a, b, c, d, Guard::anywhere())),
            incircle_canonical(a, b, c, d, guard) ? 1.0 : -1.0};
}

}  // namespace

int main() {
    Question question;
    while (std::fread(&question, sizeof question, 1, stdin) == 1) {
        const Answer all = answer(question);
        if (std::fwrite(all.data(), sizeof all, 1, stdout) != 1) return 1;
    }
    return 0;
}
