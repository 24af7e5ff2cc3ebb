#include "radiosity/link_factors.h"

#include "math/sampler.h"
#include "radiosity/polygon_form_factor.h"

namespace pertev {
namespace {

constexpr uint32_t kDraws = 4; // samples of a pair of points, for each ray between points that face each other
constexpr float kFar = 8;      // distance, in radii of a source, from which on its middle represents it

/// Form factor from a point to a patch, which may face it or not.
float form_factor_at(const PatchPoint& point, const LinkedPatch& source) {
    const Vec3 offset = source.ball.centre - point.position;
    if (!(dot(source.normal, source.corner[0] - point.position) < 0)) return 0;
    const float squared = length_squared(offset);
    if (squared > square(kFar * source.ball.radius)) {
        const float cosines = dot(offset, point.normal) * -dot(offset, source.normal);
        return cosines > 0 ? cosines * source.area / (kPi * square(squared)) : 0.0f;
    }
    const Vec3 corner[] = {source.corner[0] - point.position, source.corner[1] - point.position,
                           source.corner[2] - point.position};
    return triangle_form_factor(corner, point.normal);
}

} // namespace

void LinkFactors::clear() {
    visibility_rays_.clear();
    queued_.clear();
    next_ = 0;
}

void LinkFactors::queue(const Link& link, uint32_t rays) {
    QueuedLink queued;
    queued.first = static_cast<uint32_t>(visibility_rays_.size());
    const uint32_t key = hash_words(link.receiver, link.source, rays, 0x6c696e6bu).x;
    if (is_cluster(link.receiver) || is_cluster(link.source)) {
        queue_clusters(link, rays, key, queued);
    } else {
        queue_patches(link, rays, key, queued);
    }
    queued.count = static_cast<uint32_t>(visibility_rays_.size()) - queued.first;
    queued_.push_back(queued);
}

/// Queues rays for the mean, over points of the receiver, of the form factor to the visible part of the source.
void LinkFactors::queue_patches(const Link& link, uint32_t rays, uint32_t key, QueuedLink& queued) {
    const Patch &receiver = nodes_.patch(link.receiver), &source = nodes_.patch(link.source);
    const LinkedPatch& shape = nodes_.shape(link.source);
    const float each = 1.0f / static_cast<float>(rays);
    queued.rays = rays;
    for (uint32_t k = 0; k < rays; ++k) {
        const SampleKey of_ray = {key, k, seed_};
        const Vec2 on_receiver = sample_2d(SamplerKind::Sobol, of_ray, 0);
        const Vec2 on_source = sample_2d(SamplerKind::Sobol, of_ray, 0, Pair::Last);
        const PatchPoint start = point_on_patch(scene_.view(), receiver, on_receiver);
        const float factor = each * form_factor_at(start, shape);
        if (!(factor > 0)) continue;
        if (test_visibility(receiver, start, source, point_on_patch(scene_.view(), source, on_source), factor))
            continue;
        queued.known += factor; // the drawn point lies below the horizon
        ++queued.seen;
    }
}

PatchCode LinkFactors::triangle_of(NodeCode code, double u) const {
    return is_cluster(code) ? nodes_.triangle_at(nodes_.cluster(code), u) : code;
}

/// Queues rays between triangles, drawn by their areas, at points that face each other. They find the share of light
/// that is not blocked or, if there is no direction between the two clusters, the share that arrives.
void LinkFactors::queue_clusters(const Link& link, uint32_t rays, uint32_t key, QueuedLink& queued) {
    const Ball &here = nodes_.ball(link.receiver), &there = nodes_.ball(link.source);
    const bool is_even = balls_meet(here, there);
    const float area = nodes_.area(link.source) / static_cast<float>(kDraws * rays);
    float weights = 0;
    for (uint32_t k = 0; k < kDraws * rays && visibility_rays_.size() - queued.first < rays; ++k) {
        const SampleKey of_ray = {key, k, seed_};
        const Vec2 triangles = sample_2d(SamplerKind::Sobol, of_ray, 1);
        const PatchCode receiving = triangle_of(link.receiver, static_cast<double>(triangles.x));
        const PatchCode sending = triangle_of(link.source, static_cast<double>(triangles.y));
        if (!is_before(nodes_.shape(receiving), nodes_.shape(sending))) continue;
        ++queued.rays; // the mean is that of what faces the source
        if (!is_before(nodes_.shape(sending), nodes_.shape(receiving))) continue;
        const Vec2 on_receiver = sample_2d(SamplerKind::Sobol, of_ray, 0);
        const Vec2 on_source = sample_2d(SamplerKind::Sobol, of_ray, 0, Pair::Last);
        const Patch &receiver = nodes_.patch(receiving), &source = nodes_.patch(sending);
        const PatchPoint start = point_on_patch(scene_.view(), receiver, on_receiver);
        const PatchPoint target = point_on_patch(scene_.view(), source, on_source);
        const Vec3 offset = target.position - start.position;
        const float squared = length_squared(offset);
        const float cosines = dot(offset, start.normal) * -dot(offset, target.normal);
        if (!(squared > 0) || !(dot(offset, start.normal) > 0) || !(cosines > 0)) continue;
        const float weight = is_even ? cosines / (squared * (kPi * squared + area)) : cosines / squared;
        if (test_visibility(receiver, start, source, target, weight)) weights += weight;
    }
    if (is_even) {
        queued.rays = max(queued.rays, 1u);
        queued.scale = 1.0f / static_cast<float>(queued.rays);
    } else {
        const uint32_t tested = static_cast<uint32_t>(visibility_rays_.size()) - queued.first;
        queued.rays = tested > 0 ? tested : rays; // none faces the other
        const Vec3 offset = there.centre - here.centre;
        const float squared = length_squared(offset);
        float cosine = 1;
        if (!is_cluster(link.receiver)) {
            cosine = max(dot(offset, nodes_.shape(link.receiver).normal), 0.0f) / sqrt(squared);
        }
        queued.scale = weights > 0 ? cosine * kInvPi / (squared * weights) : 0.0f;
    }
}

/// Queues a visibility ray between two points. Returns false if they do not face each other.
bool LinkFactors::test_visibility(const Patch& from, const PatchPoint& start, const Patch& to, const PatchPoint& target,
                                  float weight) {
    const Vec3 offset = target.position - start.position;
    const float squared = length_squared(offset);
    if (!(squared > 0)) return false;
    const Vec3 direction = (1.0f / sqrt(squared)) * offset;
    if (!(dot(direction, start.normal) > 0) || !(dot(direction, target.normal) < 0)) return false;
    VisibilityRay visibility_ray;
    visibility_ray.ray.origin = offset_ray_origin(start.position, start.error, start.normal, direction);
    visibility_ray.ray.direction =
        offset_ray_origin(target.position, target.error, target.normal, -direction) - visibility_ray.ray.origin;
    visibility_ray.ray.t_min = 0;
    visibility_ray.ray.t_max = 1;
    visibility_ray.start = {from.instance, from.primitive};
    visibility_ray.target = {to.instance, to.primitive};
    visibility_ray.weight = weight;
    visibility_rays_.push_back(visibility_ray);
    return true;
}

void LinkFactors::trace() {
    if (visibility_rays_.size() > max_rays_) {
        max_rays_ = 2 * visibility_rays_.size();
        are_occluded_ = std::make_unique<bool[]>(max_rays_);
    }
    find_occlusions(
        scene_.trees(), static_cast<uint32_t>(visibility_rays_.size()), RayOrder::Scattered,
        [&](uint32_t i) { return visibility_rays_[i].ray; },
        [&](uint32_t i) {
            return AcceptHit{scene_.view(), visibility_rays_[i].start, visibility_rays_[i].target,
                             hash_word(seed_ + i)};
        },
        are_occluded_.get());
}

void LinkFactors::answer(Link& link) {
    const QueuedLink& queued = queued_[next_++];
    float sum = queued.known;
    uint32_t seen = queued.seen;
    for (uint32_t i = queued.first; i < queued.first + queued.count; ++i) {
        if (are_occluded_[i]) continue;
        sum += visibility_rays_[i].weight;
        ++seen;
    }
    link.factor = queued.scale * sum;
    link.rays = static_cast<uint16_t>(queued.rays);
    link.seen = static_cast<uint16_t>(min(seen, queued.rays));
}

} // namespace pertev
