// The loop by which PDAL's filter `faceraster` makes a raster of triangles.
//
//     faceraster VERTICES TRIANGLES LEFT BOTTOM STEP COLUMNS ROWS RASTER
//
// VERTICES holds x, y, z of each row as raw doubles, TRIANGLES three raw 32-bit rows each. RASTER
// gets raw doubles, row by row from above, NaN where no triangle is; with "-" nothing is written.
// One line of JSON says what the loop took in processor's time: its raster was filled before.
//
// Rebuilt after PDAL 2.6 (filters/FaceRasterFilter.cpp): each triangle visits the pixels of its
// box, column by column. One that has no height yet is given to a function, which PDAL keeps in
// another file, so it is not inlined here either: three areas with signs, those outside by no more
// than rounding let in, then a mean of the heights. PDAL asks a table of columns for each
// coordinate, and here they are an array, which takes less time.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double outside = std::numeric_limits<double>::infinity();

struct Vertex {
    double x, y, z;
};

struct Triangle {
    std::int32_t corners[3];
};

struct Raster {
    double left, bottom, step;
    int columns, rows;
    std::vector<double> pixels;

    double& at(int column, int row) {
        return pixels[static_cast<std::size_t>(rows - 1 - row) * static_cast<std::size_t>(columns) +
                      static_cast<std::size_t>(column)];
    }
};

template <class Item>
std::vector<Item> read(const std::string& file) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) throw std::runtime_error("cannot read " + file);
    std::vector<Item> items(static_cast<std::size_t>(stream.tellg()) / sizeof(Item));
    stream.seekg(0);
    stream.read(reinterpret_cast<char*>(items.data()),
                static_cast<std::streamsize>(items.size() * sizeof(Item)));
    return items;
}

// Twice the area of a triangle, with its sign.
double area(const Vertex& p, const Vertex& q, double x, double y) {
    return (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
}

double squared(double x, double y) {
    return x * x + y * y;
}

// Whether an area has the other sign by more than rounding; if by less, it becomes zero.
bool is_beyond(double& found, bool is_negative, const Vertex& p, const Vertex& q, double x,
               double y) {
    if (found == 0 || std::signbit(found) == is_negative) return false;
    const double size = squared(q.x - p.x, q.y - p.y) + squared(x - p.x, y - p.y);
    if (std::fabs(found / size) > 1e-14) return true;
    found = 0;
    return false;
}

// The height at a point, infinity outside.
[[gnu::noinline]] double interpolated(const Vertex& a, const Vertex& b, const Vertex& c, double x,
                                      double y) {
    const double whole = area(a, b, c.x, c.y);
    if (whole == 0) return outside;
    const bool is_negative = std::signbit(whole);
    double of_c = area(a, b, x, y);
    if (is_beyond(of_c, is_negative, a, b, x, y)) return outside;
    double of_a = area(b, c, x, y);
    if (is_beyond(of_a, is_negative, b, c, x, y)) return outside;
    double of_b = area(c, a, x, y);
    if (is_beyond(of_b, is_negative, c, a, x, y)) return outside;
    return (of_a * a.z + of_b * b.z + of_c * c.z) / whole;
}

// The pixels of an axis whose centres may be between two coordinates, the last not included.
struct Range {
    int first, last;

    Range(double low, double high, double origin, double step, int count)
        : first(pixel(low - step * 1e-6, origin, step, count)),
          last(pixel(high, origin, step, count)) {}

    static int pixel(double at, double origin, double step, int count) {
        const double whole = std::floor((at + step / 2 - origin) / step);
        return static_cast<int>(std::clamp(whole, 0.0, static_cast<double>(count)));
    }
};

void fill(Raster& raster, const Vertex& a, const Vertex& b, const Vertex& c) {
    const auto [left, right] = std::minmax({a.x, b.x, c.x});
    const auto [bottom, top] = std::minmax({a.y, b.y, c.y});
    const Range columns(left, right, raster.left, raster.step, raster.columns);
    const Range rows(bottom, top, raster.bottom, raster.step, raster.rows);
    for (int column = columns.first; column < columns.last; ++column) {
        for (int row = rows.first; row < rows.last; ++row) {
            double& pixel = raster.at(column, row);
            if (!std::isnan(pixel)) continue;
            const double x = raster.left + (column + 0.5) * raster.step;
            const double y = raster.bottom + (row + 0.5) * raster.step;
            const double z = interpolated(a, b, c, x, y);
            if (z != outside) pixel = z;
        }
    }
}

}  // namespace

int main(int count, char** words) try {
    if (count != 9)
        throw std::invalid_argument("VERTICES TRIANGLES LEFT BOTTOM STEP COLUMNS ROWS RASTER");
    const auto vertices = read<Vertex>(words[1]);
    const auto triangles = read<Triangle>(words[2]);
    Raster raster{std::stod(words[3]), std::stod(words[4]), std::stod(words[5]),
                  std::stoi(words[6]), std::stoi(words[7]), {}};
    const auto columns = static_cast<std::size_t>(raster.columns);
    raster.pixels.assign(columns * static_cast<std::size_t>(raster.rows), nothing);

    const std::clock_t start = std::clock();
    for (const Triangle& each : triangles)
        fill(raster, vertices[each.corners[0]], vertices[each.corners[1]],
             vertices[each.corners[2]]);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;

    if (std::string(words[8]) != "-") {
        std::ofstream stream(words[8], std::ios::binary);
        stream.write(reinterpret_cast<const char*>(raster.pixels.data()),
                     static_cast<std::streamsize>(raster.pixels.size() * sizeof(double)));
        stream.close();
        if (!stream) throw std::runtime_error(std::string("cannot write ") + words[8]);
    }
    std::cout << "{\"seconds\": " << seconds << "}\n";
} catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
}
