// CGAL's graph of one file of disks.
//
//     apollonius DISKS TRIANGLES
//
// DISKS holds x, y and the radius of each row as raw doubles. TRIANGLES gets the corners of each
// finite triangle as raw 32-bit numbers of disks, in lexicographic order of the distinct ones. One
// line of JSON says what the insertion of the range took in processor's time, and how many disks
// are vertices: neither the reading nor the conversion to CGAL's sites is on the clock.
#include <CGAL/Apollonius_graph_2.h>
#include <CGAL/Apollonius_graph_filtered_traits_2.h>
#include <CGAL/Apollonius_graph_hierarchy_2.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/version.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Traits = CGAL::Apollonius_graph_filtered_traits_2<CGAL::Simple_cartesian<double>>;
using Graph = CGAL::Apollonius_graph_hierarchy_2<Traits>;
using Site = Graph::Site_2;
using Disk = std::array<double, 3>;

std::vector<Disk> read(const std::string& file) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) throw std::runtime_error("cannot read " + file);
    std::vector<Disk> disks(static_cast<std::size_t>(stream.tellg()) / sizeof(Disk));
    stream.seekg(0);
    stream.read(reinterpret_cast<char*>(disks.data()),
                static_cast<std::streamsize>(disks.size() * sizeof(Disk)));
    return disks;
}

Disk disk(const Site& site) {
    return {site.point().x(), site.point().y(), site.weight()};
}

void write(const std::string& file, const Graph& graph, std::vector<Disk> disks) {
    std::sort(disks.begin(), disks.end());
    disks.erase(std::unique(disks.begin(), disks.end()), disks.end());
    std::ofstream stream(file, std::ios::binary);
    for (auto face = graph.finite_faces_begin(); face != graph.finite_faces_end(); ++face) {
        std::int32_t corners[3];
        for (int k = 0; k < 3; ++k) {
            const auto at =
                std::lower_bound(disks.begin(), disks.end(), disk(face->vertex(k)->site()));
            corners[k] = static_cast<std::int32_t>(at - disks.begin());
        }
        stream.write(reinterpret_cast<const char*>(corners), sizeof corners);
    }
    stream.close();
    if (!stream) throw std::runtime_error("cannot write " + file);
}

void run(const std::string& given, const std::string& made) {
    const std::vector<Disk> disks = read(given);
    std::vector<Site> sites;
    sites.reserve(disks.size());
    for (const auto& [x, y, radius] : disks) sites.emplace_back(Traits::Point_2(x, y), radius);
    Graph graph;
    const std::clock_t start = std::clock();
    graph.insert(sites.begin(), sites.end());
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    write(made, graph, disks);
    std::cout << "{\"version\": \"" << CGAL_VERSION_STR << "\", \"seconds\": " << seconds
              << ", \"vertices\": " << graph.number_of_visible_sites() << "}" << std::endl;
}

}  // namespace

int main(int count, char** words) {
    if (count != 3) return 2;
    try {
        run(words[1], words[2]);
    } catch (const std::exception& error) {
        std::cerr << error.what() << std::endl;
        return 1;
    }
    return 0;
}
