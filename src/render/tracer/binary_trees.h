#pragma once

// A scene's binary trees: what most layouts of structures are made of.

#include <memory>
#include <vector>

#include "accel/bvh/builders.h"
#include "accel/bvh/bvh.h"
#include "render/place_meshes.h"

namespace pertev {

struct BinaryTrees {
    // [0] over the baked instances; then those of the meshes that keep a tree of their own, in local space.
    std::shared_ptr<const std::vector<Bvh>> parts;
    double build_s = 0;

    const Bvh& baked() const { return parts->front(); }
};

/// Throws Error(OverLimit), std::bad_alloc.
BinaryTrees build_binary_trees(const SceneTriangles& triangles, BvhBuilder builder);

} // namespace pertev
