// Lines of numbers, parsed in parallel. Each of these functions takes all lines or refuses: which
// of them is wrong, and why, is found out by the caller, who has the time for it.
#pragma once

#include <cstddef>
#include <cstdint>

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

// Counts the words of each line; `words` is the sum.
bool count_words(const Block& block, ThreadPool& pool, std::int64_t* counts, std::size_t& words);

// These parse all words of all lines into one list; `counts` are the words of each line.
Parsed parse_numbers(const Block& block, const std::int64_t* counts, ThreadPool& pool,
                     double* values);
Parsed parse_wholes(const Block& block, const std::int64_t* counts, ThreadPool& pool,
                    std::int64_t* values);

// The vertex of each corner of the faces in an OBJ file, and its normal, 0 for none: a corner is
// vertex, vertex/texture, vertex/texture/normal or vertex//normal, of whole numbers. Those of
// vertices and normals are within int32, and not 0. `named`: whether any corner has a normal.
Parsed parse_corners(const Block& block, const std::int64_t* counts, ThreadPool& pool,
                     std::int32_t* vertices, std::int32_t* normals, bool& named);

}  // namespace liftmesh::text
