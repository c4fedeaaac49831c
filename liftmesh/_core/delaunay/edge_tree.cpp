#include "delaunay/edge_tree.hpp"

#include <cmath>
#include <utility>

#include "sorting/sample.hpp"

namespace liftmesh {

namespace {

constexpr std::size_t triangles_per_edge = 10;
constexpr std::size_t nodes_per_edge = 2;
constexpr std::uint32_t most_edges = (std::uint32_t{1} << 31) - 1;  // 31 bits name every edge
constexpr int deepest = 64;  // a limit to recursion: on all known inputs trees are half as deep

// Twice the area of a triangle, rounded.
double area(Point a, Point b, Point c) {
    return (a.x - c.x) * (b.y - c.y) - (a.y - c.y) * (b.x - c.x);
}

}  // namespace

// The pieces of the subtrees that are still to be made stand in one array, one after the other: the
// memory is that of the sample and of the pieces that cuts have added.
class EdgeTree::Builder {
 public:
    Builder(const Triangulated& mesh, std::vector<Node>& nodes, std::vector<Piece> sample,
            Patience& patience)
        : mesh_(mesh), nodes_(nodes), pieces_(std::move(sample)), patience_(patience) {}

    // Makes a subtree of at most `room` nodes of the pieces from the first to the last of all, and
    // removes them. Its root is the first piece: they are in random order, so that it is as good
    // as any.
    void build(std::size_t first, int level, std::size_t room) {
        const std::size_t at = nodes_.size();
        nodes_.push_back({0, pieces_[first].edge & most_edges, 0});
        const std::size_t middle = divide(first);
        const std::size_t left = pieces_.size() - middle, both = pieces_.size() - first;
        const bool is_last = both == 0 || level == deepest || patience_.ends(both);
        const std::size_t rest = is_last ? 0 : room - 1;
        const std::size_t room_left = is_last ? 0 : rest * left / both;
        if (room_left > 0) {
            nodes_[at].has_left = 1;
            build(middle, level + 1, room_left);
        }
        pieces_.resize(middle);
        if (middle != first && room_left < rest) {
            nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
            build(first, level + 1, rest - room_left);
        }
        pieces_.resize(first);
    }

 private:
    // Puts the parts on the right of the first piece's line before those on the left, and returns
    // where these begin.
    std::size_t divide(std::size_t first) {
        const Line cut = line(mesh_, pieces_[first].edge);
        const std::size_t end = pieces_.size();
        std::size_t middle = first;
        left_.clear();
        for (std::size_t i = first + 1; i < end; ++i) {
            const Piece piece = pieces_[i];
            const Line edge = line(mesh_, piece.edge);
            const int tail = orient2d(cut.tail, cut.head, edge.tail);
            const int head = orient2d(cut.tail, cut.head, edge.head);
            Piece left = piece, right = piece;
            if (tail * head < 0) halve(tail > 0 ? left : right, tail > 0 ? right : left, cut, edge);
            if ((tail > 0 || head > 0) && !left.is_empty()) left_.push_back(left);
            if ((tail < 0 || head < 0) && !right.is_empty()) pieces_[middle++] = right;
        }
        pieces_.resize(middle);
        pieces_.insert(pieces_.end(), left_.begin(), left_.end());
        return middle;
    }

    // The parts before and after the line of an edge that crosses it. Where the share overflows it
    // is NaN, and both parts stay whole.
    static void halve(Piece& with_tail, Piece& with_head, const Line& cut, const Line& edge) {
        const double tail = std::fabs(area(cut.tail, cut.head, edge.tail));
        const double head = std::fabs(area(cut.tail, cut.head, edge.head));
        const auto share = static_cast<float>(tail / (tail + head));
        with_tail.to = std::fmin(with_tail.to, share);
        with_head.from = std::fmax(with_head.from, share);
    }

    const Triangulated& mesh_;
    std::vector<Node>& nodes_;
    std::vector<Piece> pieces_, left_;
    Patience& patience_;
};

EdgeTree::EdgeTree(const Triangulated& mesh, Patience& patience) : mesh_(mesh) {
    std::vector<Piece> sample(mesh.count / triangles_per_edge + 1);
    for (std::size_t i = 0; i < sample.size(); ++i) {
        const std::size_t triangle = sample_place(i, mesh.count);
        sample[i] = {static_cast<std::uint32_t>(3 * triangle + i % 3), 0, 1};
    }
    const std::size_t room = nodes_per_edge * sample.size();
    nodes_.reserve(room);  // what is not used does not become resident
    Builder(mesh, nodes_, std::move(sample), patience).build(0, 0, room);
    nodes_.shrink_to_fit();
}

}  // namespace liftmesh
