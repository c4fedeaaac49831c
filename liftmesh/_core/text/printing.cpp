#include "text/printing.hpp"

#include <algorithm>
#include <cstring>

#include "text/number.hpp"

namespace liftmesh::text {

namespace {

constexpr std::size_t values_of_a_task = std::size_t{1} << 13;

template <class T>
T loaded(const std::byte* place) {
    T value;
    std::memcpy(&value, place, sizeof(T));
    return value;
}

// The caller's processor is little-endian or big-endian: each size is read as its own type.
template <class One, class Two, class Four, class Eight>
Eight loaded_whole(const std::byte* place, std::size_t size) {
    switch (size) {
        case 1:
            return loaded<One>(place);
        case 2:
            return loaded<Two>(place);
        case 4:
            return loaded<Four>(place);
        default:
            return loaded<Eight>(place);
    }
}

char* print_value(char* out, const Column& column, const std::byte* place) {
    using std::int16_t, std::int32_t, std::int64_t, std::int8_t;
    using std::uint16_t, std::uint32_t, std::uint64_t, std::uint8_t;
    switch (column.kind) {
        case Kind::shortest:
            return print_shortest(out, loaded<double>(place));
        case Kind::shortest_single:
            return print_shortest(out, loaded<float>(place));
        case Kind::nine_digits:
            return print_nine_digits(out, loaded<float>(place));
        case Kind::whole:
            return print_whole(out,
                               loaded_whole<int8_t, int16_t, int32_t, int64_t>(place, column.size));
        case Kind::natural:
            return print_whole(
                out, loaded_whole<uint8_t, uint16_t, uint32_t, uint64_t>(place, column.size));
    }
    return out;
}

char* copied(char* out, const std::string& text) {
    if (text.size() == 1) {  // most often, and not worth a call
        *out = text[0];
        return out + 1;
    }
    std::memcpy(out, text.data(), text.size());
    return out + text.size();
}

char* print_row(char* out, const Rows& rows, std::size_t i) {
    for (std::size_t k = 0; k < rows.columns.size(); ++k) {
        const Column& column = rows.columns[k];
        out = copied(out, rows.around[k]);
        out = print_value(out, column,
                          column.values + static_cast<std::ptrdiff_t>(i) * column.stride);
    }
    return copied(out, rows.around.back());
}

std::size_t longest_row(const Rows& rows) {
    std::size_t size = rows.columns.size() * longest_number;
    for (const std::string& text : rows.around) size += text.size();
    return size;
}

void print_part(const Rows& rows, std::size_t first, std::size_t last, std::size_t longest,
                Part& part) {
    const std::size_t room = (last - first) * longest;
    if (part.room < room) {
        part.text = allocate<char>(room);
        part.room = room;
    }
    char* out = part.text.get();
    for (std::size_t i = first; i < last; ++i) out = print_row(out, rows, i);
    part.size = static_cast<std::size_t>(out - part.text.get());
}

}  // namespace

bool print_rows(const Rows& rows, ThreadPool& pool, std::vector<Part>& parts) {
    const std::size_t longest = longest_row(rows);
    const std::size_t size = std::max<std::size_t>(values_of_a_task / rows.columns.size(), 1);
    const std::size_t tasks = (rows.count + size - 1) / size;
    for (Part& part : parts) part.size = 0;
    if (parts.size() < tasks) parts.resize(tasks);
    return pool.run(tasks, [&](std::size_t task) {
        const std::size_t first = task * size;
        print_part(rows, first, std::min(first + size, rows.count), longest, parts[task]);
    });
}

}  // namespace liftmesh::text
