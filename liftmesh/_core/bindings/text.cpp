// The Python interface of text/: bytes in, arrays out; and columns in, bytes out.

#include "base/floating_point.hpp"
#include "bindings/python.hpp"
#include "text/lines.hpp"
#include "text/parsing.hpp"
#include "text/printing.hpp"

namespace bindings {

namespace {

// `lines` are pairs of where a line begins and where it ends.

using LinePairs = Array<const std::int64_t, 2>;
using Words = std::vector<std::string>;

std::string_view view(const nb::bytes& data) {
    return {data.c_str(), data.size()};
}

liftmesh::text::Block block(const nb::bytes& data, const LinePairs& lines) {
    static_assert(sizeof(liftmesh::text::Line) == 2 * sizeof(std::int64_t));
    const auto* const first = reinterpret_cast<const liftmesh::text::Line*>(lines.data());
    const auto size = static_cast<std::int64_t>(data.size());
    for (std::size_t i = 0; i < lines.shape(0); ++i)
        if (first[i].begin < 0 || first[i].end < first[i].begin || first[i].end > size)
            throw std::invalid_argument("a line is not within the text");
    return {view(data), first, lines.shape(0)};
}

// Runs work(pool), which returns whether it went to its end, without the GIL.
template <class Work>
void in_parallel(unsigned threads, Work work) {
    run_unlocked([&](auto& interrupt) {
        liftmesh::ThreadPool pool({threads, true}, interrupt);
        return work(pool);
    });
}

template <class T>
nb::object writable(liftmesh::Buffer<T> values, std::vector<std::size_t> shape) {
    const nb::capsule owner(values.get(), [](void* p) noexcept { liftmesh::Free()(p); });
    T* data = values.release();
    return nb::cast(nb::ndarray<nb::numpy, T>(data, shape.size(), shape.data(), owner));
}

nb::tuple find_lines(const nb::bytes& data, const Words& comments, bool keep_tabs,
                     unsigned threads) {
    liftmesh::text::Lines found;
    in_parallel(threads, [&](liftmesh::ThreadPool& pool) {
        return find_lines(view(data), {comments, keep_tabs}, pool, found);
    });
    auto pairs = liftmesh::reuse<std::int64_t>(std::move(found.lines));
    return nb::make_tuple(writable(std::move(pairs), {found.count, 2}),
                          writable(std::move(found.numbers), {found.count}), found.all);
}

nb::object find_keywords(const nb::bytes& data, const LinePairs& lines, const Words& keywords) {
    auto found = liftmesh::allocate<std::int8_t>(lines.shape(0));
    find_keywords(block(data, lines), keywords, found.get());
    return writable(std::move(found), {lines.shape(0)});
}

liftmesh::text::Separation separation(std::string_view delimiter) {
    return {delimiter.empty() ? '\0' : delimiter.front(), delimiter.empty()};
}

std::size_t count_values(const nb::bytes& line, std::string_view delimiter) {
    return liftmesh::text::count_values(view(line), separation(delimiter));
}

// None if a line is not a row of `width` numbers.
nb::object parse_table(const nb::bytes& data, const LinePairs& lines, std::size_t width,
                       std::string_view delimiter, unsigned threads) {
    const liftmesh::text::Block rows = block(data, lines);
    // Of two bytes at least is each value but the last: so the memory is in proportion to the text.
    if (rows.count != 0 && width > data.size() / rows.count / 2 + 1) return nb::none();
    auto table = liftmesh::allocate<double>(rows.count * width);
    auto parsed = liftmesh::text::Parsed::all;
    in_parallel(threads, [&](liftmesh::ThreadPool& pool) {
        parsed = parse_table(rows, separation(delimiter), width, pool, table.get());
        return parsed != liftmesh::text::Parsed::interrupted;
    });
    if (parsed == liftmesh::text::Parsed::refused) return nb::none();
    return writable(std::move(table), {rows.count, width});
}

// What `parse(words, pool)` makes of lines: first as if all had as many words as the first, since
// counting takes as long as parsing; if they have not, they are counted.
template <class Parse>
liftmesh::text::Parsed parse_words(const liftmesh::text::Block& rows, unsigned threads,
                                   liftmesh::text::Words& words, Parse parse) {
    using liftmesh::text::Parsed;
    auto parsed = Parsed::interrupted;
    words.lines = rows.count;
    words.of_each = rows.count == 0 ? 0 : liftmesh::text::count_values(rows[0], {});
    in_parallel(threads, [&](liftmesh::ThreadPool& pool) {
        // Each word takes two bytes at least, or one at the end.
        const bool may_fit = words.count() <= rows.data.size() / 2 + 1;
        parsed = may_fit ? parse(words, pool) : Parsed::refused;
        if (parsed == Parsed::refused)
            parsed = count_words(rows, pool, words) ? parse(words, pool) : Parsed::interrupted;
        return parsed != Parsed::interrupted;
    });
    return parsed;
}

nb::object counts(const liftmesh::text::Words& words) {
    auto found = liftmesh::allocate<std::int64_t>(words.lines);
    for (std::size_t i = 0; i < words.lines; ++i) found[i] = static_cast<std::int64_t>(words.of(i));
    return writable(std::move(found), {words.lines});
}

// The words of each line, and all values: int64 if all are whole numbers, else float64. None if one
// is no number.
nb::object parse_numbers(const nb::bytes& data, const LinePairs& lines, unsigned threads) {
    using liftmesh::text::Parsed;
    const liftmesh::text::Block rows = block(data, lines);
    liftmesh::text::Words words;
    liftmesh::Buffer<std::int64_t> wholes;
    liftmesh::Buffer<double> numbers;
    const auto parse = [&](const liftmesh::text::Words& expected, liftmesh::ThreadPool& pool) {
        numbers = {};
        wholes = liftmesh::allocate<std::int64_t>(expected.count());
        const auto parsed = parse_wholes(rows, expected, pool, wholes.get());
        if (parsed != Parsed::refused) return parsed;
        numbers = liftmesh::reuse<double>(std::move(wholes));
        return liftmesh::text::parse_numbers(rows, expected, pool, numbers.get());
    };
    if (parse_words(rows, threads, words, parse) == Parsed::refused) return nb::none();
    const std::size_t count = words.count();
    return nb::make_tuple(counts(words), numbers ? writable(std::move(numbers), {count})
                                                 : writable(std::move(wholes), {count}));
}

// The corners of each face, the vertex of each corner, and its normal, or None if none has one.
// None if a corner is none.
nb::object parse_corners(const nb::bytes& data, const LinePairs& lines, unsigned threads) {
    const liftmesh::text::Block rows = block(data, lines);
    liftmesh::text::Words words;
    liftmesh::Buffer<std::int32_t> vertices, normals;
    bool named = false;
    const auto parse = [&](const liftmesh::text::Words& expected, liftmesh::ThreadPool& pool) {
        vertices = liftmesh::allocate<std::int32_t>(expected.count());
        normals = liftmesh::allocate<std::int32_t>(expected.count());
        return liftmesh::text::parse_corners(rows, expected, pool, vertices.get(), normals.get(),
                                             named);
    };
    const auto parsed = parse_words(rows, threads, words, parse);
    if (parsed == liftmesh::text::Parsed::refused) return nb::none();
    const std::size_t count = words.count();
    return nb::make_tuple(counts(words), writable(std::move(vertices), {count}),
                          named ? writable(std::move(normals), {count}) : nb::object(nb::none()));
}

liftmesh::text::Column column(const Column& values, bool shortest) {
    using liftmesh::text::Kind;
    const nb::dlpack::dtype type = values.dtype();
    const auto size = values.itemsize();
    const auto is = [&](nb::dlpack::dtype_code code) {
        return type.code == static_cast<std::uint8_t>(code);
    };
    Kind kind = is(nb::dlpack::dtype_code::Int) ? Kind::whole : Kind::natural;
    if (type == nb::dtype<double>())
        kind = Kind::shortest;
    else if (type == nb::dtype<float>())
        kind = shortest ? Kind::shortest_single : Kind::nine_digits;
    else if (!is(nb::dlpack::dtype_code::Int) && !is(nb::dlpack::dtype_code::UInt))
        throw std::invalid_argument("columns must be float64, float32 or integers");
    return {static_cast<const std::byte*>(values.data()),
            values.stride(0) * static_cast<std::ptrdiff_t>(size), kind, size};
}

// Prints rows as text while Python does something else, such as writing those before them.
class Printer {
 public:
    Printer(Words around, bool shortest, unsigned threads)
        : columns_(around.size() - 1),
          shortest_(shortest),
          printer_(std::move(around), pool_),
          pool_({threads, true}, interrupt_) {}
    Printer(const Printer&) = delete;
    Printer& operator=(const Printer&) = delete;

    void begin(std::vector<Column> columns) {
        if (columns.empty() || columns.size() != columns_)
            throw std::invalid_argument("a row needs a value, and text around each");
        std::vector<liftmesh::text::Column> typed;
        for (const Column& values : columns) {
            if (values.shape(0) != columns[0].shape(0))
                throw std::invalid_argument("lengths differ");
            typed.push_back(column(values, shortest_));
        }
        if (std::exchange(printing_, true)) throw std::logic_error("finish the rows before these");
        values_ = std::move(columns);
        printer_.begin({std::move(typed), values_[0].shape(0)});
    }

    // The text of the rows, in parts.
    nb::list finish() {
        bool done = false;
        {
            const nb::gil_scoped_release unlocked;
            const liftmesh::IeeeArithmetic ieee;
            done = printer_.finish();
        }
        printing_ = false;
        if (!done) throw_interruption();
        nb::list texts;
        for (const liftmesh::text::Part& part : printer_.parts())
            if (part.size != 0) texts.append(view(part));
        return texts;
    }

 private:
    // The view keeps the memory.
    static nb::object view(const liftmesh::text::Part& part) {
        using Text = std::shared_ptr<char[]>;
        const nb::capsule owner(new Text(part.text),
                                [](void* p) noexcept { delete static_cast<Text*>(p); });
        const nb::ndarray<nb::numpy, const std::uint8_t> bytes(part.text.get(), {part.size}, owner);
        return nb::steal(PyMemoryView_FromObject(nb::cast(bytes).ptr()));
    }

    // Of what ended a run: the process may also have been forked between `begin` and `finish`.
    static void throw_interruption() {
        if (PyErr_Occurred() == nullptr)
            PyErr_SetString(PyExc_RuntimeError, "the process was forked while it printed");
        throw nb::python_error();
    }

    std::size_t columns_;
    bool shortest_, printing_ = false;
    std::vector<Column> values_;  // until they are printed
    PythonInterrupt interrupt_;
    liftmesh::text::Printer printer_;
    liftmesh::ThreadPool pool_;  // ends before what its threads work on
};

}  // namespace

void bind_text(nb::module_& m) {
    m.def("find_lines", &find_lines, "data"_a, "comments"_a, "keep_tabs"_a, "threads"_a);
    m.def("find_keywords", &find_keywords, "data"_a, "lines"_a, "keywords"_a);
    m.def("count_values", &count_values, "line"_a, "delimiter"_a);
    m.def("parse_table", &parse_table, "data"_a, "lines"_a, "width"_a, "delimiter"_a, "threads"_a);
    m.def("parse_numbers", &parse_numbers, "data"_a, "lines"_a, "threads"_a);
    m.def("parse_corners", &parse_corners, "data"_a, "lines"_a, "threads"_a);
    nb::class_<Printer>(m, "Printer")
        .def(nb::init<Words, bool, unsigned>(), "around"_a, "shortest"_a, "threads"_a)
        .def("begin", &Printer::begin, "columns"_a)
        .def("finish", &Printer::finish);
}

}  // namespace bindings
