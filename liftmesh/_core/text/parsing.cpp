#include "text/parsing.hpp"

#include "text/lines.hpp"
#include "text/number.hpp"

namespace liftmesh::text {

namespace {

constexpr std::size_t most_lines_of_a_task = 4096, tasks_per_thread = 8;

// Calls visit(first, last) for runs of lines; all stop after one that returns false.
template <class Visit>
Parsed each_run(std::size_t count, ThreadPool& pool, Visit visit) {
    const std::size_t size =
        std::clamp<std::size_t>(count / (tasks_per_thread * pool.size()), 1, most_lines_of_a_task);
    std::atomic<bool> refused = false;
    const bool done = pool.run((count + size - 1) / size, [&](std::size_t task) {
        const std::size_t first = task * size;
        if (!refused && !visit(first, std::min(first + size, count))) refused = true;
    });
    if (!done) return Parsed::interrupted;
    return refused ? Parsed::refused : Parsed::all;
}

const char* behind_blanks(const char* at, const char* end, Separation separation) {
    while (at != end && is_blank(*at) && (separation.by_blanks || *at != separation.delimiter))
        ++at;
    return at;
}

bool parse_row(std::string_view line, Separation separation, std::size_t width, double* row) {
    const char* const end = line.data() + line.size();
    const char* at = behind_blanks(line.data(), end, separation);
    for (std::size_t k = 0; k < width; ++k) {
        const char* const stop = parse_number(at, end, row[k]);
        if (!stop) return false;
        at = behind_blanks(stop, end, separation);
        if (k + 1 == width) break;
        if (separation.by_blanks ? at == stop : at == end || *at++ != separation.delimiter)
            return false;
        at = behind_blanks(at, end, separation);
    }
    return at == end;
}

bool parse_quoted_row(std::string_view line, Separation separation, std::size_t width,
                      double* row) {
    if (separation.by_blanks || line.find('"') == std::string_view::npos) return false;
    std::string plain(line);
    std::erase(plain, '"');
    return parse_row(plain, separation, width, row);
}

// parse(word, k) for the k-th word of all, in parallel.
template <class Parse>
Parsed each_word_of_all(const Block& block, const Words& words, ThreadPool& pool, Parse parse) {
    return each_run(block.count, pool, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            std::size_t k = words.before(i);
            const std::size_t end = k + words.of(i);
            const auto take = [&](std::string_view word) { return k < end && parse(word, k++); };
            if (!each_word(block[i], take) || k != end) return false;
        }
        return true;
    });
}

// A whole number of nine digits at most without a sign, as nearly all indices are.
bool parse_short(std::string_view word, std::int32_t& value) {
    if (word.empty() || word.size() > 9) return false;
    std::int32_t sum = 0;
    for (const char c : word) {
        if (!is_digit(c)) return false;
        sum = 10 * sum + (c - '0');
    }
    value = sum;
    return true;
}

bool parse_index(std::string_view word, std::int32_t& index) {
    std::int64_t value = 0;
    if (!parse_whole(word, value) || value == 0) return false;
    if (value < std::numeric_limits<std::int32_t>::min() ||
        value > std::numeric_limits<std::int32_t>::max())
        return false;
    index = static_cast<std::int32_t>(value);
    return true;
}

bool parse_corner(std::string_view word, std::int32_t& vertex, std::int32_t& normal) {
    normal = 0;
    if (parse_short(word, vertex)) return vertex != 0;
    const std::size_t first = word.find('/');
    if (first == std::string_view::npos) return parse_index(word, vertex);
    if (!parse_index(word.substr(0, first), vertex)) return false;
    const std::string_view rest = word.substr(first + 1);
    const std::size_t second = rest.find('/');
    const std::string_view texture = rest.substr(0, second);
    std::int64_t any = 0;
    if (!texture.empty() && !parse_whole(texture, any)) return false;
    return second == std::string_view::npos || parse_index(rest.substr(second + 1), normal);
}

}  // namespace

std::size_t count_values(std::string_view line, Separation separation) {
    if (separation.by_blanks) return count_words(line);
    return static_cast<std::size_t>(std::count(line.begin(), line.end(), separation.delimiter)) + 1;
}

Parsed parse_table(const Block& block, Separation separation, std::size_t width, ThreadPool& pool,
                   double* rows) {
    return each_run(block.count, pool, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            double* const row = rows + i * width;
            if (!parse_row(block[i], separation, width, row) &&
                !parse_quoted_row(block[i], separation, width, row))
                return false;
        }
        return true;
    });
}

bool count_words(const Block& block, ThreadPool& pool, Words& words) {
    words.begins = allocate<std::size_t>(block.count + 1);
    words.begins[block.count] = 0;
    const Parsed parsed = each_run(block.count, pool, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) words.begins[i] = count_words(block[i]);
        return true;
    });
    for (std::size_t i = 0, sum = 0; i <= block.count; ++i)
        sum += std::exchange(words.begins[i], sum);
    return parsed == Parsed::all;
}

Parsed parse_numbers(const Block& block, const Words& words, ThreadPool& pool, double* values) {
    return each_word_of_all(block, words, pool, [=](std::string_view word, std::size_t k) {
        const char* const end = word.data() + word.size();
        return parse_number(word.data(), end, values[k]) == end;
    });
}

Parsed parse_wholes(const Block& block, const Words& words, ThreadPool& pool,
                    std::int64_t* values) {
    return each_word_of_all(block, words, pool, [=](std::string_view word, std::size_t k) {
        std::int32_t value = 0;
        if (!parse_short(word, value)) return parse_whole(word, values[k]);
        values[k] = value;
        return true;
    });
}

Parsed parse_corners(const Block& block, const Words& words, ThreadPool& pool,
                     std::int32_t* vertices, std::int32_t* normals, bool& named) {
    std::atomic<bool> any = false;
    const auto parse = [&, vertices, normals](std::string_view word, std::size_t k) {
        if (!parse_corner(word, vertices[k], normals[k])) return false;
        if (normals[k] != 0 && !any.load(std::memory_order_relaxed)) any = true;
        return true;
    };
    const Parsed parsed = each_word_of_all(block, words, pool, parse);
    named = any;
    return parsed;
}

}  // namespace liftmesh::text
