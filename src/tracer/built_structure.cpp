#include "tracer/built_structure.h"

#include <algorithm>

#include "accel/bvh/parent_links.h"
#include "accel/kd_tree/build_kd_tree.h"
#include "accel/octree/build_octree.h"
#include "base/error.h"
#include "base/huge_pages.h"
#include "base/stopwatch.h"
#include "tracer/hploc/device_builder.h"

namespace pertev {
namespace {

/// Suffixes of a structure's name for layouts other than its builder's usual one.
constexpr ValueName<TreeLayout> kSuffixes[] = {{TreeLayout::Woop, " woop"},
                                               {TreeLayout::Skip, " skip links"},
                                               {TreeLayout::Wide4, " wide4"},
                                               {TreeLayout::Wide8, " wide8"},
                                               {TreeLayout::Wide8Simd, " wide8 simd"},
                                               {TreeLayout::Compressed, " compressed"},
                                               {TreeLayout::Triangles, " triangles"},
                                               {TreeLayout::Linked, " parent links"}};

} // namespace

TreeLayout layout_of(const Combination& combination) {
    switch (combination.traversal) {
    case TraversalKind::BruteForce:
        return TreeLayout::Triangles;
    case TraversalKind::WhileWhile:
    case TraversalKind::Speculative:
    case TraversalKind::Octants:
        return combination.options.tests == TestKind::Woop ? TreeLayout::Woop : TreeLayout::Binary;
    case TraversalKind::IfIf:
    case TraversalKind::RestartTrail:
    case TraversalKind::ShortStack:
    case TraversalKind::Packet:
        return TreeLayout::Binary;
    case TraversalKind::ParentLinks:
        return TreeLayout::Linked;
    case TraversalKind::SkipLinks:
        return TreeLayout::Skip;
    case TraversalKind::Wide4:
        return TreeLayout::Wide4;
    case TraversalKind::Wide8:
        return TreeLayout::Wide8;
    case TraversalKind::Wide8Simd:
        return TreeLayout::Wide8Simd;
    case TraversalKind::Compressed:
        return TreeLayout::Compressed;
    case TraversalKind::Kd:
        return TreeLayout::Kd;
    case TraversalKind::Octree:
        return TreeLayout::Octree;
    }
    return TreeLayout::Binary;
}

void BuiltStructure::list_bytes(std::span<const std::byte> bytes) {
    if (bytes.empty()) return;
    arrays_.push_back({bytes, device_bytes_});
    offsets_.emplace(bytes.data(), device_bytes_);
    constexpr std::size_t kAlignment = 256;
    device_bytes_ += (bytes.size() + kAlignment - 1) / kAlignment * kAlignment;
}

template <class T>
void BuiltStructure::list(const std::vector<T>& values) {
    list_bytes(std::as_bytes(std::span(values)));
    figures_.bytes += values.size() * sizeof(T);
}

template <class Tree, class ViewOf>
void BuiltStructure::take(const Tlas& tlas, const std::vector<std::shared_ptr<const Tree>>& parts,
                          const ViewOf& view_of_part) {
    using View = decltype(view_of_part(*parts.front()));
    std::size_t largest = 0; // the tree whose cost and depth are reported
    const auto meshes = std::make_shared<std::vector<View>>();
    SceneTrees<View> scene;
    for (std::size_t part = 0; part < parts.size(); ++part) {
        const Tree& tree = *parts[part];
        const View view = view_of_part(tree);
        if constexpr (requires { view.nodes; }) {
            figures_.nodes += tree.nodes.size();
            list(tree.nodes);
        }
        figures_.triangles += tree.triangles.size();
        list(tree.triangles);
        if constexpr (requires { tree.references; }) {
            figures_.triangles += tree.references.size() - tree.triangles.size();
            list(tree.references);
        }
        if constexpr (requires { tree.transforms; }) list(tree.transforms);
        if constexpr (requires { tree.sah_cost, tree.depth; }) {
            if (part == 0 || tree.triangles.size() > largest) {
                largest = tree.triangles.size();
                figures_.sah_cost = static_cast<double>(tree.sah_cost);
                figures_.depth = tree.depth;
            }
        }
        if (part == 0) {
            scene.baked = view;
        } else {
            meshes->push_back(view);
        }
    }
    const auto top = std::make_shared<const Tlas>(tlas);
    list_bytes(std::as_bytes(std::span(*meshes)));
    list_bytes(std::as_bytes(std::span(top->nodes)));
    list_bytes(std::as_bytes(std::span(top->instances)));
    scene.blases = meshes->data();
    scene.tlas_nodes = top->nodes.data();
    scene.instances = top->instances.data();
    scene.tlas_root = top->root;
    scene.tlas_reach = top->reach;
    scene.tlas_growth = top->growth;
    has_instances_ = !top->instances.empty();
    trees_ = scene;
    parts_.assign(parts.begin(), parts.end());
    memory_ = {meshes, top};
}

/// Builds and times each part's tree, except for parts that did not change.
template <class Make>
void BuiltStructure::build(const Tlas& tlas, std::size_t count, const Before* before, const Make& make) {
    using Tree = std::remove_cvref_t<decltype(make(std::size_t(0)))>;
    std::vector<std::shared_ptr<const Tree>> parts;
    const Stopwatch watch;
    for (std::size_t part = 0; part < count; ++part) {
        if (before != nullptr && before->changes[part] == PartChange::None) {
            parts.push_back(std::static_pointer_cast<const Tree>(before->structure.parts_[part]));
        } else {
            parts.push_back(std::make_shared<const Tree>(make(part)));
        }
    }
    figures_.build_s += watch.seconds();
    take<Tree>(tlas, parts, [](const Tree& tree) { return view_of(tree); });
}

namespace {

/// Returns the eight-wide tree that one thread's vector instructions test.
WideBvh<kWideChildren> make_simd_bvh(const Bvh& bvh, Sink& sink) {
    WideBvh<kWideChildren> wide = make_wide_bvh<kWideChildren>(bvh, kSimdCollapse, sink);
    use_huge_pages(std::as_bytes(std::span(wide.nodes)), sink);
    use_huge_pages(std::as_bytes(std::span(wide.triangles)), sink);
    return wide;
}

} // namespace

BuiltStructure::BuiltStructure(const Tlas& tlas, StructureKind kind, TreeLayout layout, const BinaryTrees& trees,
                               const Before* before, Sink& sink) {
    figures_.name = name_of(kind);
    for (const auto& [value, suffix] : kSuffixes) {
        if (value == layout) figures_.name += suffix;
    }
    figures_.build_s = trees.build_s;
    const std::vector<std::shared_ptr<const Bvh>>& parts = trees.parts;
    const auto convert = [&](const auto& make) {
        build(tlas, parts.size(), before, [&](std::size_t part) { return make(*parts[part]); });
    };
    switch (layout) {
    case TreeLayout::Triangles:
        take<Bvh>(tlas, parts, triangle_array_of);
        figures_.sah_cost.reset(), figures_.depth.reset(); // these belong to the tree, which is not traversed
        break;
    case TreeLayout::Binary:
        take<Bvh>(tlas, parts, [](const Bvh& bvh) { return view_of(bvh); });
        break;
    case TreeLayout::Linked:
        convert([&](Bvh bvh) {
            add_parent_links(bvh, sink);
            return bvh;
        });
        break;
    case TreeLayout::Skip: {
        convert([&](const Bvh& bvh) { return make_skip_bvh(bvh, sink); });
        const Bvh& largest =
            **std::ranges::max_element(parts, {}, [](const auto& bvh) { return bvh->triangles.size(); });
        figures_.sah_cost = static_cast<double>(largest.sah_cost),
        figures_.depth = largest.depth; // both from the same tree
        break;
    }
    case TreeLayout::Woop:
        convert([&](const Bvh& bvh) { return make_woop_bvh(bvh, sink); });
        break;
    case TreeLayout::Wide4:
        convert([&](const Bvh& bvh) { return make_wide_bvh<4>(bvh, {}, sink); });
        break;
    case TreeLayout::Wide8:
        convert([&](const Bvh& bvh) { return make_wide_bvh<8>(bvh, {}, sink); });
        break;
    case TreeLayout::Wide8Simd:
        convert([&](const Bvh& bvh) { return make_simd_bvh(bvh, sink); });
        break;
    case TreeLayout::Compressed:
        if (kind == StructureKind::Hploc) { // H-PLOC builds the compressed tree directly, as on a GPU, not from its
                                            // binary tree
            Queue queue = Queue::make_cpu();
            figures_.build_s = 0;
            convert([&](const Bvh& bvh) { return build_compressed_bvh(queue, bvh.triangles, sink); });
            break;
        }
        convert([&](const Bvh& bvh) { return make_compressed_bvh(bvh, kCompressedCollapse, sink); });
        break;
    case TreeLayout::Kd:
    case TreeLayout::Octree:
        PERTEV_CHECK(false); // these kinds are not made from binary trees
    }
}

BuiltStructure::BuiltStructure(const Tlas& tlas, StructureKind kind, const SceneTriangles& triangles,
                               const Before* before, Sink& sink) {
    figures_.name = std::string(name_of(kind));
    if (kind == StructureKind::Octree) {
        build(tlas, triangles.parts(), before,
              [&](std::size_t part) { return build_octree(triangles.part(part), {.sink = &sink}); });
    } else {
        const KdSplit split = kind == StructureKind::KdSah ? KdSplit::Sah : KdSplit::SpatialMedian;
        const KdTreeSettings settings = {.split = split, .sink = &sink};
        build(tlas, triangles.parts(), before,
              [&](std::size_t part) { return build_kd_tree(triangles.part(part), settings); });
    }
}

std::optional<std::size_t> BuiltStructure::offset_of(const void* on_host) const {
    const auto at = offsets_.find(on_host);
    return at != offsets_.end() ? std::optional(at->second) : std::nullopt;
}

} // namespace pertev
