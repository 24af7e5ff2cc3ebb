#pragma once

// Faces of a scene in groups of near ones that are about equally lit and face about the same way, in a binary tree: so
// that what is far away sends its light as one, and neither side of a wall has part in the light of the other. What a
// group sends in a direction is known by three sums over its patches, of A B, A B n and A B n n: the first terms of the
// clamped cosine's series.
//
// Sources: Smits, Arvo, Greenberg, "A Clustering Algorithm for Radiosity in Complex Environments", SIGGRAPH 1994; the
// series: Ramamoorthi, Hanrahan, "An Efficient Representation for Irradiance Environment Maps", SIGGRAPH 2001.

#include <cstdint>
#include <span>
#include <vector>

#include "math/rgb.h"
#include "math/vec3.h"

namespace pertev {

/// The light that patches send, by direction.
struct SentLight {
    Rgb all;      // sum of A B, W
    Rgb along[3]; // times the normal's x, y, z
    Rgb twice[6]; // times xx, yy, zz, xy, yz, zx of the normal

    void add(Vec3 normal, Rgb power);
    void add(const SentLight& other);
    /// Sum of A B max(cosine, 0) towards `direction` (unit), about; at least 0.
    Rgb towards(Vec3 direction) const;
};

/// A ball round something. Metres.
struct Ball {
    Vec3 centre;
    float radius = 0;
};
/// One that holds both.
Ball ball_round(const Ball& a, const Ball& b);

struct Cluster {
    uint32_t left = 0, right = 0;  // clusters, of which each has a greater number; of one face: 0
    uint32_t first = 0, count = 0; // of its faces in ClusterTree::faces
    Ball ball;
};

/// Its root is cluster 0.
struct ClusterTree {
    std::vector<Cluster> clusters;
    std::vector<uint32_t> faces;
};

/// Over `faces`, with a ball, a normal (unit) and a level of light each. Groups of more than one level are parted by
/// it: of faces that lie and face alike some are seen, and others are inside of a pillar or a wall; these would take
/// light that is meant for those. Others whose normals differ much are parted by these, the rest is halved across its
/// longest side; of faces that lie alike the lower number comes first.
ClusterTree make_clusters(std::span<const uint32_t> faces, std::span<const Ball> balls, std::span<const Vec3> normals,
                          std::span<const int> levels);

} // namespace pertev
