#include "lab/built_structure.h"

#include <algorithm>

#include <fmt/format.h>

#include "accel/bvh/builders.h"
#include "accel/bvh/parent_links.h"
#include "accel/kd_tree/build_kd_tree.h"
#include "accel/octree/build_octree.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "render/place_meshes.h"

namespace pertev {
namespace {

const char* suffix_of(TreeLayout layout) {
    switch (layout) {
    case TreeLayout::Woop:
        return " woop";
    case TreeLayout::Skip:
        return " skip links";
    case TreeLayout::Wide4:
        return " wide4";
    case TreeLayout::Wide8:
        return " wide8";
    case TreeLayout::Compressed:
        return " compressed";
    case TreeLayout::Triangles:
        return " triangles";
    case TreeLayout::Binary:
    case TreeLayout::Kd:
    case TreeLayout::Octree:
        break;
    }
    return "";
}

const std::vector<BvhTriangle>& part_of(const LabTriangles& triangles, std::size_t part) {
    return part == 0 ? triangles.baked : triangles.meshes[part - 1];
}

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}

} // namespace

TreeLayout layout_of(const Combination& combination) {
    switch (combination.walk) {
    case WalkKind::BruteForce:
        return TreeLayout::Triangles;
    case WalkKind::WhileWhile:
    case WalkKind::Speculative:
        return combination.options.tests == TestKind::Woop ? TreeLayout::Woop : TreeLayout::Binary;
    case WalkKind::IfIf:
    case WalkKind::RestartTrail:
    case WalkKind::ShortStack:
    case WalkKind::ParentLinks:
    case WalkKind::Packet:
        return TreeLayout::Binary;
    case WalkKind::SkipLinks:
        return TreeLayout::Skip;
    case WalkKind::Wide4:
        return TreeLayout::Wide4;
    case WalkKind::Wide8:
    case WalkKind::Wide8Simd:
        return TreeLayout::Wide8;
    case WalkKind::Compressed:
        return TreeLayout::Compressed;
    case WalkKind::Kd:
        return TreeLayout::Kd;
    case WalkKind::Octree:
        return TreeLayout::Octree;
    }
    return TreeLayout::Binary;
}

LabTriangles::LabTriangles(const Scene& scene) {
    const MeshPlacement placement = place_meshes(scene);
    baked = baked_triangles(scene, placement);
    meshes.resize(placement.mesh_tree_count);
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        if (placement.tree_of_mesh[i] != kBakedMesh) {
            meshes[placement.tree_of_mesh[i]] = mesh_triangles(scene.meshes[i]);
        }
    }
    std::vector<Bounds3> bounds(meshes.size());
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        for (const BvhTriangle& t : meshes[i]) {
            bounds[i].extend(t.a), bounds[i].extend(t.b), bounds[i].extend(t.c);
        }
    }
    top_level = build_top_level_bvh(placed_trees(scene, placement, bounds));
}

uint64_t LabTriangles::count() const {
    uint64_t count = baked.size();
    for (const auto& mesh : meshes) count += mesh.size();
    return count;
}

BinaryTrees build_binary_trees(const LabTriangles& triangles, StructureKind kind) {
    const auto builder = builder_of(kind);
    PERTEV_CHECK(builder.has_value());
    const auto parts = std::make_shared<std::vector<Bvh>>();
    const Stopwatch watch;
    for (std::size_t part = 0; part <= triangles.meshes.size(); ++part) {
        parts->push_back(build_bvh(*builder, part_of(triangles, part)));
    }
    const double build_s = watch.seconds();
    for (Bvh& bvh : *parts) add_parent_links(bvh);
    return {parts, build_s};
}

template <class T>
const T* BuiltStructure::keep(Queue& queue, std::span<const T> values, const std::string& name) {
    if (values.empty()) return nullptr;
    buffers_.emplace_back(queue, std::as_bytes(values), name);
    return reinterpret_cast<const T*>(buffers_.back().data());
}

/// The view of the tree, where the queue's device can read it.
template <class Tree, class View>
View BuiltStructure::place(Queue& queue, const Tree& tree, View view) {
    if (!queue.is_cuda()) return view;
    if constexpr (requires { view.nodes; }) {
        view.nodes = keep(queue, std::span(tree.nodes), figures_.name + " nodes");
    }
    view.triangles = keep(queue, std::span(tree.triangles), figures_.name + " triangles");
    if constexpr (requires { tree.references; }) {
        view.references = keep(queue, std::span(tree.references), figures_.name + " references");
    }
    if constexpr (requires { tree.transforms; }) {
        view.transforms = keep(queue, std::span(tree.transforms), figures_.name + " transforms");
    }
    return view;
}

template <class Tree, class ViewOf>
void BuiltStructure::take(Queue& queue, const LabTriangles& triangles, std::shared_ptr<const std::vector<Tree>> parts,
                          const ViewOf& view_of_part) {
    using View = decltype(view_of_part(parts->front()));
    std::size_t largest = 0; // the tree whose cost and depth stand for all
    std::vector<View> meshes;
    SceneTrees<View> scene;
    for (std::size_t part = 0; part < parts->size(); ++part) {
        const Tree& tree = (*parts)[part];
        View view = view_of_part(tree);
        if constexpr (requires { view.nodes; }) {
            figures_.nodes += tree.nodes.size();
            figures_.bytes += bytes_of(tree.nodes);
        }
        figures_.triangles += tree.triangles.size();
        figures_.bytes += bytes_of(tree.triangles);
        if constexpr (requires { tree.references; }) {
            figures_.bytes += bytes_of(tree.references);
            figures_.triangles += tree.references.size() - tree.triangles.size();
        }
        if constexpr (requires { tree.transforms; }) figures_.bytes += bytes_of(tree.transforms);
        if constexpr (requires { tree.sah_cost, tree.depth; }) {
            if (part == 0 || tree.triangles.size() > largest) {
                largest = tree.triangles.size();
                figures_.sah_cost = static_cast<double>(tree.sah_cost);
                figures_.depth = tree.depth;
            }
        }
        (part == 0 ? scene.baked : meshes.emplace_back()) = place(queue, tree, view);
    }
    scene.meshes = keep(queue, std::span<const View>(meshes), "mesh trees");
    scene.top_nodes = keep(queue, std::span(triangles.top_level.nodes), "top level nodes");
    scene.instances = keep(queue, std::span(triangles.top_level.instances), "top level instances");
    scene.top_root = triangles.top_level.root;
    scene.top_reach = triangles.top_level.reach;
    scene.top_growth = triangles.top_level.growth;
    trees_ = scene;
    if (!queue.is_cuda()) host_ = parts;
}

/// Makes each part's tree, timed.
template <class Make>
void BuiltStructure::build(Queue& queue, const LabTriangles& triangles, const Make& make) {
    using Tree = std::remove_cvref_t<decltype(make(std::size_t(0)))>;
    const auto parts = std::make_shared<std::vector<Tree>>();
    const Stopwatch watch;
    for (std::size_t part = 0; part <= triangles.meshes.size(); ++part) parts->push_back(make(part));
    figures_.build_s += watch.seconds();
    take<Tree>(queue, triangles, parts, [](const Tree& tree) { return view_of(tree); });
}

void BuiltStructure::convert(Queue& queue, const LabTriangles& triangles, TreeLayout layout,
                             const BinaryTrees& binary) {
    figures_.build_s = binary.build_s;
    const std::vector<Bvh>& parts = *binary.parts;
    switch (layout) {
    case TreeLayout::Triangles:
        take<Bvh>(queue, triangles, binary.parts, triangle_array_of);
        figures_.sah_cost.reset(), figures_.depth.reset(); // are the tree's, which is not walked
        break;
    case TreeLayout::Binary:
        take<Bvh>(queue, triangles, binary.parts, [](const Bvh& bvh) { return view_of(bvh); });
        break;
    case TreeLayout::Skip: {
        build(queue, triangles, [&](std::size_t part) { return make_skip_bvh(parts[part]); });
        const Bvh& largest = *std::ranges::max_element(parts, {}, [](const Bvh& bvh) { return bvh.triangles.size(); });
        figures_.sah_cost = static_cast<double>(largest.sah_cost), figures_.depth = largest.depth; // the same tree
        break;
    }
    case TreeLayout::Woop:
        build(queue, triangles, [&](std::size_t part) { return make_woop_bvh(parts[part]); });
        break;
    case TreeLayout::Wide4:
        build(queue, triangles, [&](std::size_t part) { return make_wide_bvh<4>(parts[part]); });
        break;
    case TreeLayout::Wide8:
        build(queue, triangles, [&](std::size_t part) { return make_wide_bvh<8>(parts[part]); });
        break;
    case TreeLayout::Compressed:
        build(queue, triangles, [&](std::size_t part) { return make_compressed_bvh(parts[part]); });
        break;
    case TreeLayout::Kd:
    case TreeLayout::Octree:
        break; // are not made of binary trees
    }
}

BuiltStructure::BuiltStructure(Queue& queue, const LabTriangles& triangles, StructureKind kind, TreeLayout layout,
                               const BinaryTrees* binary) {
    figures_.name = std::string(name_of(kind)) + suffix_of(layout);
    if (layout == TreeLayout::Kd) {
        const KdTreeSettings settings = {.split = kind == StructureKind::KdSah ? KdSplit::Sah : KdSplit::SpatialMedian};
        build(queue, triangles, [&](std::size_t part) { return build_kd_tree(part_of(triangles, part), settings); });
    } else if (layout == TreeLayout::Octree) {
        build(queue, triangles, [&](std::size_t part) { return build_octree(part_of(triangles, part)); });
    } else {
        PERTEV_CHECK(binary != nullptr);
        convert(queue, triangles, layout, *binary);
    }
}

} // namespace pertev
