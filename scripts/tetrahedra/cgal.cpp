// CGAL's Delaunay triangulation of one file of points in space.
//
//     cgal POINTS TETRAHEDRA [calls]
//
// POINTS holds x, y and z of each row as raw doubles. TETRAHEDRA gets the corners of each finite
// cell as raw 32-bit numbers of positions, in lexicographic order of the positions. One line of
// JSON says what the insertion of the range took, in the processor's time of the fastest call, and
// the peak of memory beyond the points: neither the reading nor the conversion to CGAL's points is
// on the clock.
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Delaunay_triangulation_3<Kernel>;
using Point = Kernel::Point_3;
using Points = std::vector<Point>;

Points read(const std::string& file) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) throw std::runtime_error("cannot read " + file);
    std::vector<double> values(static_cast<std::size_t>(stream.tellg()) / sizeof(double));
    stream.seekg(0);
    stream.read(reinterpret_cast<char*>(values.data()),
                static_cast<std::streamsize>(values.size() * sizeof(double)));
    Points points;
    points.reserve(values.size() / 3);
    for (std::size_t i = 0; i < values.size(); i += 3)
        points.emplace_back(values[i], values[i + 1], values[i + 2]);
    return points;
}

// A size in bytes from the system's account of this process.
std::size_t memory(const std::string& field) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with(field + ":")) return std::stoul(line.substr(field.size() + 1)) * 1024;
    throw std::runtime_error("/proc/self/status has no " + field);
}

void write(const std::string& file, const Triangulation& triangulation, Points positions) {
    std::sort(positions.begin(), positions.end());
    positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
    std::ofstream stream(file, std::ios::binary);
    for (const auto cell : triangulation.finite_cell_handles()) {
        std::int32_t corners[4];
        for (int k = 0; k < 4; ++k) {
            const Point& p = cell->vertex(k)->point();
            const auto at = std::lower_bound(positions.begin(), positions.end(), p);
            corners[k] = static_cast<std::int32_t>(at - positions.begin());
        }
        stream.write(reinterpret_cast<const char*>(corners), sizeof corners);
    }
    stream.close();
    if (!stream) throw std::runtime_error("cannot write " + file);
}

void run(const std::string& given, const std::string& made, int calls) {
    const Points points = read(given);
    const std::size_t before = memory("VmRSS");
    Triangulation triangulation;
    double least = std::numeric_limits<double>::infinity();
    for (int call = 0; call < calls; ++call) {
        triangulation.clear();
        const std::clock_t start = std::clock();
        triangulation.insert(points.begin(), points.end());
        least = std::min(least, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    const std::size_t peak = std::max(memory("VmHWM"), before);
    write(made, triangulation, points);
    std::cout << "{\"version\": \"" << CGAL_VERSION_STR << "\", \"seconds\": " << least
              << ", \"beyond\": " << peak - before << "}" << std::endl;
}

}  // namespace

int main(int count, char** words) {
    if (count != 3 && count != 4) return 2;
    try {
        run(words[1], words[2], count == 4 ? std::stoi(words[3]) : 1);
    } catch (const std::exception& error) {
        std::cerr << error.what() << std::endl;
        return 1;
    }
    return 0;
}
