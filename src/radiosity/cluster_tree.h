#pragma once

// A binary tree of clusters: groups of near faces with similar light and orientation, so that distant ones exchange
// light as a whole, and neither side of a wall gets the light of the other. The directional light of a cluster is
// represented by three sums over its patches, of A B, A B n and A B n n: the first terms of the clamped cosine's
// series.
//
// Sources: Smits, Arvo, Greenberg, "A Clustering Algorithm for Radiosity in Complex Environments", SIGGRAPH 1994; the
// series: Ramamoorthi, Hanrahan, "An Efficient Representation for Irradiance Environment Maps", SIGGRAPH 2001.

#include <cstdint>
#include <span>
#include <vector>

#include "math/rgb.h"
#include "math/vec3.h"

namespace pertev {

/// Light of patches by direction.
struct SentLight {
    Rgb all;      // sum of A B, W
    Rgb along[3]; // multiplied by the normal's x, y, z
    Rgb twice[6]; // multiplied by xx, yy, zz, xy, yz, zx of the normal

    void add(Vec3 normal, Rgb power);
    void add(const SentLight& other);
    /// Approximate sum of A B max(cosine, 0) towards `direction` (unit); at least 0.
    Rgb towards(Vec3 direction) const;
};

/// A bounding sphere, in metres.
struct Ball {
    Vec3 centre;
    float radius = 0;
};
/// A sphere that contains both.
Ball ball_round(const Ball& a, const Ball& b);

struct Cluster {
    uint32_t left = 0, right = 0;  // child clusters, with greater numbers; 0 for a single face
    uint32_t first = 0, count = 0; // range of its faces in ClusterTree::faces
    Ball ball;
};

/// The tree; its root is cluster 0.
struct ClusterTree {
    std::vector<Cluster> clusters;
    std::vector<uint32_t> faces;
};

/// Builds the tree over `faces`, each with a bounding sphere, a unit normal and a level of light. Groups with several
/// levels are split by level: of faces with the same position and orientation some are visible, and others are inside
/// a pillar or a wall and would absorb light meant for the former. Other groups with differing normals are split by
/// these, the rest is halved across its longest side; the lower number comes first for faces that are equal.
ClusterTree make_clusters(std::span<const uint32_t> faces, std::span<const Ball> balls, std::span<const Vec3> normals,
                          std::span<const int> levels);

} // namespace pertev
