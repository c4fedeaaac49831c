// The lines of a text: where each begins and ends without the white space around it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "base/buffer.hpp"
#include "parallel/thread_pool.hpp"

namespace liftmesh::text {

struct Line {
    std::int64_t begin, end;
};

// Some lines of a text.
struct Block {
    std::string_view data;
    const Line* lines;
    std::size_t count;

    std::string_view operator[](std::size_t i) const {
        const auto [begin, end] = lines[i];
        return data.substr(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
    }
};

// The lines that are not empty, and the number of each among all, from 0.
struct Lines {
    Buffer<Line> lines;
    Buffer<std::int64_t> numbers;
    std::size_t count = 0;
    std::size_t all = 0;
};

// What does not belong to a line. Lines that begin with one of `comments` count as empty, and if
// there are any such marks, a # and what follows it are left out. With `keep_tabs`, tabs at the
// ends of a line stay: there they may separate empty values.
struct Margins {
    std::span<const std::string> comments;
    bool keep_tabs = false;
};

// Finds lines, each ended by a line feed; the last need not be. False if the interrupt ended it
// early.
bool find_lines(std::string_view data, const Margins& margins, ThreadPool& pool, Lines& found);

// The position of the first of `keywords` with which each line begins, followed by a blank or a tab
// and more; -1 if there is none.
void find_keywords(const Block& block, std::span<const std::string> keywords, std::int8_t* found);

}  // namespace liftmesh::text
