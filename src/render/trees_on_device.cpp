#include "render/trees_on_device.h"

#include "accel/bvh/wide_bvh.h"
#include "render/part_arrays.h"

namespace pertev {
namespace {

/// What is copied, and the arrays made for it alone.
struct Trees {
    SceneBvhView view;
    std::vector<BvhView> meshes;
    std::vector<std::vector<WideBvhNode<kWideChildren>>> wide;
    PartArrays arrays;

    Trees(const PreparedScene& prepared, bool has_wide) : meshes(prepared.mesh_bvhs.size()) {
        wide.reserve(meshes.size() + 1);
        view.top_root = prepared.top_level.root;
        view.top_reach = prepared.top_level.reach;
        view.top_growth = prepared.top_level.growth;
        add(prepared.baked, view.baked, has_wide);
        for (std::size_t i = 0; i < meshes.size(); ++i) add(prepared.mesh_bvhs[i], meshes[i], has_wide);
        arrays.add(prepared.top_level.nodes, view.top_nodes);
        arrays.add(prepared.top_level.instances, view.instances);
        arrays.add(meshes, view.meshes);
    }
    Trees(const Trees&) = delete; // the list points into it
    Trees& operator=(const Trees&) = delete;

    void add(const Bvh& bvh, BvhView& tree, bool has_wide) {
        tree = view_of(bvh);
        arrays.add(bvh.nodes, tree.nodes);
        arrays.add(bvh.triangles, tree.triangles);
        if (has_wide) arrays.add(wide.emplace_back(make_wide_nodes(bvh)), tree.wide);
    }
};

} // namespace

SceneBvhView upload_trees(Queue& queue, const PreparedScene& prepared, Buffer<std::byte>& buffer) {
    const Trees trees(prepared, !queue.is_cuda());
    trees.arrays.upload(queue, buffer, "trees");
    return trees.view;
}

std::size_t predicted_tree_bytes(const PreparedScene& prepared) { return Trees(prepared, false).arrays.bytes(); }

} // namespace pertev
