#include "radiosity/cluster_tree.h"

#include <algorithm>

#include "math/bounds3.h"

namespace pertev {
namespace {

/// Its cluster is pushed before those below it.
uint32_t halve(ClusterTree& tree, std::span<const Ball> balls, std::vector<uint32_t>& order, uint32_t first,
               uint32_t count) {
    const auto number = static_cast<uint32_t>(tree.clusters.size());
    tree.clusters.push_back({.first = first, .count = count});
    if (count == 1) {
        tree.clusters[number].ball = balls[order[first]];
        return number;
    }
    Bounds3 bounds;
    for (uint32_t i = first; i < first + count; ++i) bounds.extend(balls[order[i]].centre);
    const Vec3 size = bounds.size();
    const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    const auto begin = order.begin() + first;
    const auto is_before = [&](uint32_t a, uint32_t b) {
        const float at_a = component(balls[a].centre, axis), at_b = component(balls[b].centre, axis);
        return at_a != at_b ? at_a < at_b : a < b;
    };
    std::nth_element(begin, begin + count / 2, begin + count, is_before);
    const uint32_t left = halve(tree, balls, order, first, count / 2);
    const uint32_t right = halve(tree, balls, order, first + count / 2, count - count / 2);
    Cluster& cluster = tree.clusters[number];
    cluster.left = left, cluster.right = right;
    cluster.ball = ball_round(tree.clusters[left].ball, tree.clusters[right].ball);
    return number;
}

} // namespace

void SentLight::add(Vec3 n, Rgb power) {
    all += power;
    along[0] += n.x * power, along[1] += n.y * power, along[2] += n.z * power;
    twice[0] += (n.x * n.x) * power, twice[1] += (n.y * n.y) * power, twice[2] += (n.z * n.z) * power;
    twice[3] += (n.x * n.y) * power, twice[4] += (n.y * n.z) * power, twice[5] += (n.z * n.x) * power;
}

void SentLight::add(const SentLight& other) {
    all += other.all;
    for (int k = 0; k < 3; ++k) along[k] += other.along[k];
    for (int k = 0; k < 6; ++k) twice[k] += other.twice[k];
}

Rgb SentLight::towards(Vec3 d) const {
    const Rgb cosine = d.x * along[0] + d.y * along[1] + d.z * along[2];
    const Rgb square = (d.x * d.x) * twice[0] + (d.y * d.y) * twice[1] + (d.z * d.z) * twice[2] +
                       2.0f * ((d.x * d.y) * twice[3] + (d.y * d.z) * twice[4] + (d.z * d.x) * twice[5]);
    // max(c, 0) is about 1/4 + c / 2 + 5/32 (3 c^2 - 1).
    const Rgb sum = (3.0f / 32) * all + 0.5f * cosine + (15.0f / 32) * square;
    return {max(sum.r, 0.0f), max(sum.g, 0.0f), max(sum.b, 0.0f)};
}

Ball ball_round(const Ball& a, const Ball& b) {
    const Vec3 way = b.centre - a.centre;
    const float distance = length(way);
    if (distance + b.radius <= a.radius) return a;
    if (distance + a.radius <= b.radius) return b;
    const float radius = 0.5f * (distance + a.radius + b.radius);
    return {a.centre + ((radius - a.radius) / distance) * way, radius};
}

ClusterTree make_clusters(std::span<const uint32_t> faces, std::span<const Ball> balls) {
    ClusterTree tree;
    std::vector<uint32_t> order(faces.size());
    for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    if (!order.empty()) halve(tree, balls, order, 0, static_cast<uint32_t>(order.size()));
    for (const uint32_t i : order) tree.faces.push_back(faces[i]);
    return tree;
}

} // namespace pertev
