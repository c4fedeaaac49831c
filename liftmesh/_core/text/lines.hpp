// The lines of a text: where each begins and ends without the white space around it.
#pragma once

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

// White space as Python sees it in ASCII, and the words between it.

inline bool is_blank(char c) {
    constexpr std::uint64_t blanks = std::uint64_t{0x1F} << 9 | std::uint64_t{0x1F} << 28;
    const auto code = static_cast<unsigned char>(c);
    return code <= ' ' && (blanks >> code & 1) != 0;
}

// Without the white space around it; with `keep_tabs`, tabs stay.
inline std::string_view stripped(std::string_view text, bool keep_tabs = false) {
    const auto goes = [=](char c) { return is_blank(c) && !(keep_tabs && c == '\t'); };
    while (!text.empty() && goes(text.front())) text.remove_prefix(1);
    while (!text.empty() && goes(text.back())) text.remove_suffix(1);
    return text;
}

inline std::size_t count_words(std::string_view line) {
    std::size_t words = 0;
    bool before = true;
    for (const char c : line) {
        const bool blank = is_blank(c);
        words += before && !blank;
        before = blank;
    }
    return words;
}

// Calls take(word) for each word of a line; false as soon as take is.
template <class Take>
bool each_word(std::string_view line, Take take) {
    const char* at = line.data();
    const char* const end = at + line.size();
    for (;;) {
        while (at != end && is_blank(*at)) ++at;
        if (at == end) return true;
        const char* const begin = at;
        while (at != end && !is_blank(*at)) ++at;
        if (!take(std::string_view(begin, static_cast<std::size_t>(at - begin)))) return false;
    }
}

}  // namespace liftmesh::text
