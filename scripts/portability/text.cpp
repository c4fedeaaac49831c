#include "text.hpp"

#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "text/lines.hpp"
#include "text/parsing.hpp"
#include "text/printing.hpp"

namespace portability {

namespace {

namespace text = liftmesh::text;
using text::Kind;

template <class T>
text::Column column(const std::vector<T>& values, Kind kind) {
    return {reinterpret_cast<const std::byte*>(values.data()), sizeof(T), kind, sizeof(T)};
}

std::string printed(text::Rows rows, liftmesh::ThreadPool& pool) {
    std::vector<std::string> around(rows.columns.size() + 1, " ");
    around.front().clear();
    around.back() = "\n";
    text::Printer printer(around, pool);
    printer.begin(std::move(rows));
    demand(printer.finish(), "printing was interrupted");
    std::string found;
    for (const text::Part& part : printer.parts()) found.append(part.text.get(), part.size);
    return found;
}

std::vector<double> parsed(const std::string& data, std::size_t width, liftmesh::ThreadPool& pool) {
    text::Lines lines;
    demand(text::find_lines(data, {}, pool, lines), "lines are not found");
    std::vector<double> values(lines.count * width);
    const text::Block block{data, lines.lines.get(), lines.count};
    demand(text::parse_table(block, {}, width, pool, values.data()) == text::Parsed::all,
           "a table is refused");
    return values;
}

// Single precision of a value, without the undefined conversion of one that is too large.
float single_of(double value) {
    return static_cast<float>(std::bit_cast<std::uint64_t>(value) % 100'000'007) / 1024;
}

}  // namespace

void add_printed(const double* coordinates, std::size_t rows, Digests& digests) {
    const std::vector<double> values(coordinates, coordinates + 2 * rows);
    std::vector<float> singles;
    std::vector<std::int64_t> wholes;
    for (const double value : values) {
        singles.push_back(single_of(value));
        wholes.push_back(std::bit_cast<std::int64_t>(value));
    }
    liftmesh::NoInterrupt never;
    liftmesh::ThreadPool pool({1, false}, never);
    const std::string shortest = printed({{column(values, Kind::shortest)}, values.size()}, pool);
    const std::string others =
        printed({{column(singles, Kind::shortest_single), column(singles, Kind::nine_digits),
                  column(wholes, Kind::whole)},
                 values.size()},
                pool);
    Digest& digest = digests.of["numbers printed"];
    digest.add(shortest.data(), shortest.size());
    digest.add(others.data(), others.size());
    const std::vector<double> again = parsed(shortest, 1, pool);
    demand(std::memcmp(again.data(), values.data(), values.size() * sizeof(double)) == 0,
           "a number is parsed as another than the one printed");
    const std::vector<double> more = parsed(others, 3, pool);
    digests.of["numbers parsed"].add(more.data(), more.size() * sizeof(double));
}

void add_parsed(const char* file, Digests& digests) {
    std::ifstream stream(file, std::ios::binary);
    const std::string data{std::istreambuf_iterator<char>(stream), {}};
    liftmesh::NoInterrupt never;
    liftmesh::ThreadPool pool({1, false}, never);
    const std::vector<double> values = parsed(data, 1, pool);
    digests.of["numbers parsed"].add(values.data(), values.size() * sizeof(double));
}

}  // namespace portability
