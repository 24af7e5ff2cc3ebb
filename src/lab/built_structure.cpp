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

/// kd-trees and the octree have no such builder.
BvhBuilder builder_of(StructureKind kind) {
    switch (kind) {
    case StructureKind::Binned:
        return BvhBuilder::Binned;
    case StructureKind::Sweep:
        return BvhBuilder::Sweep;
    case StructureKind::Median:
        return BvhBuilder::Median;
    case StructureKind::EqualCounts:
        return BvhBuilder::EqualCounts;
    case StructureKind::SpatialSplits:
        return BvhBuilder::SpatialSplits;
    case StructureKind::Ploc:
        return BvhBuilder::Ploc;
    case StructureKind::Insertion:
        return BvhBuilder::Insertion;
    case StructureKind::Reinsertion:
        return BvhBuilder::Reinsertion;
    case StructureKind::KdMedian:
    case StructureKind::KdSah:
    case StructureKind::Octree:
        break;
    }
    throw Error(ErrorCode::BadInput, fmt::format("{} is not a binary hierarchy", name_of(kind)));
}

const char* suffix_of(TreeLayout layout) {
    switch (layout) {
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

/// A tree's triangles without the tree.
struct TriangleArray {
    std::vector<BvhNode> nodes; // none
    std::vector<BvhTriangle> triangles;
};
TriangleArrayView view_of(const TriangleArray& array) {
    return {array.triangles.data(), static_cast<uint32_t>(array.triangles.size())};
}

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}

} // namespace

TreeLayout layout_of(WalkKind walk) {
    switch (walk) {
    case WalkKind::BruteForce:
        return TreeLayout::Triangles;
    case WalkKind::IfIf:
    case WalkKind::WhileWhile:
    case WalkKind::Speculative:
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
    const BvhBuilder builder = builder_of(kind);
    const Stopwatch watch;
    BinaryTrees trees;
    for (std::size_t part = 0; part <= triangles.meshes.size(); ++part) {
        trees.parts.push_back(build_bvh(builder, part_of(triangles, part)));
        add_parent_links(trees.parts.back());
    }
    trees.build_s = watch.seconds();
    return trees;
}

template <class T>
const T* BuiltStructure::keep(Queue& queue, std::span<const T> values, const std::string& name) {
    if (values.empty()) return nullptr;
    buffers_.emplace_back(queue, std::as_bytes(values), name);
    return reinterpret_cast<const T*>(buffers_.back().data());
}

/// The view of the tree where the queue's device can read it.
template <class Tree>
auto BuiltStructure::place(Queue& queue, const Tree& tree) {
    auto view = view_of(tree);
    if (!queue.is_cuda()) return view;
    if constexpr (requires { view.nodes; }) {
        view.nodes = keep(queue, std::span(tree.nodes), figures_.name + " nodes");
    }
    view.triangles = keep(queue, std::span(tree.triangles), figures_.name + " triangles");
    if constexpr (requires { tree.references; }) {
        view.references = keep(queue, std::span(tree.references), figures_.name + " references");
    }
    return view;
}

template <class Make>
void BuiltStructure::fill(Queue& queue, const LabTriangles& triangles, const Make& make) {
    using Tree = std::remove_cvref_t<decltype(make(std::size_t(0)))>;
    using View = decltype(view_of(std::declval<const Tree&>()));
    const auto host = std::make_shared<std::vector<Tree>>();
    const Stopwatch watch;
    for (std::size_t part = 0; part <= triangles.meshes.size(); ++part) host->push_back(make(part));
    figures_.build_s += watch.seconds();

    std::size_t largest = 0; // the tree whose cost and depth stand for all
    std::vector<View> meshes;
    SceneTrees<View> scene;
    for (std::size_t part = 0; part < host->size(); ++part) {
        const Tree& tree = (*host)[part];
        figures_.nodes += tree.nodes.size();
        figures_.triangles += tree.triangles.size();
        figures_.bytes += bytes_of(tree.nodes) + bytes_of(tree.triangles);
        if constexpr (requires { tree.references; }) {
            figures_.bytes += bytes_of(tree.references);
            figures_.triangles += tree.references.size() - tree.triangles.size();
        }
        if constexpr (requires { tree.sah_cost, tree.depth; }) {
            if (part == 0 || tree.triangles.size() > largest) {
                largest = tree.triangles.size();
                figures_.sah_cost = static_cast<double>(tree.sah_cost);
                figures_.depth = tree.depth;
            }
        }
        (part == 0 ? scene.baked : meshes.emplace_back()) = place(queue, tree);
    }
    scene.meshes = keep(queue, std::span<const View>(meshes), "mesh trees");
    scene.top_nodes = keep(queue, std::span(triangles.top_level.nodes), "top level nodes");
    scene.instances = keep(queue, std::span(triangles.top_level.instances), "top level instances");
    scene.top_root = triangles.top_level.root;
    scene.top_reach = triangles.top_level.reach;
    scene.top_growth = triangles.top_level.growth;
    trees_ = scene;
    if (!queue.is_cuda()) host_ = host;
}

BuiltStructure::BuiltStructure(Queue& queue, const LabTriangles& triangles, StructureKind kind, TreeLayout layout,
                               const BinaryTrees* binary) {
    figures_.name = std::string(name_of(kind)) + suffix_of(layout);
    if (layout == TreeLayout::Kd) {
        const KdTreeSettings settings = {.split = kind == StructureKind::KdSah ? KdSplit::Sah : KdSplit::SpatialMedian};
        fill(queue, triangles, [&](std::size_t part) { return build_kd_tree(part_of(triangles, part), settings); });
        return;
    }
    if (layout == TreeLayout::Octree) {
        fill(queue, triangles, [&](std::size_t part) { return build_octree(part_of(triangles, part)); });
        return;
    }
    PERTEV_CHECK(binary != nullptr);
    figures_.build_s = binary->build_s;
    const std::vector<Bvh>& parts = binary->parts;
    switch (layout) {
    case TreeLayout::Triangles:
        fill(queue, triangles, [&](std::size_t part) { return TriangleArray{{}, parts[part].triangles}; });
        break;
    case TreeLayout::Binary:
        fill(queue, triangles, [&](std::size_t part) { return parts[part]; });
        break;
    case TreeLayout::Skip:
        fill(queue, triangles, [&](std::size_t part) { return make_skip_bvh(parts[part]); });
        break;
    case TreeLayout::Wide4:
        fill(queue, triangles, [&](std::size_t part) { return make_wide_bvh<4>(parts[part]); });
        break;
    case TreeLayout::Wide8:
        fill(queue, triangles, [&](std::size_t part) { return make_wide_bvh<8>(parts[part]); });
        break;
    case TreeLayout::Compressed:
        fill(queue, triangles, [&](std::size_t part) { return make_compressed_bvh(parts[part]); });
        break;
    case TreeLayout::Kd:
    case TreeLayout::Octree:
        break;
    }
}

} // namespace pertev
