#include "text/lines.hpp"

namespace liftmesh::text {

namespace {

constexpr std::size_t piece_size = std::size_t{1} << 16;

// The lines of a piece of the text, numbered from its own first line.
struct Piece {
    std::vector<Line> lines;
    std::vector<std::int64_t> numbers;
    std::size_t all = 0;
    std::size_t lines_before = 0, all_before = 0;  // in other pieces
};

// Where the first line begins at `from` or behind it.
std::size_t line_begin(std::string_view data, std::size_t from) {
    if (from == 0) return 0;
    const std::size_t end = data.find('\n', from - 1);
    return end == std::string_view::npos ? data.size() : end + 1;
}

// Whether a word, most often of one letter, begins a line: the first letter nearly always decides,
// without a call.
bool begins(std::string_view line, std::string_view word) {
    return !line.empty() && !word.empty() && line[0] == word[0] && line.starts_with(word);
}

// `has_remarks`: whether there may be a # in the line.
std::string_view bare(std::string_view line, const Margins& margins, bool has_remarks) {
    line = stripped(line, margins.keep_tabs);
    for (const std::string& mark : margins.comments)
        if (begins(line, mark)) return line.substr(0, 0);
    if (!has_remarks) return line;
    return stripped(line.substr(0, line.find('#')), margins.keep_tabs);
}

// Takes the lines that begin in [begin, end).
void take_lines(std::string_view data, std::size_t begin, std::size_t end, const Margins& margins,
                Piece& piece) {
    const bool has_remarks = !margins.comments.empty() &&
                             data.substr(begin, end - begin).find('#') != std::string_view::npos;
    for (std::size_t at = begin, stop = 0; at < end; at = stop + 1, ++piece.all) {
        stop = at;
        if (data[at] == '\n') continue;
        stop = std::min(data.find('\n', at), data.size());
        const std::string_view line = bare(data.substr(at, stop - at), margins, has_remarks);
        if (line.empty()) continue;
        const std::int64_t first = line.data() - data.data();
        piece.lines.push_back({first, first + static_cast<std::int64_t>(line.size())});
        piece.numbers.push_back(static_cast<std::int64_t>(piece.all));
    }
}

void place(Piece& piece, Lines& found) {
    const auto before = static_cast<std::int64_t>(piece.all_before);
    std::copy(piece.lines.begin(), piece.lines.end(), found.lines.get() + piece.lines_before);
    std::transform(piece.numbers.begin(), piece.numbers.end(),
                   found.numbers.get() + piece.lines_before,
                   [=](std::int64_t number) { return number + before; });
    piece = {};
}

}  // namespace

bool find_lines(std::string_view data, const Margins& margins, ThreadPool& pool, Lines& found) {
    std::vector<Piece> pieces(data.size() / piece_size + 1);
    const bool taken = pool.run(pieces.size(), [&](std::size_t task) {
        const std::size_t begin = line_begin(data, task * piece_size);
        const std::size_t end = line_begin(data, std::min((task + 1) * piece_size, data.size()));
        take_lines(data, begin, task + 1 == pieces.size() ? data.size() : end, margins,
                   pieces[task]);
    });
    if (!taken) return false;
    for (Piece& piece : pieces) {
        piece.lines_before = found.count;
        piece.all_before = found.all;
        found.count += piece.lines.size();
        found.all += piece.all;
    }
    found.lines = allocate<Line>(found.count);
    found.numbers = allocate<std::int64_t>(found.count);
    return pool.run(pieces.size(), [&](std::size_t task) { place(pieces[task], found); });
}

void find_keywords(const Block& block, std::span<const std::string> keywords, std::int8_t* found) {
    for (std::size_t i = 0; i < block.count; ++i) {
        const std::string_view line = block[i];
        found[i] = -1;
        for (std::size_t k = 0; k < keywords.size() && found[i] < 0; ++k) {
            const std::size_t size = keywords[k].size();
            const bool followed = line.size() > size && (line[size] == ' ' || line[size] == '\t');
            if (followed && begins(line, keywords[k])) found[i] = static_cast<std::int8_t>(k);
        }
    }
}

}  // namespace liftmesh::text
