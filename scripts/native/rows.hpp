// Planar points as raw doubles, for programs that run the kernel on the points of a file.
#pragma once

#include <cstddef>
#include <fstream>
#include <vector>

#include "base/input.hpp"
#include "base/point.hpp"

namespace native {

inline std::vector<double> doubles_of(const char* file) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    std::vector<double> values(static_cast<std::size_t>(stream.tellg()) / sizeof(double));
    stream.seekg(0);
    stream.read(reinterpret_cast<char*>(values.data()),
                static_cast<std::streamsize>(values.size() * sizeof(double)));
    return values;
}

inline liftmesh::Input input_of(const double* coordinates, std::size_t rows) {
    return {reinterpret_cast<const std::byte*>(coordinates), rows, sizeof(liftmesh::Point),
            sizeof(double), false};
}

}  // namespace native
