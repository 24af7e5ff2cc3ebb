#pragma once

// One structure in the layout that a walk reads, in the memory of the device that it will be walked on.

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "accel/bvh/compressed_bvh.h"
#include "accel/bvh/skip_bvh.h"
#include "accel/bvh/top_level_bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "accel/bvh/woop_bvh.h"
#include "accel/kd_tree/kd_tree.h"
#include "accel/octree/octree.h"
#include "device/buffer.h"
#include "lab/lab_report.h"
#include "scene/scene.h"
#include "trace/brute_force_walk.h"
#include "trace/scene_bvh.h"

namespace pertev {

using AnyTrees = std::variant<SceneTrees<BvhView>, SceneTrees<SkipBvhView>, SceneTrees<WideBvhView<4>>,
                              SceneTrees<WideBvhView<8>>, SceneTrees<CompressedBvhView>, SceneTrees<KdTreeView>,
                              SceneTrees<OctreeView>, SceneTrees<TriangleArrayView>, SceneTrees<WoopBvhView>>;

/// What a binary tree is turned into for a walk, or what stands in its place.
enum class TreeLayout { Triangles, Binary, Woop, Skip, Wide4, Wide8, Compressed, Kd, Octree };
TreeLayout layout_of(const Combination& combination);

/// A scene's triangles as builders take them: the baked ones, and those of each mesh that keeps a tree of its own. In
/// the file's coordinates, as the sets of rays are.
struct LabTriangles {
    std::vector<BvhTriangle> baked;
    std::vector<std::vector<BvhTriangle>> meshes;
    TopLevelBvh top_level; // the same for every structure

    explicit LabTriangles(const Scene& scene);
    uint64_t count() const;
};

/// A binary tree over each part, [0] the baked one: what several layouts are made of.
struct BinaryTrees {
    std::shared_ptr<const std::vector<Bvh>> parts; // with parent links
    double build_s = 0;                            // without these, which one walk alone reads
};
/// `kind` is that of a binary tree. Throws Error(OverLimit), std::bad_alloc.
BinaryTrees build_binary_trees(const LabTriangles& triangles, StructureKind kind);

class BuiltStructure {
public:
    /// `binary` holds the trees of `kind` where the layout is made of those. Throws Error(OverLimit),
    /// Error(OutOfMemory), std::bad_alloc.
    BuiltStructure(Queue& queue, const LabTriangles& triangles, StructureKind kind, TreeLayout layout,
                   const BinaryTrees* binary);

    const AnyTrees& trees() const { return trees_; }
    const StructureFigures& figures() const { return figures_; }

private:
    void convert(Queue& queue, const LabTriangles& triangles, TreeLayout layout, const BinaryTrees& binary);
    template <class Make>
    void build(Queue& queue, const LabTriangles& triangles, const Make& make);
    template <class Tree, class ViewOf>
    void take(Queue& queue, const LabTriangles& triangles, std::shared_ptr<const std::vector<Tree>> parts,
              const ViewOf& view_of_part);
    template <class Tree, class View>
    View place(Queue& queue, const Tree& tree, View view);
    template <class T>
    const T* keep(Queue& queue, std::span<const T> values, const std::string& name);

    AnyTrees trees_;
    StructureFigures figures_;
    std::shared_ptr<const void> host_; // the trees themselves, where the device is the host
    std::vector<Buffer<std::byte>> buffers_;
};

} // namespace pertev
