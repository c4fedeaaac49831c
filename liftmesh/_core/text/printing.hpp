// Rows of numbers as lines of text, printed in parallel.
#pragma once

#include "base/buffer.hpp"
#include "parallel/thread_pool.hpp"

namespace liftmesh::text {

enum class Kind : std::uint8_t { shortest, shortest_single, nine_digits, whole, natural };

// One column of values of the caller, `size` bytes each.
struct Column {
    const std::byte* values;
    std::ptrdiff_t stride;
    Kind kind;
    std::size_t size;
};

struct Rows {
    std::vector<Column> columns;
    std::size_t count;
};

// A part of the text, in the order of the rows.
struct Part {
    std::shared_ptr<char[]> text;
    std::size_t size = 0, room = 0;
};

// Prints some rows after others. The memory of the text is used again for every second lot of rows,
// unless somebody still holds it: memory that is new takes the system nearly as long as the numbers
// take. A pool whose rows were not finished must end before the printer.
class Printer {
 public:
    // `around` stands around the values of each row: before the first, between them, and behind
    // the last.
    Printer(std::vector<std::string> around, ThreadPool& pool)
        : around_(std::move(around)), pool_(pool) {}

    // The other threads begin to print these rows; `finish` joins them.
    void begin(Rows rows);

    // False if the interrupt ended it early.
    bool finish() { return pool_.finish(); }

    // The text of the rows that were printed last.
    std::span<const Part> parts() const { return parts_; }

 private:
    std::vector<std::string> around_;
    ThreadPool& pool_;
    Rows rows_{};
    std::vector<Part> parts_, others_;
};

}  // namespace liftmesh::text
