// Triangulates the points of a file once: `driver FILE THREADS`. What the profiler runs.
#include <cstdlib>
#include <vector>

#include "delaunay/delaunay.hpp"
#include "rows.hpp"

int main(int, char** arguments) {
    const std::vector<double> values = native::doubles_of(arguments[1]);
    const auto threads = static_cast<unsigned>(std::atoi(arguments[2]));
    liftmesh::NoInterrupt never;
    const liftmesh::Delaunay found = liftmesh::delaunay(
        native::input_of(values.data(), values.size() / 2), false, {threads, false}, never);
    return found.status == liftmesh::Status::ok ? 0 : 1;
}
