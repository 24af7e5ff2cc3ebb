#include "tests/support/check_bvh.h"

#include <algorithm>
#include <span>
#include <tuple>

#include <fmt/format.h>

#include "accel/bvh/check_bvh.h"
#include "tests/support/check_cells.h"

namespace pertev {
namespace {

/// A triangle in a leaf.
struct Piece {
    const BvhTriangle* triangle;
    Bounds3 leaf_box;
};

/// Finds every triangle of every leaf. Returns a broken link, or a box outside its parent's, or nothing.
std::optional<std::string> find_pieces(const Bvh& bvh, std::vector<Piece>& pieces) {
    if (auto fault = find_broken_link(bvh)) return fault;
    struct Pending {
        uint32_t link;
        Bounds3 box;
    };
    std::vector<Pending> pending;
    if (bvh.root != kNoLink) pending.push_back({bvh.root, bvh.bounds});
    while (!pending.empty()) {
        const Pending at = pending.back();
        pending.pop_back();
        if (at.link & kLeafBit) {
            uint32_t i = at.link & ~kLeafBit;
            do pieces.push_back({&bvh.triangles[i], at.box});
            while (!(bvh.triangles[i++].flags & kLastInLeaf));
            continue;
        }
        for (int k = 0; k < 2; ++k) {
            const Bounds3 box = child_bounds(bvh.nodes[at.link], k);
            if (!holds(at.box, box)) return fmt::format("node {} has child {} outside it", at.link, k);
            pending.push_back({bvh.nodes[at.link].child[k], box});
        }
    }
    return std::nullopt;
}

/// Sort key that makes copies of a triangle adjacent, independent of their flags.
auto identity_of(const BvhTriangle& t) {
    return std::tuple(t.instance, t.primitive, t.a.x, t.a.y, t.a.z, t.b.x, t.b.y, t.b.z, t.c.x, t.c.y, t.c.z);
}

/// Returns whether the point with barycentric weights (i, k, n - i - k) / n lies in one of the pieces' boxes.
bool covers(std::span<const Piece> pieces, const BvhTriangle& t, int i, int k, int n, double slack) {
    const double wa = static_cast<double>(i) / n, wb = static_cast<double>(k) / n,
                 wc = static_cast<double>(n - i - k) / n;
    double p[3];
    for (int axis = 0; axis < 3; ++axis) {
        p[axis] = wa * static_cast<double>(component(t.a, axis)) + wb * static_cast<double>(component(t.b, axis)) +
                  wc * static_cast<double>(component(t.c, axis));
    }
    return std::any_of(pieces.begin(), pieces.end(), [&](const Piece& piece) {
        for (int axis = 0; axis < 3; ++axis) {
            if (p[axis] < static_cast<double>(component(piece.leaf_box.lo, axis)) - slack ||
                p[axis] > static_cast<double>(component(piece.leaf_box.hi, axis)) + slack) {
                return false;
            }
        }
        return true;
    });
}

bool covers(std::span<const Piece> pieces, const BvhTriangle& t) {
    const Bounds3 box = {min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c)};
    const double slack = 0x1p-50 * static_cast<double>(box.max_abs());
    const int n = static_cast<int>(std::min<std::size_t>(4 + 4 * pieces.size(), 60));
    for (int i = 0; i <= n; ++i) {
        for (int k = 0; k <= n - i; ++k) {
            if (!covers(pieces, t, i, k, n, slack)) return false;
        }
    }
    return true;
}

} // namespace

std::optional<std::string> find_fault(const Bvh& bvh) {
    std::vector<Piece> pieces;
    if (auto fault = find_pieces(bvh, pieces)) return fault;
    for (const Piece& piece : pieces) {
        if (!holds(piece.leaf_box, bounds_of(*piece.triangle))) {
            return fmt::format("triangle {} is outside its leaf", piece.triangle - bvh.triangles.data());
        }
    }
    return std::nullopt;
}

std::optional<std::string> find_split_fault(const Bvh& bvh, const std::vector<BvhTriangle>& mesh) {
    std::vector<Piece> pieces;
    if (auto fault = find_pieces(bvh, pieces)) return fault;
    std::sort(pieces.begin(), pieces.end(),
              [](const Piece& a, const Piece& b) { return identity_of(*a.triangle) < identity_of(*b.triangle); });
    std::vector<const BvhTriangle*> wanted;
    for (const BvhTriangle& t : mesh) wanted.push_back(&t);
    std::sort(wanted.begin(), wanted.end(),
              [](const BvhTriangle* a, const BvhTriangle* b) { return identity_of(*a) < identity_of(*b); });
    auto first = pieces.cbegin();
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        const auto identity = identity_of(*wanted[i]);
        if (i > 0 && identity == identity_of(*wanted[i - 1])) continue; // the mesh contains the triangle twice
        const auto last = std::find_if(first, pieces.cend(),
                                       [&](const Piece& piece) { return identity_of(*piece.triangle) != identity; });
        const BvhTriangle& t = *wanted[i];
        if (first == last) {
            return fmt::format("primitive {} of instance {} is left out, or one is that is not the mesh's", t.primitive,
                               t.instance);
        }
        if (!covers({first, last}, t)) {
            return fmt::format("primitive {} of instance {} is not covered by its {} leaves", t.primitive, t.instance,
                               last - first);
        }
        first = last;
    }
    if (first != pieces.cend()) {
        return fmt::format("primitive {} of instance {} is not the mesh's", first->triangle->primitive,
                           first->triangle->instance);
    }
    return std::nullopt;
}

} // namespace pertev
