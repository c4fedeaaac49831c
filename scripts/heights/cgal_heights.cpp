// Heights of CGAL's Delaunay triangulation at points.
//
//     cgal_heights linear|sibson VERTICES QUERIES HEIGHTS
//
// VERTICES holds x, y, z of each row and QUERIES x, y of each point as raw doubles; HEIGHTS gets a
// raw double for each point, NaN outside of the hull. One line of JSON says what the points took in
// processor's time: to sort them along a curve, to locate each from the face of the last one, and
// to interpolate. Neither reading nor the triangulation is on the clock.
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/natural_neighbor_coordinates_2.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include <cstddef>
#include <ctime>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<double, Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<Vertex>;
using Triangulation = CGAL::Delaunay_triangulation_2<Kernel, Structure>;
using Point = Kernel::Point_2;
using Face = Triangulation::Face_handle;
using Shares = std::vector<std::pair<Triangulation::Vertex_handle, double>>;

constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();

std::vector<double> read(const std::string& file) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) throw std::runtime_error("cannot read " + file);
    std::vector<double> values(static_cast<std::size_t>(stream.tellg()) / sizeof(double));
    stream.seekg(0);
    stream.read(reinterpret_cast<char*>(values.data()),
                static_cast<std::streamsize>(values.size() * sizeof(double)));
    return values;
}

Triangulation triangulated(const std::vector<double>& rows) {
    std::vector<std::pair<Point, double>> points;
    for (std::size_t i = 0; i < rows.size(); i += 3)
        points.emplace_back(Point(rows[i], rows[i + 1]), rows[i + 2]);
    return Triangulation(points.begin(), points.end());
}

// The numbers of the points along a curve.
std::vector<std::size_t> sorted(const std::vector<Point>& points) {
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    const auto of_number = CGAL::make_property_map(points);
    using Traits = CGAL::Spatial_sort_traits_adapter_2<Kernel, decltype(of_number)>;
    CGAL::spatial_sort(order.begin(), order.end(), Traits(of_number));
    return order;
}

double linear(const Triangulation& mesh, const Point& query, Face& hint) {
    const Face face = mesh.locate(query, hint);
    hint = face;
    if (mesh.is_infinite(face)) return nowhere;
    const auto &a = face->vertex(0), &b = face->vertex(1), &c = face->vertex(2);
    const Point &p = a->point(), &q = b->point(), &r = c->point();
    const double qx = q.x() - p.x(), qy = q.y() - p.y(), rx = r.x() - p.x(), ry = r.y() - p.y();
    const double x = query.x() - p.x(), y = query.y() - p.y(), area = qx * ry - qy * rx;
    const double of_b = (x * ry - y * rx) / area, of_c = (qx * y - qy * x) / area;
    return a->info() + of_b * (b->info() - a->info()) + of_c * (c->info() - a->info());
}

double sibson(const Triangulation& mesh, const Point& query, Face& hint, Shares& shares) {
    shares.clear();
    const auto vertex_and_share = [](const Shares::value_type& share) { return share; };
    const auto found = CGAL::natural_neighbor_coordinates_2(mesh, query, std::back_inserter(shares),
                                                            vertex_and_share, hint);
    if (!found.third) return nowhere;
    hint = shares.front().first->face();
    double sum = 0;
    for (const auto& [vertex, share] : shares) sum += share * vertex->info();
    return sum / found.second;
}

}  // namespace

int main(int count, char** words) try {
    if (count != 5) throw std::invalid_argument("linear|sibson VERTICES QUERIES HEIGHTS");
    const std::string method = words[1];
    if (method != "linear" && method != "sibson") throw std::invalid_argument(method);
    const Triangulation mesh = triangulated(read(words[2]));
    const std::vector<double> asked = read(words[3]);
    std::vector<Point> queries;
    for (std::size_t i = 0; i < asked.size(); i += 2) queries.emplace_back(asked[i], asked[i + 1]);
    std::vector<double> heights(queries.size());
    Shares shares;
    Face hint;

    const std::clock_t start = std::clock();
    for (const std::size_t i : sorted(queries))
        heights[i] = method == "linear" ? linear(mesh, queries[i], hint)
                                        : sibson(mesh, queries[i], hint, shares);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;

    std::ofstream stream(words[4], std::ios::binary);
    stream.write(reinterpret_cast<const char*>(heights.data()),
                 static_cast<std::streamsize>(heights.size() * sizeof(double)));
    stream.close();
    if (!stream) throw std::runtime_error(std::string("cannot write ") + words[4]);
    std::cout << "{\"seconds\": " << seconds << "}\n";
} catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
}
