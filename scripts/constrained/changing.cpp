// CGAL's Delaunay triangulation of points of which the last are inserted, then the first removed.
//
//     changing POINTS TRIANGLES MANY
//
// POINTS holds x and y of each row as raw doubles, no two of them equal; of the rows the last MANY
// go into the others: all at once, and, with a hierarchy, one at a time in the order of rows. Then
// the first MANY go, one at a time. One line of JSON says what each took in processor's time: the
// conversion to CGAL's points and what was there before are not on the clock. TRIANGLES gets as raw
// 32-bit numbers how many there are after each of the three.
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_hierarchy_2.h>

#include <cstdint>
#include <ctime>
#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Delaunay_triangulation_2<Kernel>;
using Bases = CGAL::Triangulation_data_structure_2<
    CGAL::Triangulation_hierarchy_vertex_base_2<CGAL::Triangulation_vertex_base_2<Kernel>>>;
using Hierarchy = CGAL::Triangulation_hierarchy_2<CGAL::Delaunay_triangulation_2<Kernel, Bases>>;
using Point = Kernel::Point_2;
using Points = std::vector<Point>;

Points read(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    double x = 0, y = 0;
    Points points;
    while (stream.read(reinterpret_cast<char*>(&x), sizeof x) &&
           stream.read(reinterpret_cast<char*>(&y), sizeof y))
        points.emplace_back(x, y);
    if (points.empty()) throw std::runtime_error("cannot read " + file);
    return points;
}

template <class Call>
double seconds(Call call) {
    const std::clock_t start = std::clock();
    call();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

void run(const std::string& given, const std::string& made, std::size_t many) {
    const Points points = read(given);
    const auto last = points.end() - static_cast<std::ptrdiff_t>(many);
    std::int32_t faces[3] = {};
    Triangulation by_range(points.begin(), last);
    const double range = seconds([&] { by_range.insert(last, points.end()); });
    faces[0] = static_cast<std::int32_t>(by_range.number_of_faces());
    by_range.clear();
    Hierarchy hierarchy(points.begin(), last);
    const double alone = seconds([&] {
        for (auto at = last; at != points.end(); ++at) hierarchy.insert(*at);
    });
    faces[1] = static_cast<std::int32_t>(hierarchy.number_of_faces());
    hierarchy.clear();
    Triangulation whole;
    std::vector<Triangulation::Vertex_handle> first;
    for (std::size_t i = 0; i < many; ++i)
        first.push_back(whole.insert(
            points[i], first.empty() ? Triangulation::Face_handle() : first.back()->face()));
    whole.insert(points.begin() + static_cast<std::ptrdiff_t>(many), points.end());
    const double removal = seconds([&] {
        for (const auto each : first) whole.remove(each);
    });
    faces[2] = static_cast<std::int32_t>(whole.number_of_faces());
    std::ofstream stream(made, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(faces), sizeof faces);
    stream.close();
    if (!stream) throw std::runtime_error("cannot write " + made);
    std::cout << "{\"range\": " << range << ", \"alone\": " << alone << ", \"removal\": " << removal
              << "}\n";
}

}  // namespace

int main(int count, char** words) {
    try {
        if (count != 4) throw std::runtime_error("usage: changing POINTS TRIANGLES MANY");
        run(words[1], words[2], std::stoul(words[3]));
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
