#include "accel/bvh/check_bvh.h"

#include <vector>

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

class Checker {
public:
    Checker(const Bvh& bvh, bool boxes) : bvh_(bvh), boxes_(boxes) {}

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
                if (boxes_ && !holds(at.box, box)) return fmt::format("node {} has child {} outside it", at.link, k);
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
            if (boxes_ && !(holds(at.box, t.a) && holds(at.box, t.b) && holds(at.box, t.c))) {
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
    const bool boxes_;
    std::vector<bool> node_seen_, triangle_seen_;
    std::size_t nodes_ = 0, triangles_ = 0;
    std::string fault_;
};

} // namespace

std::optional<std::string> find_broken_link(const Bvh& bvh) { return Checker(bvh, false).run(); }

std::optional<std::string> find_fault(const Bvh& bvh) { return Checker(bvh, true).run(); }

} // namespace pertev
