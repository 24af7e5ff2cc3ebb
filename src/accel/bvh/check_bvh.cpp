#include "accel/bvh/check_bvh.h"

#include <algorithm>
#include <span>
#include <tuple>

#include <fmt/format.h>

#include "base/limits.h"

namespace pertev {
namespace {

bool holds(const Bounds3& box, Vec3 p) {
    return box.lo.x <= p.x && p.x <= box.hi.x && box.lo.y <= p.y && p.y <= box.hi.y && box.lo.z <= p.z &&
           p.z <= box.hi.z;
}
bool holds(const Bounds3& box, const Bounds3& inner) {
    return inner.is_empty() || (holds(box, inner.lo) && holds(box, inner.hi));
}

enum class Boxes {
    Any,     // not checked
    Nested,  // each lies within its parent's box
    Holding, // nested, and triangles lie within their leaf's box
};

/// A triangle in a leaf.
struct Piece {
    const BvhTriangle* triangle;
    Bounds3 leaf_box;
};

class BvhChecker {
public:
    BvhChecker(const Bvh& bvh, Boxes boxes) : bvh_(bvh), boxes_(boxes) {}

    std::optional<std::string> run() {
        if (bvh_.root == kNoLink) {
            if (!bvh_.nodes.empty() || !bvh_.triangles.empty()) return "no root, but nodes or triangles";
            return std::nullopt;
        }
        node_seen_.resize(bvh_.nodes.size());
        triangle_seen_.resize(bvh_.triangles.size());
        std::vector<Pending> pending = {{bvh_.root, 0, bvh_.bounds}};
        int depth = 0;
        while (!pending.empty()) {
            const Pending at = pending.back();
            pending.pop_back();
            depth = std::max(depth, at.depth);
            if (at.link & kLeafBit) {
                if (!check_leaf(at)) return fault_;
                continue;
            }
            if (at.link >= bvh_.nodes.size()) return fmt::format("a link to node {} of {}", at.link, bvh_.nodes.size());
            if (node_seen_[at.link]) return fmt::format("node {} is reached twice", at.link);
            node_seen_[at.link] = true;
            ++nodes_;
            if (at.depth >= kMaxBvhDepth) return fmt::format("node {} is deeper than {}", at.link, kMaxBvhDepth);
            for (int k = 0; k < 2; ++k) {
                const Bounds3 box = child_bounds(bvh_.nodes[at.link], k);
                if (boxes_ != Boxes::Any && !holds(at.box, box))
                    return fmt::format("node {} has child {} outside it", at.link, k);
                pending.push_back({bvh_.nodes[at.link].child[k], at.depth + 1, box});
            }
        }
        if (nodes_ != bvh_.nodes.size()) return fmt::format("{} of {} nodes are reached", nodes_, bvh_.nodes.size());
        if (triangles_ != bvh_.triangles.size()) {
            return fmt::format("{} of {} triangles are reached", triangles_, bvh_.triangles.size());
        }
        if (depth != bvh_.depth) return fmt::format("depth {}, stated {}", depth, bvh_.depth);
        return std::nullopt;
    }

    /// Returns every triangle of every leaf, after the tree has passed.
    std::vector<Piece> take_pieces() { return std::move(pieces_); }

private:
    struct Pending {
        uint32_t link;
        int depth;
        Bounds3 box;
    };

    bool check_leaf(const Pending& at) {
        if (at.link == kNoLink) return fail("an inner node links to nothing");
        for (uint64_t i = at.link & ~kLeafBit;; ++i) {
            if (i >= bvh_.triangles.size()) return fail(fmt::format("a leaf runs past triangle {}", i));
            if (triangle_seen_[i]) return fail(fmt::format("triangle {} is reached twice", i));
            triangle_seen_[i] = true;
            ++triangles_;
            const BvhTriangle& t = bvh_.triangles[i];
            if (boxes_ == Boxes::Nested) pieces_.push_back({&t, at.box});
            if (boxes_ == Boxes::Holding && !(holds(at.box, t.a) && holds(at.box, t.b) && holds(at.box, t.c))) {
                return fail(fmt::format("triangle {} is outside its leaf", i));
            }
            if (t.flags & kLastInLeaf) return true;
        }
    }

    bool fail(std::string text) {
        fault_ = std::move(text);
        return false;
    }

    const Bvh& bvh_;
    const Boxes boxes_;
    std::vector<bool> node_seen_, triangle_seen_;
    std::size_t nodes_ = 0, triangles_ = 0;
    std::vector<Piece> pieces_;
    std::string fault_;
};

/// Sort key that makes copies of a triangle neighbours, whatever their flags.
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

std::optional<std::string> find_broken_link(const Bvh& bvh) { return BvhChecker(bvh, Boxes::Any).run(); }

std::optional<std::string> find_fault(const Bvh& bvh) { return BvhChecker(bvh, Boxes::Holding).run(); }

std::optional<std::string> find_split_fault(const Bvh& bvh, const std::vector<BvhTriangle>& mesh) {
    BvhChecker checker(bvh, Boxes::Nested);
    if (auto fault = checker.run()) return fault;
    std::vector<Piece> pieces = checker.take_pieces();
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
