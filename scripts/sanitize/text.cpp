// Random rows are printed and parsed again, on one thread and on several; runs are left in their
// middle. Each text stands in memory of its own size: a read beyond its end is seen.

#include "text.hpp"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "text/lines.hpp"
#include "text/number.hpp"
#include "text/parsing.hpp"
#include "text/printing.hpp"

namespace parallel {

namespace {

namespace text = liftmesh::text;
using liftmesh::ThreadPool;

void demand(bool condition, const char* what) {
    if (condition) return;
    std::fprintf(stderr, "FIND: text: %s\n", what);
    std::exit(1);
}

// Doubles of all bits and short ones, single precision, and whole numbers of all lengths.
struct Table {
    std::vector<double> bits, shorts;
    std::vector<float> singles;
    std::vector<std::int64_t> wholes;

    explicit Table(std::size_t rows) {
        std::mt19937_64 random(rows);
        for (std::size_t i = 0; i < rows; ++i) {
            const std::uint64_t word = random();
            double value = 0;
            std::memcpy(&value, &word, sizeof value);
            bits.push_back(value == value ? value : 5e-324);
            shorts.push_back(static_cast<double>(static_cast<std::int64_t>(word) >> word % 60) / 8);
            singles.push_back(static_cast<float>(shorts.back()));
            wholes.push_back(static_cast<std::int64_t>(word) >> word % 64);
        }
        bits[0] = -0.0;
        bits[rows / 2] = std::numeric_limits<double>::infinity();
    }

    template <class T>
    static text::Column column(const std::vector<T>& values, text::Kind kind) {
        return {reinterpret_cast<const std::byte*>(values.data()), sizeof(T), kind, sizeof(T)};
    }

    text::Rows rows() const {
        return {{column(bits, text::Kind::shortest), column(shorts, text::Kind::shortest),
                 column(singles, text::Kind::nine_digits), column(wholes, text::Kind::whole)},
                bits.size()};
    }
};

constexpr std::size_t width = 4;

std::string printed(const Table& table, unsigned threads) {
    liftmesh::NoInterrupt never;
    ThreadPool pool({threads, false}, never);
    text::Printer printer({"", ",", " , ", ",", "\n"}, pool);
    std::string found;
    for (int lot = 0; lot < 3; ++lot) {
        printer.begin(table.rows());
        demand(printer.finish(), "printing was interrupted");
        found.clear();
        for (const text::Part& part : printer.parts()) found.append(part.text.get(), part.size);
    }
    return found;
}

// The pool ends first, as the rows and the printer must outlive its threads.
void left_in_the_middle(const Table& table) {
    liftmesh::NoInterrupt never;
    for (int i = 0; i < 10; ++i) {
        std::optional<ThreadPool> pool;
        pool.emplace(liftmesh::Threads{4, false}, never);
        text::Printer printer({"", ",", ",", ",", "\n"}, *pool);
        printer.begin(table.rows());
        pool.reset();
    }
}

void parsed(const std::string& whole, const Table& table, unsigned threads) {
    const std::vector<char> exact(whole.begin(), whole.end());
    const std::string_view data(exact.data(), exact.size());
    liftmesh::NoInterrupt never;
    ThreadPool pool({threads, false}, never);
    text::Lines lines;
    demand(text::find_lines(data, {}, pool, lines), "lines are not found");
    demand(lines.count == table.bits.size(), "other lines are found");
    const text::Block block{data, lines.lines.get(), lines.count};
    std::vector<double> rows(lines.count * width);
    demand(text::parse_table(block, {',', false}, width, pool, rows.data()) == text::Parsed::all,
           "a table is refused");
    for (std::size_t i = 0; i < lines.count; ++i) {
        demand(std::memcmp(&rows[i * width], &table.bits[i], sizeof(double)) == 0, "other bits");
        demand(rows[i * width + 1] == table.shorts[i], "another short number");
        demand(static_cast<float>(rows[i * width + 2]) == table.singles[i], "another float");
    }
}

// Every beginning of a word, with nothing behind it that may be read.
void ends_of_texts() {
    for (const std::string_view word : {"-1.25e-308", "+infinity", "-nan", "1e+400", "12/34/56",
                                        "\"1\",2", "123456789012345678901234567890", "0.0e-1"})
        for (std::size_t size = 1; size <= word.size(); ++size) {
            const std::vector<char> exact(word.begin(), word.begin() + static_cast<long>(size));
            const text::Line line{0, static_cast<std::int64_t>(size)};
            const text::Block block{{exact.data(), size}, &line, 1};
            liftmesh::NoInterrupt never;
            ThreadPool pool({1, false}, never);
            std::vector<double> row(2);
            std::int32_t vertex = 0, normal = 0;
            bool named = false;
            text::parse_table(block, {}, 1, pool, row.data());
            text::parse_table(block, {',', false}, 2, pool, row.data());
            text::Words words;
            demand(text::count_words(block, pool, words), "words are not counted");
            text::parse_corners(block, words, pool, &vertex, &normal, named);
        }
}

}  // namespace

void check_text(std::size_t rows) {
    const Table table(rows);
    const std::string alone = printed(table, 1);
    for (const unsigned threads : {2u, 3u, 8u}) {
        demand(printed(table, threads) == alone, "threads change what is printed");
        parsed(alone, table, threads);
    }
    parsed(alone.substr(0, alone.size() - 1), table, 1);
    left_in_the_middle(table);
    ends_of_texts();
    std::printf("text: %zu rows\n", rows);
    std::fflush(stdout);
}

}  // namespace parallel
