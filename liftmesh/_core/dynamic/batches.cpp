// Many points at once. A few go one by one, in the order of a Hilbert curve unless they are very
// few, so that the way to each is short. Where an eighth of the points changes, divide and conquer
// makes everything anew in less time, and the same triangles.

#include "delaunay/delaunay.hpp"
#include "dynamic/triangulation.hpp"
#include "sorting/along_curve.hpp"

namespace liftmesh::dynamic {

namespace {

constexpr std::size_t few = 64;

std::vector<Row> as_given(std::size_t count) {
    std::vector<Row> rows(count);
    std::iota(rows.begin(), rows.end(), Row{0});
    return rows;
}

// The rows in the order of a Hilbert curve; none if interrupted.
std::vector<Row> ordered(const Input& input, Interrupt& interrupt) {
    std::vector<PlacedRow<HilbertCurve>> placed(input.rows);
    for (std::size_t row = 0; row < input.rows; ++row) placed[row].row = static_cast<Row>(row);
    const auto at = [&input](Row row) { return input[row]; };
    AlongCurve<HilbertCurve, decltype(at)>(at, interrupt).arrange(placed);
    if (interrupt.requested()) return {};
    std::vector<Row> rows(input.rows);
    std::transform(placed.begin(), placed.end(), rows.begin(),
                   [](const auto& each) { return each.row; });
    return rows;
}

}  // namespace

Input input_of(const std::vector<Point>& points) {
    return {reinterpret_cast<const std::byte*>(points.data()), points.size(), sizeof(Point),
            sizeof(double), false};
}

Status Triangulation::insert(const Input& input, Vertex* found, Interrupt& interrupt) {
    if (input.rows >= few && 8 * input.rows >= size_) return insert_anew(input, found, interrupt);
    Patience patience(interrupt);
    Vertex last = ghost;
    const std::vector<Row> rows =
        input.rows < few ? as_given(input.rows) : ordered(input, interrupt);
    if (rows.size() < input.rows) return Status::interrupted;
    for (const Row row : rows) {
        if (patience.ends(few)) return Status::interrupted;
        found[row] = last = insert(input[row], input.rows < few ? ghost : last);
    }
    return Status::ok;
}

Status Triangulation::remove(const Vertex* vertices, std::size_t count, Interrupt& interrupt) {
    if (count >= few && 8 * count >= size_) return remove_anew(vertices, count, interrupt);
    Patience patience(interrupt);
    for (std::size_t i = 0; i < count; ++i) {
        if (patience.ends(few)) return Status::interrupted;
        remove(vertices[i]);
    }
    return Status::ok;
}

std::vector<bool> Triangulation::present() const {
    std::vector<bool> found(points_.size());
    for (std::size_t i = 0; i < size_; ++i) found[order_[i]] = true;
    return found;
}

void Triangulation::gather(const std::vector<bool>& wanted, std::vector<Point>& points,
                           std::vector<Vertex>& vertex_of_row) const {
    for (Vertex v = 0; v < points_.size(); ++v) {
        if (!wanted[v]) continue;
        vertex_of_row.push_back(v);
        points.push_back(points_[v]);
    }
}

Status Triangulation::insert_anew(const Input& input, Vertex* found, Interrupt& interrupt) {
    std::vector<Vertex> vertex_of_row;
    std::vector<Point> points;
    gather(present(), points, vertex_of_row);
    const std::size_t before = points.size();
    for (std::size_t row = 0; row < input.rows; ++row) points.push_back(input[row]);
    const Constrained outcome = build(points, vertex_of_row, interrupt);
    if (outcome.status == Status::interrupted) return outcome.status;
    std::vector<Row> kept = as_given(points.size());
    for (const Duplicate& each : outcome.duplicates) kept[each.row] = each.kept;
    vertex_of_row.resize(points.size());
    reserve(outcome.distinct);
    for (std::size_t row = before; row < points.size(); ++row) {
        vertex_of_row[row] = kept[row] == row ? add_vertex(points[row]) : vertex_of_row[kept[row]];
        found[row - before] = vertex_of_row[row];
    }
    take(outcome, vertex_of_row);
    return Status::ok;
}

Status Triangulation::remove_anew(const Vertex* vertices, std::size_t count, Interrupt& interrupt) {
    std::vector<bool> stays = present();
    for (std::size_t i = 0; i < count; ++i) stays[vertices[i]] = false;
    std::vector<Vertex> vertex_of_row;
    std::vector<Point> points;
    gather(stays, points, vertex_of_row);
    const Constrained outcome = build(points, vertex_of_row, interrupt);
    if (outcome.status == Status::interrupted) return outcome.status;
    for (std::size_t i = 0; i < count; ++i) forget(vertices[i]);
    take(outcome, vertex_of_row);
    return Status::ok;
}

void Triangulation::reserve(std::size_t count) {
    const std::size_t all = points_.size() + count;
    make_room(points_, all);
    make_room(corner_, all);
    make_room(order_, all);
    make_room(place_, all);
}

// All anew, of points of which the first are vertices; and all memory that `take` needs, so that
// nothing is lost where there is none.
Constrained Triangulation::build(const std::vector<Point>& points,
                                 const std::vector<Vertex>& vertex_of_row, Interrupt& interrupt) {
    fresh_.clear();
    fresh_line_.clear();
    fresh_parts_.clear();
    const std::vector<Piece> wholes(constraints_.wholes().begin(), constraints_.wholes().end());
    std::vector<std::int32_t> edges;
    for (const Piece each : wholes)
        for (const Vertex v : {each.first, each.second}) {
            const auto at = std::lower_bound(vertex_of_row.begin(), vertex_of_row.end(), v);
            edges.push_back(static_cast<std::int32_t>(at - vertex_of_row.begin()));
        }
    const Input input = input_of(points);
    Constrained outcome;
    if (wholes.empty())
        static_cast<Delaunay&>(outcome) = delaunay(input, false, {1, false}, interrupt);
    else
        outcome =
            constrained_delaunay(input, edges.data(), wholes.size(), false, {1, false}, interrupt);
    hull_.reserve(outcome.result.hull_count);
    if (outcome.status == Status::ok) {
        fresh_.reserve(2 * outcome.distinct - 2);
        if (!wholes.empty()) fresh_.keep_marks();
        for (std::size_t i = 0; i < outcome.pieces.size(); ++i)
            for (std::size_t k = outcome.starts[i]; k < outcome.starts[i + 1]; ++k)
                fresh_parts_.insert({outcome.pieces[i], wholes[outcome.members[k]]});
    } else if (outcome.status != Status::interrupted) {
        for (std::size_t row = 0; row < points.size(); ++row)
            fresh_line_.emplace(points[row], static_cast<Vertex>(row));
        for (const Piece each : wholes)
            for (const Piece part :
                 pieces_between(fresh_line_, points_[each.first], points_[each.second]))
                fresh_parts_.insert({part, each});
    }
    return outcome;
}

std::vector<Row> Triangulation::adopt(const Input& input, Constrained& mesh) {
    const Result& result = mesh.result;
    std::vector<bool> is_corner(input.rows);
    for (std::size_t i = 0; i < 3 * result.triangle_count; ++i)
        is_corner[static_cast<std::size_t>(result.simplices[i])] = true;
    std::vector<Vertex> vertex_of_row(input.rows, ghost);
    std::vector<Row> rows;
    for (Row row = 0; row < input.rows; ++row) {
        if (!is_corner[row]) continue;
        rows.push_back(row);
        vertex_of_row[row] = add_vertex(input[row]);
    }
    mesh.distinct = rows.size();
    fresh_.reserve(2 * rows.size() - 2);
    fresh_.keep_marks();
    take(mesh, vertex_of_row);
    return rows;
}

// The result of a run over the rows of the vertices that are present.
void Triangulation::take(const Constrained& outcome, const std::vector<Vertex>& vertex_of_row) {
    line_.clear();
    std::swap(line_, fresh_line_);
    std::swap(slots_, fresh_);
    fresh_.clear();
    constraints_.renew(fresh_parts_, [&](Row row) { return vertex_of_row[row]; });
    last_ = ghost;
    if (outcome.status != Status::ok) {
        for (auto& [p, row] : line_) row = vertex_of_row[row];
        return;
    }
    const Result& result = outcome.result;
    const auto vertex = [&](std::int32_t row) {
        return vertex_of_row[static_cast<std::size_t>(row)];
    };
    // Slots are handed out from the last one down.
    const auto slot = [&](std::size_t i) { return triangle_in(2 * outcome.distinct - 3 - i); };
    for (std::size_t i = 0; i < result.triangle_count; ++i) {
        const std::int32_t* corners = &result.simplices[3 * i];
        const TriangleId t =
            slots_.make(vertex(corners[0]), vertex(corners[1]), vertex(corners[2]));
        if (slots_.has_marks()) slots_.set_marks(t, outcome.marks[i]);
        for (unsigned k = 0; k < 3; ++k) corner_[vertex(corners[k])] = edge(slot(i), k);
    }
    for (std::size_t i = 0; i < result.triangle_count; ++i) {
        for (unsigned k = 0; k < 3; ++k) {
            const Edge e = edge(slot(i), k);
            const std::int32_t beyond = result.neighbors[3 * i + k];
            if (beyond < 0) corner_[slots_.tail(e)] = e;
            if (beyond < 0) continue;
            const auto j = static_cast<std::size_t>(beyond);
            const std::int32_t* back = &result.neighbors[3 * j];
            const unsigned m = back[0] == static_cast<std::int32_t>(i)   ? 0
                               : back[1] == static_cast<std::int32_t>(i) ? 1
                                                                         : 2;
            slots_.join(e, edge(slot(j), m));
        }
    }
    hull_.clear();
    for (std::size_t i = 0; i < result.hull_count; ++i) hull_.push_back(vertex(result.hull[i]));
    place_ghosts();
}

std::vector<constrained::Mark> Triangulation::marks() const {
    std::vector<constrained::Mark> found;
    found.reserve(slots_.real());
    for (TriangleId t = 0; t < slots_.end(); t += words_per_triangle)
        if (!slots_.is_free(t) && !slots_.is_ghost(t))
            found.push_back(slots_.has_marks() ? slots_.marks(t) : constrained::Mark{0});
    return found;
}

Result Triangulation::result() const {
    Result found;
    std::vector<std::int32_t> number(slots_.end() / words_per_triangle, -1);
    std::int32_t count = 0;
    TriangleId some_ghost = nothing;
    for (TriangleId t = 0; t < slots_.end(); t += words_per_triangle) {
        if (slots_.is_free(t)) continue;
        if (slots_.is_ghost(t))
            some_ghost = t;
        else
            number[slot_of(t)] = count++;
    }
    const std::size_t hull = some_ghost == nothing ? 0 : 2 * size_ - 2 - slots_.real();
    found.make_room(slots_.real(), hull);
    std::size_t at = 0;
    for (TriangleId t = 0; t < slots_.end(); t += words_per_triangle) {
        if (slots_.is_free(t) || slots_.is_ghost(t)) continue;
        for (unsigned k = 0; k < 3; ++k, ++at) {
            found.simplices[at] = static_cast<std::int32_t>(slots_.vertex(t, k));
            found.neighbors[at] = number[slot_of(triangle_of(slots_.twin(edge(t, k))))];
        }
    }
    TriangleId g = some_ghost;
    for (std::size_t i = 0; i < hull; ++i, g = triangle_of(slots_.twin(edge(g, 1))))
        found.hull[i] = static_cast<std::int32_t>(slots_.vertex(g, 1));
    return found;
}

}  // namespace liftmesh::dynamic
