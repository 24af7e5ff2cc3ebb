#pragma once

// One structure over a scene's triangles in the layout that a walk reads: built on the host, and placed in the memory
// of the device that it will be walked on.

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

#include "accel/bvh/compressed_bvh.h"
#include "accel/bvh/skip_bvh.h"
#include "accel/bvh/top_level_bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "accel/bvh/woop_bvh.h"
#include "accel/kd_tree/kd_tree.h"
#include "accel/octree/octree.h"
#include "trace/brute_force_walk.h"
#include "trace/scene_trees.h"
#include "tracer/binary_trees.h"
#include "tracer/combination.h"

namespace pertev {

using AnyTrees = std::variant<SceneTrees<BvhView>, SceneTrees<SkipBvhView>, SceneTrees<WideBvhView<4>>,
                              SceneTrees<WideBvhView<8>>, SceneTrees<CompressedBvhView>, SceneTrees<KdTreeView>,
                              SceneTrees<OctreeView>, SceneTrees<TriangleArrayView>, SceneTrees<WoopBvhView>>;

/// What a binary tree is turned into for a walk, or what stands in its place.
enum class TreeLayout {
    Triangles,
    Binary,
    Linked, // binary, with links to parents
    Woop,
    Skip,
    Wide4,
    Wide8,
    Wide8Simd, // the same nodes, with leaves for four triangles at once
    Compressed,
    Kd,
    Octree
};
TreeLayout layout_of(const Combination& combination);

struct StructureFigures {
    std::string name;                  // "sbvh", "sbvh wide4": the tree and what it was turned into
    std::string failed;                // why it is not there; empty: it is
    double build_s = 0;                // from triangles to what the walk reads, conversion included
    uint64_t nodes = 0, triangles = 0; // triangles: in leaves, so duplicates count
    std::size_t bytes = 0;             // nodes, triangles, and what the layout has beside them
    std::optional<double> sah_cost;    // in its builder's own unit: binary trees compare with binary trees alone
    std::optional<int> depth;          // inner nodes on the longest way down; neither of a bare array of triangles
};

/// In the host's memory.
class BuiltStructure {
public:
    /// The same structure before a change of the scene, in the same layout: parts without a change are taken from it.
    struct Before {
        const BuiltStructure& structure;
        std::vector<PartChange> changes;
    };

    /// Of binary trees, which `kind` names. `trees` may go away afterwards. Throws Error(OverLimit), std::bad_alloc.
    BuiltStructure(const TopLevelBvh& top_level, StructureKind kind, TreeLayout layout, const BinaryTrees& trees,
                   const Before* before = nullptr);
    /// A kd-tree or an octree. Planes of space do not move with triangles: deformed parts are built anew. Throws the
    /// same.
    BuiltStructure(const TopLevelBvh& top_level, StructureKind kind, const SceneTriangles& triangles,
                   const Before* before = nullptr);

    /// As a walk on the host reads it.
    const AnyTrees& trees() const { return trees_; }
    const StructureFigures& figures() const { return figures_; }
    bool has_instances() const { return has_instances_; }
    /// Which keep a tree of their own.
    std::size_t mesh_count() const { return parts_.size() - 1; }

    /// Every array that the views point to, in the order in which they lie on a device.
    struct Array {
        std::span<const std::byte> bytes;
        std::size_t offset = 0; // on the device
    };
    const std::vector<Array>& arrays() const { return arrays_; }
    /// Of the array that begins there; nothing of one without elements.
    std::optional<std::size_t> offset_of(const void* on_host) const;
    std::size_t device_bytes() const { return device_bytes_; }

private:
    template <class Make>
    void build(const TopLevelBvh& top_level, std::size_t parts, const Before* before, const Make& make);
    template <class Tree, class ViewOf>
    void take(const TopLevelBvh& top_level, const std::vector<std::shared_ptr<const Tree>>& parts,
              const ViewOf& view_of_part);
    template <class T>
    void list(const std::vector<T>& values);
    void list_bytes(std::span<const std::byte> bytes);

    AnyTrees trees_;
    StructureFigures figures_;
    bool has_instances_ = false;
    std::vector<std::shared_ptr<const void>> parts_;  // the trees, of a type that the layout says
    std::vector<std::shared_ptr<const void>> memory_; // what else the views point to
    std::vector<Array> arrays_;
    std::unordered_map<const void*, std::size_t> offsets_;
    std::size_t device_bytes_ = 0;
};

} // namespace pertev
