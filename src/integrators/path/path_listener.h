#pragma once

// Listeners receive more of a path's vertices than their light: for auxiliary layers, layers of light-path
// expressions, frames of samples, ReSTIR, and the irradiance meter. A listener is a class with those of the functions
// below that it needs; the others leave no code. Its data of a path up to the next vertex (PathData), and of a shadow
// ray until it has been traced (ShadowData), are two plain structs. The CPU has arrays of them; a GPU's queues have
// arrays of their parts (ListenerQueues), and the listener loads and stores them.

#include "device_scene/ray_origin.h"
#include "device_scene/surface.h"
#include "integrators/path/path_job.h"
#include "integrators/path/path_state.h"
#include "math/float4.h"
#include "shading/assume_variant.h"
#include "shading/emitter_point.h"

namespace pertev {

/// Listeners' data on a device, besides the arrays of paths that a round reads and writes and of its shadow rays.
/// Null for absent listeners.
struct ListenerQueues {
    Float4 *diffuse = nullptr, *next_diffuse = nullptr; // LightSplit
    Float4* shadow_diffuse = nullptr;
    Float4* shadow_bounce = nullptr;                 // FirstBounce
    Uint2 *states = nullptr, *next_states = nullptr; // LightPaths
    Float4* layer_diffuse = nullptr;
    Uint4* layer_parts = nullptr;
};

/// A vertex of a path on a surface, seen from `wo` (unit).
struct SurfaceVertex {
    const Surface& surface;
    Vec3 wo;

    /// Returns whether only delta lobes scatter light.
    HD bool scatters_by_delta_alone() const { return surface.bsdf.has_delta_only(); }
    HD LightContext light_context(float time) const { return surface.light_context(wo, time); }
    HD BsdfValue evaluate(Vec3 wi) const { return surface.evaluate(wo, wi); }
    /// Returns whether sample() uses `lobe`, a number in [0, 1).
    HD bool draws_lobe() const { return surface.bsdf.draws_lobe(); }
    HD BsdfSample sample(float lobe, Vec2 u) const { return surface.sample(wo, lobe, u); }
    /// Returns the origin of a ray that leaves along `wi`.
    HD Vec3 origin_towards(Vec3 wi) const {
        return offset_ray_origin(surface.position, surface.error, surface.geometric_normal, wi);
    }
    /// Returns the shadow ray to the sample point on a light, as ray_to_light makes it.
    HD Ray ray_to(const LightSample& light, float emitter_error) const {
        return ray_to_light(light, surface.position, surface.error, surface.geometric_normal, emitter_error);
    }
    /// Returns whether a ray along `wi` stays on the surface's side of `wo`.
    HD bool stays(Vec3 wi) const { return surface.same_side(wo, wi); }
    /// Returns the triangle that rays from the vertex leave.
    HD TriangleId triangle() const { return surface.triangle; }
};

/// The vertex in code for a shading variant.
template <ShadingVariant kVariant>
struct SurfaceVertexOf : SurfaceVertex {
    static constexpr BsdfPass kPass = kVariant == ShadingVariant::General ? BsdfPass::InPlace : BsdfPass::Copied;

    HD BsdfValue evaluate(Vec3 wi) const {
        assume_variant<kVariant>(surface.bsdf);
        return surface.evaluate<kPass>(wo, wi);
    }
    HD BsdfSample sample(float lobe, Vec2 u) const {
        assume_variant<kVariant>(surface.bsdf);
        return surface.sample<kPass>(wo, lobe, u);
    }
};

/// The depth of lanes for jobs that have none.
inline constexpr uint32_t kNoLaneDepth = 0xffffffffu;

/// Base class of every listener, with the listener's class as parameter. A listener is constructed from the job for
/// one vertex of one path.
template <class Self>
struct PathListener {
    struct PathData {};
    struct ShadowData {};

    /// Called before the vertex, for a path that starts at the camera (then nothing is kept yet) or continues.
    HD void begins(const PathState&) {}
    template <class K>
    HD void restore(const K&) {}
    /// Called when the path's ray has hit a surface after path.depth scatterings.
    HD void vertex(const PathState&, const Hit&, Surface&) {}
    /// Least depth at which the host may shade vertices in lanes (shade_lanes.h), if may_be_in_lanes allows it: the
    /// listener then needs no more of one than vertex_in_lanes, and of its shadow ray no more than shadow_in_lanes.
    static uint32_t depth_of_lanes(const PathJob&) { return kNoLaneDepth; }
    bool may_be_in_lanes(const SceneView&, const PathState&, const Hit&) const { return true; }
    void vertex_in_lanes(const PathState&, const Hit&) {}
    /// Sets the data of the shadow ray of a vertex from those of the path.
    template <class K, class A>
    void shadow_in_lanes(const K&, const ShadowRay&, A&) const {}
    /// Called when the ray has hit no surface: it leaves the scene, or a medium scatters it first.
    HD void missed(const PathState&) {}
    /// Called before light at `point`, which the ray hit, is added; next-event estimation would have sampled it with
    /// density `light_pdf` (0: it could not). Returns true to take that light away from the path.
    HD bool removes_emission(const PathState&, const EmitterPoint&, float) { return false; }
    /// Called before light that the ray hit, possibly black, is added.
    HD void emitted(const PathState&, Rgb) {}
    /// Returns whether a vertex samples a light with a shadow ray.
    HD bool samples_direct(const PathState&, const Hit&, const Surface&) { return true; }
    /// Called for a shadow ray along `wi`. The vertex is a SurfaceVertex, or that of a medium (medium.h).
    template <class Vertex>
    HD void direct(const PathState&, const Vertex&, Vec3, const ShadowRay&) {}
    /// Called when the path continues along `sample` and has left the vertex.
    template <class Vertex>
    HD void scattered(const PathState&, const Vertex&, const BsdfSample&) {}
    /// Returns the number that chooses the lobe which scatters the path; `drawn` is the sample's.
    HD float chosen_lobe(const PathState&, float drawn) const { return drawn; }
    /// Returns whether the path continues after scattered().
    HD bool goes_on(const PathState&) const { return true; }
    /// Called after the vertex to store the listener's data.
    template <class K>
    HD void save(K&) const {}
    template <class A>
    HD void save_shadow_data(A&) const {}

    /// Called for an unoccluded shadow ray, whose contribution is added to the path.
    template <class K, class A>
    HD void arrived(K&, const A&, Rgb) const {}
    /// Called when the path of a sample of the pixel has ended with this radiance.
    template <class K>
    HD void ended(uint32_t, Rgb, const K&) const {}

    // Loads and stores data in a device's queues.
    template <class K>
    HD static void load(const ListenerQueues&, uint32_t, K&) {}
    template <class K>
    HD static void load_next(const ListenerQueues&, uint32_t, K&) {}
    template <class K>
    HD static void store_next(const ListenerQueues&, uint32_t, const K&) {}
    template <class A>
    HD static void load_shadow_data(const ListenerQueues&, uint32_t, A&) {}
    template <class A>
    HD static void store_shadow_data(const ListenerQueues&, uint32_t, const A&) {}
};

/// Several listeners as one; each is called in turn.
template <class... Ls>
struct Listeners : Ls... {
    struct PathData : Ls::PathData... {};
    struct ShadowData : Ls::ShadowData... {};

    template <class L>
    static constexpr bool has = (std::is_same_v<L, Ls> || ...);

    template <class Job> // PathJob, or a class derived from it with data that a listener needs
    HD explicit Listeners(const Job& job) : Ls(job)... {}
    HD void begins(const PathState& path) { (Ls::begins(path), ...); }
    HD void restore(const PathData& kept) { (Ls::restore(static_cast<const typename Ls::PathData&>(kept)), ...); }
    HD void vertex(const PathState& path, const Hit& hit, Surface& surface) { (Ls::vertex(path, hit, surface), ...); }
    static uint32_t depth_of_lanes(const PathJob& job) {
        uint32_t depth = 0;
        ((depth = max(depth, Ls::depth_of_lanes(job))), ...);
        return depth;
    }
    bool may_be_in_lanes(const SceneView& scene, const PathState& path, const Hit& hit) const {
        return (Ls::may_be_in_lanes(scene, path, hit) && ...);
    }
    void vertex_in_lanes(const PathState& path, const Hit& hit) { (Ls::vertex_in_lanes(path, hit), ...); }
    void shadow_in_lanes(const PathData& kept, const ShadowRay& shadow, ShadowData& shadow_data) const {
        (Ls::shadow_in_lanes(static_cast<const typename Ls::PathData&>(kept), shadow,
                             static_cast<typename Ls::ShadowData&>(shadow_data)),
         ...);
    }
    HD void missed(const PathState& path) { (Ls::missed(path), ...); }
    HD bool removes_emission(const PathState& path, const EmitterPoint& point, [[maybe_unused]] float pdf) {
        return (Ls::removes_emission(path, point, pdf) || ...);
    }
    HD void emitted(const PathState& path, [[maybe_unused]] Rgb light) { (Ls::emitted(path, light), ...); }
    HD bool samples_direct(const PathState& path, const Hit& hit, const Surface& surface) {
        return (Ls::samples_direct(path, hit, surface) && ...);
    }
    template <class Vertex>
    HD INLINE_ON_DEVICE void direct(const PathState& path, const Vertex& at, [[maybe_unused]] Vec3 wi,
                                    const ShadowRay& shadow) {
        (Ls::direct(path, at, wi, shadow), ...);
    }
    template <class Vertex>
    HD INLINE_ON_DEVICE void scattered(const PathState& path, const Vertex& at, const BsdfSample& sample) {
        (Ls::scattered(path, at, sample), ...);
    }
    HD float chosen_lobe(const PathState& path, float drawn) const {
        ((drawn = Ls::chosen_lobe(path, drawn)), ...);
        return drawn;
    }
    HD bool goes_on([[maybe_unused]] const PathState& path) const { return (Ls::goes_on(path) && ...); }
    HD void save(PathData& kept) const { (Ls::save(static_cast<typename Ls::PathData&>(kept)), ...); }
    HD void save_shadow_data(ShadowData& shadow_data) const {
        (Ls::save_shadow_data(static_cast<typename Ls::ShadowData&>(shadow_data)), ...);
    }
    HD void arrived(PathData& kept, const ShadowData& shadow_data, Rgb light) const {
        (Ls::arrived(static_cast<typename Ls::PathData&>(kept),
                     static_cast<const typename Ls::ShadowData&>(shadow_data), light),
         ...);
    }
    HD void ended(uint32_t pixel, Rgb radiance, const PathData& kept) const {
        (Ls::ended(pixel, radiance, static_cast<const typename Ls::PathData&>(kept)), ...);
    }
    HD static void load(const ListenerQueues& queues, uint32_t i, PathData& kept) {
        (Ls::load(queues, i, static_cast<typename Ls::PathData&>(kept)), ...);
    }
    HD static void load_next(const ListenerQueues& queues, uint32_t i, PathData& kept) {
        (Ls::load_next(queues, i, static_cast<typename Ls::PathData&>(kept)), ...);
    }
    HD static void store_next(const ListenerQueues& queues, uint32_t i, const PathData& kept) {
        (Ls::store_next(queues, i, static_cast<const typename Ls::PathData&>(kept)), ...);
    }
    HD static void load_shadow_data(const ListenerQueues& queues, uint32_t i, ShadowData& shadow_data) {
        (Ls::load_shadow_data(queues, i, static_cast<typename Ls::ShadowData&>(shadow_data)), ...);
    }
    HD static void store_shadow_data(const ListenerQueues& queues, uint32_t i, const ShadowData& shadow_data) {
        (Ls::store_shadow_data(queues, i, static_cast<const typename Ls::ShadowData&>(shadow_data)), ...);
    }
};

} // namespace pertev
