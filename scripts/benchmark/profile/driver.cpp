// Triangulates the points of a file (raw doubles) once, on one thread: what the profiler runs.
#include <cstdio>
#include <fstream>
#include <vector>

#include "delaunay/delaunay.hpp"

namespace {

class NeverInterrupted final : public liftmesh::Interrupt {
 public:
    bool requested() override { return false; }
};

std::vector<double> read(const char* file) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    std::vector<double> values(static_cast<std::size_t>(stream.tellg()) / sizeof(double));
    stream.seekg(0);
    stream.read(reinterpret_cast<char*>(values.data()),
                static_cast<std::streamsize>(values.size() * sizeof(double)));
    return values;
}

}  // namespace

int main(int, char** arguments) {
    const std::vector<double> values = read(arguments[1]);
    const liftmesh::Input input{reinterpret_cast<const std::byte*>(values.data()),
                                values.size() / 2, 2 * sizeof(double), sizeof(double), false};
    NeverInterrupted interrupt;
    const liftmesh::Delaunay found =
        liftmesh::delaunay(input, false, liftmesh::Threads{}, interrupt);
    return found.status == liftmesh::Status::ok ? 0 : 1;
}
