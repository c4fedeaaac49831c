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

class EdgeTree::Builder {
 public:
    Builder(const Triangulated& mesh, std::vector<Node>& nodes, Patience& patience)
        : mesh_(mesh), nodes_(nodes), patience_(patience) {}

    // Adds a node for the first piece, and the subtrees of the parts of the others on either side,
    // with at most `room` nodes in all. The pieces are in random order, so that the first is as
    // good as any.
    void build(std::vector<Piece> pieces, int level, std::size_t room) {
        const std::size_t at = nodes_.size();
        nodes_.push_back({0, pieces.front().edge & most_edges, 0});
        std::vector<Piece> left, right;
        divide(pieces, left, right);
        pieces = {};
        if (level == deepest || patience_.ends(left.size() + right.size())) return;
        const std::size_t both = left.size() + right.size();
        const std::size_t room_left = both == 0 ? 0 : (room - 1) * left.size() / both;
        const std::size_t room_right = room - 1 - room_left;
        if (!left.empty() && room_left > 0) {
            nodes_[at].has_left = 1;
            build(std::move(left), level + 1, room_left);
        }
        if (!right.empty() && room_right > 0) {
            nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
            build(std::move(right), level + 1, room_right);
        }
    }

 private:
    void divide(const std::vector<Piece>& pieces, std::vector<Piece>& left,
                std::vector<Piece>& right) const {
        const Line cut = line(mesh_, pieces.front().edge);
        for (std::size_t i = 1; i < pieces.size(); ++i) {
            const Piece& piece = pieces[i];
            const Line edge = line(mesh_, piece.edge);
            const int tail = orient2d(cut.tail, cut.head, edge.tail);
            const int head = orient2d(cut.tail, cut.head, edge.head);
            if (tail * head < 0) {
                cross(piece, cut, edge, tail > 0 ? left : right, tail > 0 ? right : left);
            } else if (tail + head != 0) {
                (tail + head > 0 ? left : right).push_back(piece);
            }
        }
    }

    // Of an edge that crosses the line the part on either side is kept, if it is in the cell. Where
    // the share overflows it is NaN, and both parts are kept whole.
    static void cross(const Piece& piece, const Line& cut, const Line& edge,
                      std::vector<Piece>& with_tail, std::vector<Piece>& with_head) {
        const double tail = std::fabs(area(cut.tail, cut.head, edge.tail));
        const double head = std::fabs(area(cut.tail, cut.head, edge.head));
        const auto share = static_cast<float>(tail / (tail + head));
        if (!(share <= piece.from))
            with_tail.push_back({piece.edge, piece.from, std::fmin(piece.to, share)});
        if (!(share >= piece.to))
            with_head.push_back({piece.edge, std::fmax(piece.from, share), piece.to});
    }

    const Triangulated& mesh_;
    std::vector<Node>& nodes_;
    Patience& patience_;
};

EdgeTree::EdgeTree(const Triangulated& mesh, Patience& patience) : mesh_(mesh) {
    std::vector<Piece> pieces(mesh.count / triangles_per_edge + 1);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const std::size_t triangle = sample_place(i, mesh.count);
        pieces[i] = {static_cast<std::uint32_t>(3 * triangle + i % 3), 0, 1};
    }
    const std::size_t room = nodes_per_edge * pieces.size();
    Builder(mesh, nodes_, patience).build(std::move(pieces), 0, room);
    nodes_.shrink_to_fit();
}

}  // namespace liftmesh
