// Says whether it was compiled with contraction, and what the kernel would say of that.

#include <cstdio>
#include <exception>

#include "base/floating_point.hpp"

int main() {
    std::puts(liftmesh::contracts() ? "contracts" : "rounds as written");
    try {
        liftmesh::refuse_contraction(false);
    } catch (const std::exception& refusal) {
        std::puts(refusal.what());
    }
    return 0;
}
