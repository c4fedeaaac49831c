// Reads "x y" lines from standard input and prints the triangles of their points, by the kernel's
// own headers, which come with the static library and change with any version.
#include <cstdio>
#include <vector>

#include "delaunay/delaunay.hpp"

int main() {
    std::vector<double> points;
    for (double value; std::scanf("%lf", &value) == 1;) points.push_back(value);
    const liftmesh::Input input{reinterpret_cast<const std::byte*>(points.data()),
                                points.size() / 2, sizeof(liftmesh::Point), sizeof(double), false};
    liftmesh::NoInterrupt nothing;
    const liftmesh::Delaunay found = liftmesh::delaunay(input, false, {2, false}, nothing);
    if (found.status != liftmesh::Status::ok) {
        std::fprintf(stderr, "status %d\n", static_cast<int>(found.status));
        return 1;
    }
    const std::int32_t* corner = found.result.simplices.get();
    for (std::size_t t = 0; t < found.result.triangle_count; ++t, corner += 3)
        std::printf("%d %d %d\n", corner[0], corner[1], corner[2]);
}
