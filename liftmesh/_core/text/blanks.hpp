// White space as Python sees it in ASCII, and the words between it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace liftmesh::text {

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
