#include "radiosity/link_oracle.h"

namespace pertev {

LinkedPatch linked_patch(const SceneView& scene, const Patch& patch) {
    const WorldTriangle triangle = world_triangle(scene, patch, patch.corners.middle());
    LinkedPatch linked;
    for (int k = 0; k < 3; ++k) linked.corner[k] = triangle.at(patch.corners.at[k].x, patch.corners.at[k].y);
    linked.normal = normal_of(scene, patch, triangle);
    linked.area = patch.area;
    linked.ball.centre = (1.0f / 3) * (linked.corner[0] + linked.corner[1] + linked.corner[2]);
    for (int k = 0; k < 3; ++k) {
        linked.ball.radius = max(linked.ball.radius, length(linked.corner[k] - linked.ball.centre));
        linked.longest = max(linked.longest, length(linked.corner[k] - linked.corner[(k + 1) % 3]));
    }
    return linked;
}

bool is_before(const LinkedPatch& patch, const Ball& ball) {
    return dot(patch.normal, ball.centre - patch.ball.centre) > -ball.radius;
}

bool is_before(const LinkedPatch& patch, const LinkedPatch& other) {
    const float least = 1e-5f * (patch.ball.radius + other.ball.radius); // otherwise they lie in one plane
    for (const Vec3& corner : other.corner) {
        if (dot(patch.normal, corner - patch.ball.centre) > least) return true;
    }
    return false;
}

bool balls_meet(const Ball& a, const Ball& b) { return !(length(a.centre - b.centre) > a.radius + b.radius); }

float max_form_factor(const Ball& receiver, const Ball& source, float area) {
    const float nearest = length(source.centre - receiver.centre) - receiver.radius; // distance to its middle
    if (!(nearest > source.radius)) return 1;
    const float of_ball = square(source.radius / nearest); // upper bound for a sphere that is faced directly
    const float gap = nearest - source.radius;
    return min(min(of_ball, area * kInvPi / max(square(gap), 1e-30f)), 1.0f);
}

} // namespace pertev
