#pragma once

// A structure over a scene's triangles, in the layout that a traversal reads. It is built on the host and then
// copied to the memory of the device that traverses it.

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
#include "accel/bvh/tlas.h"
#include "accel/bvh/wide_bvh.h"
#include "accel/bvh/woop_bvh.h"
#include "accel/kd_tree/kd_tree.h"
#include "accel/octree/octree.h"
#include "trace/brute_force_traversal.h"
#include "trace/scene_trees.h"
#include "tracer/binary_trees.h"
#include "tracer/combination.h"

namespace pertev {

using AnyTrees = std::variant<SceneTrees<BvhView>, SceneTrees<SkipBvhView>, SceneTrees<WideBvhView<4>>,
                              SceneTrees<WideBvhView<8>>, SceneTrees<CompressedBvhView>, SceneTrees<KdTreeView>,
                              SceneTrees<OctreeView>, SceneTrees<TriangleArrayView>, SceneTrees<WoopBvhView>>;

/// The layout that a binary tree is converted to for traversal, or the structure that takes its place.
enum class TreeLayout {
    Triangles,
    Binary,
    Linked, // binary, with links to parents
    Woop,
    Skip,
    Wide4,
    Wide8,
    Wide8Simd, // Wide8 nodes, with leaves for four triangles at once
    Compressed,
    Kd,
    Octree
};
TreeLayout layout_of(const Combination& combination);

struct StructureFigures {
    std::string name;                  // "sbvh", "sbvh wide4": the builder and the layout
    std::string failed;                // reason why there is no structure; empty if there is one
    double build_s = 0;                // seconds from triangles to the finished layout, conversion included
    uint64_t nodes = 0, triangles = 0; // triangles in leaves, so duplicates count
    std::size_t bytes = 0;             // bytes of nodes, triangles and the layout's other arrays
    std::optional<double> sah_cost;    // in the builder's own unit, so that only binary trees compare with each other
    std::optional<int> depth;          // inner nodes on the longest path; a plain array of triangles has neither cost
                                       // nor depth
};

/// A structure in host memory.
class BuiltStructure {
public:
    /// The structure of the previous version of the scene, in the same layout. Unchanged parts are taken from it.
    struct Before {
        const BuiltStructure& structure;
        std::vector<PartChange> changes;
    };

    /// Makes a structure of the given layout from binary trees of the builder that `kind` names. `trees` need not
    /// outlive the call. `sink` may end it. Throws Error(OverLimit), std::bad_alloc.
    BuiltStructure(const Tlas& tlas, StructureKind kind, TreeLayout layout, const BinaryTrees& trees,
                   const Before* before = nullptr, Sink& sink = nobody());
    /// Builds a kd-tree or an octree. Their planes are fixed in space, so deformed parts are rebuilt. `sink`
    /// may end it. Throws Error(OverLimit), std::bad_alloc.
    BuiltStructure(const Tlas& tlas, StructureKind kind, const SceneTriangles& triangles,
                   const Before* before = nullptr, Sink& sink = nobody());

    /// The structure as a traversal on the host reads it.
    const AnyTrees& trees() const { return trees_; }
    const StructureFigures& figures() const { return figures_; }
    bool has_instances() const { return has_instances_; }
    /// Number of meshes that keep a tree of their own.
    std::size_t mesh_count() const { return parts_.size() - 1; }

    /// Every array that the views point to, in device order.
    struct Array {
        std::span<const std::byte> bytes;
        std::size_t offset = 0; // byte offset in the device's copy
    };
    const std::vector<Array>& arrays() const { return arrays_; }
    /// Device offset of the array that begins at this host address; nothing for an array without elements.
    std::optional<std::size_t> offset_of(const void* on_host) const;
    std::size_t device_bytes() const { return device_bytes_; }

private:
    template <class Make>
    void build(const Tlas& tlas, std::size_t parts, const Before* before, const Make& make);
    template <class Tree, class ViewOf>
    void take(const Tlas& tlas, const std::vector<std::shared_ptr<const Tree>>& parts, const ViewOf& view_of_part);
    template <class T>
    void list(const std::vector<T>& values);
    void list_bytes(std::span<const std::byte> bytes);

    AnyTrees trees_;
    StructureFigures figures_;
    bool has_instances_ = false;
    std::vector<std::shared_ptr<const void>> parts_;  // the trees; the layout determines their type
    std::vector<std::shared_ptr<const void>> memory_; // memory beside the trees that the views point to
    std::vector<Array> arrays_;
    std::unordered_map<const void*, std::size_t> offsets_;
    std::size_t device_bytes_ = 0;
};

} // namespace pertev
