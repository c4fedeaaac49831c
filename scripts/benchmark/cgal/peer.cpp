// CGAL's Delaunay triangulation as a worker: it reads one request a line, with tabs between the
// words, and answers with one line of JSON.
//
//     try   FILE          triangulate the points of FILE once and keep the result
//     save  FOLDER        write the kept triangles to FOLDER/triangles, and let go of them
//     time  CALLS FILE    triangulate CALLS times, and say how long each took
//
// Points are raw doubles, triangles raw 32-bit rows of the points. Only the insertion of the range
// is on the clock: not the reading, not the conversion to CGAL's points.
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Delaunay_triangulation_2<Kernel>;
using Point = Kernel::Point_2;
using Points = std::vector<Point>;

// The input and what became of it, between `try` and `save`.
struct Kept {
    Points points;
    Triangulation triangulation;
};

Points read(const std::string& file) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) {
        throw std::runtime_error("cannot read " + file);
    }
    std::vector<double> values(static_cast<std::size_t>(stream.tellg()) / sizeof(double));
    stream.seekg(0);
    stream.read(reinterpret_cast<char*>(values.data()),
                static_cast<std::streamsize>(values.size() * sizeof(double)));
    Points points;
    points.reserve(values.size() / 2);
    for (std::size_t i = 0; i < values.size(); i += 2) {
        points.emplace_back(values[i], values[i + 1]);
    }
    return points;
}

double seconds_of_insertion(const Points& points, Triangulation& triangulation) {
    const auto start = std::chrono::steady_clock::now();
    triangulation.insert(points.begin(), points.end());
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// A size in bytes from the system's account of this process.
std::size_t memory(const std::string& field) {
    std::ifstream status("/proc/self/status");
    std::string line;
    while (std::getline(status, line)) {
        if (line.starts_with(field + ":")) {
            return std::stoul(line.substr(field.size() + 1)) * 1024;
        }
    }
    throw std::runtime_error("/proc/self/status has no " + field);
}

void try_out(const std::string& file, std::optional<Kept>& kept) {
    kept.emplace(Kept{read(file), {}});
    const std::size_t before = memory("VmRSS");
    const double seconds = seconds_of_insertion(kept->points, kept->triangulation);
    const std::size_t peak = std::max(memory("VmHWM"), before);
    std::cout << "{\"seconds\": " << seconds << ", \"beyond\": " << peak - before
              << ", \"peak\": " << peak << "}" << std::endl;
}

void time_calls(int calls, const std::string& file) {
    const Points points = read(file);
    std::cout << "{\"seconds\": [";
    for (int call = 0; call < calls; ++call) {
        Triangulation triangulation;
        std::cout << (call == 0 ? "" : ", ") << seconds_of_insertion(points, triangulation);
    }
    std::cout << "]}" << std::endl;
}

// The rows of the points in lexicographic order: where to look for the row of a vertex.
std::vector<std::int32_t> sorted_rows(const Points& points) {
    std::vector<std::int32_t> rows(points.size());
    for (std::size_t row = 0; row < rows.size(); ++row) {
        rows[row] = static_cast<std::int32_t>(row);
    }
    std::sort(rows.begin(), rows.end(), [&](std::int32_t a, std::int32_t b) {
        return points[static_cast<std::size_t>(a)] < points[static_cast<std::size_t>(b)];
    });
    return rows;
}

std::int32_t row_of(const Point& point, const Points& points,
                    const std::vector<std::int32_t>& rows) {
    return *std::lower_bound(rows.begin(), rows.end(), point,
                             [&](std::int32_t row, const Point& sought) {
                                 return points[static_cast<std::size_t>(row)] < sought;
                             });
}

void save(const std::string& folder, const Kept& kept) {
    const std::vector<std::int32_t> rows = sorted_rows(kept.points);
    std::ofstream stream(folder + "/triangles", std::ios::binary);
    std::size_t triangles = 0;
    for (const auto face : kept.triangulation.finite_face_handles()) {
        std::int32_t corners[3];
        for (int k = 0; k < 3; ++k) {
            corners[k] = row_of(face->vertex(k)->point(), kept.points, rows);
        }
        stream.write(reinterpret_cast<const char*>(corners), sizeof corners);
        ++triangles;
    }
    stream.close();
    if (!stream) {
        throw std::runtime_error("cannot write to " + folder);
    }
    std::cout << "{\"triangles\": " << triangles << "}" << std::endl;
}

void answer(const std::string& line, std::optional<Kept>& kept) {
    std::istringstream words(line);
    std::string verb, calls, path;
    std::getline(words, verb, '\t');
    if (verb == "time") {
        std::getline(words, calls, '\t');
    }
    std::getline(words, path);
    if (verb == "try") {
        try_out(path, kept);
    } else if (verb == "save" && kept) {
        save(path, *kept);
        kept.reset();
    } else if (verb == "time") {
        time_calls(std::stoi(calls), path);
    } else {
        throw std::runtime_error("not a request: " + line);
    }
}

}  // namespace

int main() {
    std::optional<Kept> kept;
    std::string line;
    std::cout.precision(9);
    std::cout << "{\"version\": \"" << CGAL_VERSION_STR << "\"}" << std::endl;
    try {
        while (std::getline(std::cin, line)) {
            answer(line, kept);
        }
    } catch (const std::exception& error) {
        std::cerr << "Error: " << error.what() << std::endl;
        return 1;
    }
    return 0;
}
