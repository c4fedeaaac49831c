#include "text/printing.hpp"

#include "text/number.hpp"

namespace liftmesh::text {

namespace {

constexpr std::size_t values_of_a_task = std::size_t{1} << 12;

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
    if (text.size() < 2) {  // most often, and not worth a call
        *out = text[0];
        return out + text.size();
    }
    std::memcpy(out, text.data(), text.size());
    return out + text.size();
}

using Around = std::span<const std::string>;

// A few rows, whose doubles are turned into decimals before any of them is printed: the processor
// works on several at once if no text stands between them.
class Strip {
 public:
    static constexpr std::size_t most_rows = 32;

    Strip(const Rows& rows, Around around) : rows_(rows), around_(around) {}

    char* print(char* out, std::size_t first, std::size_t last) {
        const std::size_t columns = std::min(rows_.columns.size(), most_columns);
        for (std::size_t k = 0; k < columns; ++k)
            if (rows_.columns[k].kind == Kind::shortest) prepare(k, first, last);
        for (std::size_t i = first; i < last; ++i) out = print_row(out, i, i - first);
        return out;
    }

 private:
    static constexpr std::size_t most_columns = 8;

    static const std::byte* place(const Column& column, std::size_t i) {
        return column.values + static_cast<std::ptrdiff_t>(i) * column.stride;
    }

    void prepare(std::size_t k, std::size_t first, std::size_t last) {
        const Column& column = rows_.columns[k];
        for (std::size_t i = first; i < last; ++i)
            decimals_[k][i - first] = shortest_decimal(std::abs(loaded<double>(place(column, i))));
    }

    char* print_row(char* out, std::size_t i, std::size_t in_strip) const {
        const std::size_t columns = rows_.columns.size();
        for (std::size_t k = 0; k < columns; ++k) {
            const Column& column = rows_.columns[k];
            out = copied(out, around_[k]);
            if (column.kind == Kind::shortest && k < most_columns)
                out = print_shortest(out, loaded<double>(place(column, i)), decimals_[k][in_strip]);
            else
                out = print_value(out, column, place(column, i));
        }
        return copied(out, around_[columns]);
    }

    const Rows& rows_;
    Around around_;
    std::array<std::array<Decimal, most_rows>, most_columns> decimals_;
};

std::size_t longest_row(Around around) {
    std::size_t size = (around.size() - 1) * longest_number;
    for (const std::string& text : around) size += text.size();
    return size;
}

void print_part(const Rows& rows, Around around, std::size_t first, std::size_t last, Part& part) {
    const std::size_t room = (last - first) * longest_row(around);
    if (part.room < room) {
        part.text = allocate<char>(room);
        part.room = room;
    }
    char* out = part.text.get();
    Strip strip(rows, around);
    for (std::size_t i = first; i < last; i += Strip::most_rows)
        out = strip.print(out, i, std::min(i + Strip::most_rows, last));
    part.size = static_cast<std::size_t>(out - part.text.get());
}

}  // namespace

void Printer::begin(Rows rows) {
    rows_ = std::move(rows);
    const std::size_t size = std::max<std::size_t>(values_of_a_task / rows_.columns.size(), 1);
    const std::size_t tasks = (rows_.count + size - 1) / size;
    parts_.swap(others_);
    for (Part& part : parts_) {
        part.size = 0;
        if (part.text.use_count() > 1) part = {};
    }
    if (parts_.size() < tasks) parts_.resize(tasks);
    pool_.begin(tasks, [this, size](std::size_t task) {
        const std::size_t first = task * size;
        print_part(rows_, around_, first, std::min(first + size, rows_.count), parts_[task]);
    });
}

}  // namespace liftmesh::text
