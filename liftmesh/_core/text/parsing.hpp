// Lines of numbers, parsed in parallel. Each of these functions takes all lines or refuses: which
// of them is wrong, and why, is found out by the caller, who has the time for it.
#pragma once

#include "base/buffer.hpp"
#include "parallel/thread_pool.hpp"
#include "text/lines.hpp"

namespace liftmesh::text {

enum class Parsed : std::uint8_t { all, refused, interrupted };

// How values are separated: by one character, or by white space.
struct Separation {
    char delimiter = 0;
    bool by_blanks = true;
};

std::size_t count_values(std::string_view line, Separation separation);

// Parses lines of `width` numbers each into rows. Between delimiters, white space and quotation
// marks around and in numbers do not count.
Parsed parse_table(const Block& block, Separation separation, std::size_t width, ThreadPool& pool,
                   double* rows);

// How many words the lines of a block have: each as many as the first, or `begins`, the number of
// words before each line and before the end.
struct Words {
    std::size_t lines = 0, of_each = 0;
    Buffer<std::size_t> begins;

    std::size_t before(std::size_t i) const { return begins ? begins[i] : i * of_each; }
    std::size_t of(std::size_t i) const { return begins ? begins[i + 1] - begins[i] : of_each; }
    std::size_t count() const { return before(lines); }
};

// Counts the words of each line. False if the interrupt ended it early.
bool count_words(const Block& block, ThreadPool& pool, Words& words);

// These parse all words of all lines into one list; they refuse lines of other numbers of words.
Parsed parse_numbers(const Block& block, const Words& words, ThreadPool& pool, double* values);
Parsed parse_wholes(const Block& block, const Words& words, ThreadPool& pool, std::int64_t* values);

// The vertex of each corner of the faces in an OBJ file, and its normal, 0 for none: a corner is
// vertex, vertex/texture, vertex/texture/normal or vertex//normal, of whole numbers. Those of
// vertices and normals are within int32, and not 0. `named`: whether any corner has a normal.
Parsed parse_corners(const Block& block, const Words& words, ThreadPool& pool,
                     std::int32_t* vertices, std::int32_t* normals, bool& named);

}  // namespace liftmesh::text
