#include "accel/octree/build_octree.h"

#include <array>
#include <utility>

#include "accel/clip_triangle.h"
#include "accel/kd_tree/build_kd_tree.h"
#include "base/error.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

constexpr uint32_t kParallelOctreeNode = 1u << 13; // from this many triangles on, the children of a node are built in
                                                   // parallel

struct OctreePart {
    uint32_t triangle;
    Bounds3 box; // bounds of its part in the cell
};

struct BuildNode {
    OctreeCell cell;
    int levels = 0;      // number of splits that are still allowed below
    uint64_t budget = 0; // maximum number of references of all leaves below
    std::vector<OctreePart> parts;
};

/// A part of the tree with its root at nodes[0]; links are relative to it.
struct Subtree {
    std::vector<OctreeNode> nodes;
    std::vector<uint32_t> references;
    int depth = 0;
};

class OctreeBuilder {
public:
    OctreeBuilder(const std::vector<BvhTriangle>& triangles, const OctreeSettings& settings, const Octree& tree)
        : triangles_(triangles), settings_(settings), corner_(tree.corner), slack_(clip_slack(tree.bounds.max_abs())) {}

    /// Builds a node in out.nodes[slot] and appends its subtree.
    void build(BuildNode&& node, uint32_t slot, int depth, Subtree& out) const {
        const bool parallel = node.parts.size() >= kParallelOctreeNode;
        if (parallel) settings_.sink->check();
        std::array<BuildNode, 8> children;
        if (!split(node, children)) {
            out.depth = max(out.depth, depth);
            out.nodes[slot] = {static_cast<uint32_t>(out.references.size()),
                               kLeafBit | static_cast<uint32_t>(node.parts.size())};
            for (const OctreePart& part : node.parts) out.references.push_back(part.triangle);
            return check_size(out);
        }
        node = {}; // frees memory for the levels below
        const auto first = static_cast<uint32_t>(out.nodes.size());
        uint32_t mask = 0, count = 0;
        for (uint32_t k = 0; k < 8; ++k) {
            if (children[k].parts.empty()) continue;
            mask |= 1u << k;
            ++count;
        }
        out.nodes.resize(first + count);
        out.nodes[slot] = {first, mask};
        if (parallel) return build_at_once(children, first, depth, out);
        uint32_t next = first;
        for (BuildNode& child : children) {
            if (!child.parts.empty()) build(std::move(child), next++, depth + 1, out);
        }
    }

private:
    void build_at_once(std::array<BuildNode, 8>& children, uint32_t first, int depth, Subtree& out) const {
        std::array<Subtree, 8> built;
        parallel_for(8, 1, [&](uint64_t k) {
            if (children[k].parts.empty()) return;
            built[k].nodes.resize(1);
            build(std::move(children[k]), 0, depth + 1, built[k]);
        });
        for (const Subtree& part : built) {
            if (part.nodes.empty()) continue;
            settings_.sink->check();
            const auto offset = static_cast<uint32_t>(out.nodes.size()) - 1; // its nodes[1] goes to nodes.size()
            const auto references = static_cast<uint32_t>(out.references.size());
            for (std::size_t i = 0; i < part.nodes.size(); ++i) {
                OctreeNode n = part.nodes[i];
                n.first += n.is_leaf() ? references : offset;
                if (i == 0) {
                    out.nodes[first++] = n;
                } else {
                    out.nodes.push_back(n);
                }
            }
            out.references.insert(out.references.end(), part.references.begin(), part.references.end());
            out.depth = max(out.depth, part.depth);
            check_size(out);
        }
    }

    /// Splits a node. Returns false if it becomes a leaf.
    bool split(const BuildNode& node, std::array<BuildNode, 8>& children) const {
        if (node.levels == 0 || node.parts.size() <= settings_.max_leaf) return false;
        const Vec3 centre = node.cell.centre(corner_);
        const Bounds3 cell = bounds_of(node.cell, corner_);
        uint64_t held = 0;
        for (std::size_t i = 0; i < node.parts.size(); ++i) {
            settings_.sink->check_at(i + 1);
            held += add_part(node.parts[i], cell, centre, children);
        }
        if (held > node.budget) return false;
        const uint64_t spare = node.budget - held;
        for (uint32_t k = 0; k < 8; ++k) {
            const uint64_t n = children[k].parts.size();
            children[k].cell = node.cell.child(k);
            children[k].levels = node.levels - 1;
            children[k].budget = n + (held == 0 ? 0 : spare / held * n + spare % held * n / held);
        }
        return held > 0;
    }

    /// Cuts a part at the three planes and returns the number of octants that it reaches. A part that lies in a plane
    /// goes below it.
    uint64_t add_part(const OctreePart& part, const Bounds3& cell, Vec3 centre,
                      std::array<BuildNode, 8>& children) const {
        struct Piece {
            uint32_t octant;
            Bounds3 cell;
            Bounds3 box;
        };
        std::array<Piece, 8> pieces = {{{0, cell, part.box}}};
        std::size_t count = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const float plane = component(centre, axis);
            const std::size_t before = count;
            for (std::size_t i = 0; i < before; ++i) {
                Piece& piece = pieces[i];
                const Piece low = {piece.octant, cell_below(piece.cell, axis, plane), piece.box};
                const Piece high = {piece.octant | 1u << axis, cell_above(piece.cell, axis, plane), piece.box};
                if (component(piece.box.hi, axis) <= plane) {
                    piece = low;
                } else if (component(piece.box.lo, axis) >= plane) {
                    piece = high;
                } else {
                    const BvhTriangle& triangle = triangles_[part.triangle];
                    piece = {low.octant, low.cell, clip_triangle(triangle, low.cell, slack_)};
                    pieces[count++] = {high.octant, high.cell, clip_triangle(triangle, high.cell, slack_)};
                }
            }
        }
        uint64_t added = 0;
        for (std::size_t i = 0; i < count; ++i) {
            if (pieces[i].box.is_empty()) continue;
            children[pieces[i].octant].parts.push_back({part.triangle, pieces[i].box});
            ++added;
        }
        return added;
    }

    static void check_size(const Subtree& out) {
        if (out.nodes.size() >= kMaxOctreeNodes || out.references.size() > 0xffffffffu) {
            throw Error(ErrorCode::OverLimit, "the octree has more than 2^31 nodes or 2^32 references");
        }
    }

    const std::vector<BvhTriangle>& triangles_;
    const OctreeSettings& settings_;
    const Vec3 corner_;
    const double slack_;
};

/// Returns the least power of two that is not less than x; x > 0 and normal.
float power_of_two_above(float x) {
    const float below = float_of(bits_of(x) & 0x7f800000u);
    return below < x ? 2 * below : below;
}

/// Sets the root's cell and returns the number of times that it can be halved.
int place_root(Octree& tree) {
    // Cells are no smaller than the margin by which planes move out, and their multiples up to the bounds are floats.
    const float least = power_of_two_above(max(0x1p-19f * tree.bounds.max_abs(), 0x1p-100f));
    const auto down = [&](float x) { return floor(x / least) * least; };
    tree.corner = {down(tree.bounds.lo.x), down(tree.bounds.lo.y), down(tree.bounds.lo.z)};
    tree.side = power_of_two_above(max(max_component(tree.bounds.size()) + least, least));
    // If that sum was rounded down, or the corner moved, the power of two may be slightly too small.
    for (int axis = 0; axis < 3; ++axis) {
        while (component(tree.corner, axis) + tree.side < component(tree.bounds.hi, axis)) tree.side *= 2;
    }
    int levels = 0;
    float side = tree.side;
    while (side > least) side *= 0.5f, ++levels;
    return levels;
}

} // namespace

Octree build_octree(const std::vector<BvhTriangle>& triangles, const OctreeSettings& settings) {
    PERTEV_CHECK(settings.max_depth >= 0 && settings.max_depth <= kMaxOctreeDepth && settings.max_references >= 1);
    if (triangles.size() > kMaxOctreeTriangles) {
        throw Error(ErrorCode::OverLimit, "an octree holds at most 2^30 triangles");
    }
    Octree tree;
    if (triangles.empty()) return tree;
    for (const BvhTriangle& t : triangles) tree.bounds.extend(bounds_of(t));
    BuildNode root;
    root.levels = min(settings.max_depth, place_root(tree));
    root.cell.half = 0.5f * tree.side;
    root.budget = uint64_t(settings.max_references) * triangles.size();
    root.parts.reserve(triangles.size());
    for (uint32_t i = 0; i < triangles.size(); ++i) {
        settings.sink->check_at(i);
        root.parts.push_back({i, bounds_of(triangles[i])});
    }
    Subtree built;
    built.nodes.resize(1);
    OctreeBuilder(triangles, settings, tree).build(std::move(root), 0, 0, built);
    tree.nodes = std::move(built.nodes);
    tree.references = std::move(built.references);
    tree.depth = built.depth;
    tree.triangles = triangles;
    tree.sah_cost = octree_sah_cost(tree, settings.node_cost, settings.triangle_cost, *settings.sink);
    return tree;
}

Bounds3 bounds_of(const OctreeCell& cell, Vec3 corner) {
    const Vec3 centre = cell.centre(corner), half = {cell.half, cell.half, cell.half};
    return {centre - half, centre + half};
}

float octree_sah_cost(const Octree& tree, float node_cost, float triangle_cost, Sink& sink) {
    if (tree.nodes.empty()) return 0;
    const float max_abs = tree.bounds.max_abs();
    struct Pending {
        uint32_t node;
        OctreeCell cell;
    };
    std::vector<Pending> pending = {{0, {0, 0, 0, 0.5f * tree.side}}};
    double cost = 0;
    for (uint64_t visits = 1; !pending.empty(); ++visits) {
        sink.check_at(visits);
        const Pending at = pending.back();
        pending.pop_back();
        const OctreeNode& node = tree.nodes[at.node];
        const Bounds3 box = bounds_of(at.cell, tree.corner);
        const double area = kd_cell_area({max(box.lo, tree.bounds.lo), min(box.hi, tree.bounds.hi)}, max_abs);
        if (node.is_leaf()) {
            cost += area * static_cast<double>(triangle_cost) * node.count();
            continue;
        }
        cost += area * static_cast<double>(node_cost);
        for (uint32_t k = 0; k < 8; ++k) {
            if (node.has_child(k)) pending.push_back({node.child(k), at.cell.child(k)});
        }
    }
    const double whole = kd_cell_area(tree.bounds, max_abs);
    return whole > 0 ? static_cast<float>(cost / whole) : static_cast<float>(tree.triangles.size()) * triangle_cost;
}

} // namespace pertev
