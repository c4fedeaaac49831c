// Rows of numbers as lines of text, printed in parallel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

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

// What stands around the values of a line: before the first, between them, and behind the last.
struct Rows {
    std::span<const Column> columns;
    std::span<const std::string> around;
    std::size_t count;
};

// A part of the text, in the order of the rows.
struct Part {
    Buffer<char> text;
    std::size_t size = 0, room = 0;
};

// False if the interrupt ended it early. The memory of `parts` is used again: memory that is new
// takes the system nearly as long as the numbers take.
bool print_rows(const Rows& rows, ThreadPool& pool, std::vector<Part>& parts);

}  // namespace liftmesh::text
