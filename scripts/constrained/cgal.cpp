// CGAL's constrained Delaunay triangulation of the points and edges in a folder.
//
//     cgal FOLDER
//
// FOLDER/points holds x and y of each row as raw doubles, no two of them equal, and FOLDER/edges
// pairs of rows as raw 32-bit numbers. FOLDER/triangles gets the rows of each triangle. One line of
// JSON says what the insertion of both ranges took in processor's time, the better of two runs
// unless the first was long: neither the reading nor the conversion to CGAL's points is on the
// clock.
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel>;
using Point = Kernel::Point_2;
using Numbered = std::pair<Point, std::int32_t>;

constexpr double long_run = 2;  // seconds

template <class Value>
std::vector<Value> read(const std::string& file) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) throw std::runtime_error("cannot read " + file);
    std::vector<Value> values(static_cast<std::size_t>(stream.tellg()) / sizeof(Value));
    stream.seekg(0);
    stream.read(reinterpret_cast<char*>(values.data()),
                static_cast<std::streamsize>(values.size() * sizeof(Value)));
    return values;
}

double seconds_of_insertion(const std::vector<Point>& points,
                            const std::vector<std::pair<std::size_t, std::size_t>>& edges,
                            Triangulation& triangulation) {
    const std::clock_t start = std::clock();
    triangulation.insert_constraints(points.begin(), points.end(), edges.begin(), edges.end());
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

void write(const std::string& file, const Triangulation& triangulation,
           const std::vector<Point>& points) {
    std::vector<Numbered> rows;
    for (const Point& p : points) rows.emplace_back(p, static_cast<std::int32_t>(rows.size()));
    std::sort(rows.begin(), rows.end());
    std::ofstream stream(file, std::ios::binary);
    for (const auto face : triangulation.finite_face_handles()) {
        std::int32_t corners[3];
        for (int k = 0; k < 3; ++k) {
            const Numbered sought(face->vertex(k)->point(), 0);
            corners[k] = std::lower_bound(rows.begin(), rows.end(), sought)->second;
        }
        stream.write(reinterpret_cast<const char*>(corners), sizeof corners);
    }
    stream.close();
    if (!stream) throw std::runtime_error("cannot write " + file);
}

void run(const std::string& folder) {
    const auto coordinates = read<double>(folder + "/points");
    const auto ends = read<std::int32_t>(folder + "/edges");
    std::vector<Point> points;
    std::vector<std::pair<std::size_t, std::size_t>> edges;
    for (std::size_t i = 0; i < coordinates.size(); i += 2)
        points.emplace_back(coordinates[i], coordinates[i + 1]);
    for (std::size_t i = 0; i < ends.size(); i += 2) edges.emplace_back(ends[i], ends[i + 1]);
    Triangulation triangulation;
    double seconds = seconds_of_insertion(points, edges, triangulation);
    if (seconds < long_run) {
        triangulation.clear();
        seconds = std::min(seconds, seconds_of_insertion(points, edges, triangulation));
    }
    write(folder + "/triangles", triangulation, points);
    std::cout << "{\"version\": \"" << CGAL_VERSION_STR << "\", \"seconds\": " << seconds << "}"
              << std::endl;
}

}  // namespace

int main(int count, char** words) {
    if (count != 2) return 2;
    try {
        run(words[1]);
    } catch (const std::exception& error) {
        std::cerr << error.what() << std::endl;
        return 1;
    }
    return 0;
}
