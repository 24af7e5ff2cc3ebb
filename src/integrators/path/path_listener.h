#pragma once

// Whoever wants more of a path's vertices than their light listens: auxiliary layers, layers of light-path expressions,
// frames of samples, ReSTIR, the meter of irradiance. A listener is a class with the functions below that it wants; of
// the others no code is left. What it keeps of a path until the next vertex, and of a shadow ray until that has been
// traced, are two plain structs; the CPU has arrays of them, a GPU's queues have arrays of their parts
// (ListenerQueues), and the listener says how they are put there.

#include "device_scene/ray_origin.h"
#include "device_scene/surface.h"
#include "integrators/path/path_job.h"
#include "integrators/path/path_state.h"
#include "math/float4.h"
#include "shading/light_place.h"

namespace pertev {

/// Where listeners keep what they do, on a device: beside the arrays of paths that a round reads and writes, and beside
/// its shadow rays. Null for those that there are not.
struct ListenerQueues {
    Float4 *diffuse = nullptr, *next_diffuse = nullptr; // LightSplit
    Float4* shadow_diffuse = nullptr;
    Float4* shadow_sent = nullptr;                   // FirstBounce
    Uint2 *states = nullptr, *next_states = nullptr; // LightPaths
    Float4* layer_diffuse = nullptr;
    Uint4* layer_parts = nullptr;
};

/// A vertex of a path on a surface, seen from `wo` (unit).
struct SurfaceVertex {
    const Surface& surface;
    Vec3 wo;

    /// Returns whether no direction but those of delta lobes scatters light.
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
    /// Returns the shadow ray to what was drawn of a light, which ray_to_light describes.
    HD Ray ray_to(const LightSample& light, float lamp_error) const {
        return ray_to_light(light, surface.position, surface.error, surface.geometric_normal, lamp_error);
    }
    /// Returns the triangle that its rays leave.
    HD TriangleId triangle() const { return surface.triangle; }
};

/// What every listener inherits, by its own name. A listener is made of the job, for one vertex of one path.
template <class Self>
struct PathListener {
    struct Kept {};
    struct Asked {};

    /// Before the vertex, of a path at the camera, of which nothing is kept yet, or of one that goes on.
    HD void begins(const PathState&) {}
    template <class K>
    HD void take_up(const K&) {}
    /// The path's ray has met a surface, before which there were path.depth scatterings.
    HD void vertex(const PathState&, const Hit&, Surface&) {}
    /// It has met none: it leaves the scene, or it has met a medium before a surface.
    HD void missed(const PathState&) {}
    /// Light that the ray has run into at `place`, which next-event estimation would have drawn by the density
    /// `light_pdf` (0: it could not), is to be added. True keeps it out of the path: the listener has taken it.
    HD bool takes(const PathState&, const LightPlace&, float) { return false; }
    /// Light that the ray has run into, perhaps black, is added next.
    HD void emitted(const PathState&, Rgb) {}
    /// Whether light of a vertex is asked for by a shadow ray.
    HD bool wants_direct(const PathState&, const Hit&, const Surface&) { return true; }
    /// It is, along `wi`. The vertex is a SurfaceVertex, or that of a medium (medium.h).
    template <class Vertex>
    HD void direct(const PathState&, const Vertex&, Vec3, const ShadowRay&) {}
    /// The path goes on, as `sample` was drawn; it has left the vertex.
    template <class Vertex>
    HD void scattered(const PathState&, const Vertex&, const BsdfSample&) {}
    /// After the vertex.
    template <class K>
    HD void put_down(K&) const {}
    template <class A>
    HD void hand_over(A&) const {}

    /// A shadow ray has met nothing, and what it contributes is added to the path.
    template <class K, class A>
    HD void arrived(K&, const A&, Rgb) const {}
    /// The path of a sample of the pixel has ended, with this radiance.
    template <class K>
    HD void ended(uint32_t, Rgb, const K&) const {}

    // Of a device's queues.
    template <class K>
    HD static void load(const ListenerQueues&, uint32_t, K&) {}
    template <class K>
    HD static void load_next(const ListenerQueues&, uint32_t, K&) {}
    template <class K>
    HD static void store_next(const ListenerQueues&, uint32_t, const K&) {}
    template <class A>
    HD static void load_asked(const ListenerQueues&, uint32_t, A&) {}
    template <class A>
    HD static void store_asked(const ListenerQueues&, uint32_t, const A&) {}
};

/// Several as one; each is told in turn.
template <class... Ls>
struct Listeners : Ls... {
    struct Kept : Ls::Kept... {};
    struct Asked : Ls::Asked... {};

    template <class L>
    static constexpr bool has = (std::is_same_v<L, Ls> || ...);

    template <class Job> // PathJob, or one that is derived from it for what a listener needs besides
    HD explicit Listeners(const Job& job) : Ls(job)... {}
    HD void begins(const PathState& path) { (Ls::begins(path), ...); }
    HD void take_up(const Kept& kept) { (Ls::take_up(static_cast<const typename Ls::Kept&>(kept)), ...); }
    HD void vertex(const PathState& path, const Hit& hit, Surface& surface) { (Ls::vertex(path, hit, surface), ...); }
    HD void missed(const PathState& path) { (Ls::missed(path), ...); }
    HD bool takes(const PathState& path, const LightPlace& place, [[maybe_unused]] float pdf) {
        return (Ls::takes(path, place, pdf) || ...);
    }
    HD void emitted(const PathState& path, [[maybe_unused]] Rgb light) { (Ls::emitted(path, light), ...); }
    HD bool wants_direct(const PathState& path, const Hit& hit, const Surface& surface) {
        return (Ls::wants_direct(path, hit, surface) && ...);
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
    HD void put_down(Kept& kept) const { (Ls::put_down(static_cast<typename Ls::Kept&>(kept)), ...); }
    HD void hand_over(Asked& asked) const { (Ls::hand_over(static_cast<typename Ls::Asked&>(asked)), ...); }
    HD void arrived(Kept& kept, const Asked& asked, Rgb light) const {
        (Ls::arrived(static_cast<typename Ls::Kept&>(kept), static_cast<const typename Ls::Asked&>(asked), light), ...);
    }
    HD void ended(uint32_t pixel, Rgb radiance, const Kept& kept) const {
        (Ls::ended(pixel, radiance, static_cast<const typename Ls::Kept&>(kept)), ...);
    }
    HD static void load(const ListenerQueues& queues, uint32_t i, Kept& kept) {
        (Ls::load(queues, i, static_cast<typename Ls::Kept&>(kept)), ...);
    }
    HD static void load_next(const ListenerQueues& queues, uint32_t i, Kept& kept) {
        (Ls::load_next(queues, i, static_cast<typename Ls::Kept&>(kept)), ...);
    }
    HD static void store_next(const ListenerQueues& queues, uint32_t i, const Kept& kept) {
        (Ls::store_next(queues, i, static_cast<const typename Ls::Kept&>(kept)), ...);
    }
    HD static void load_asked(const ListenerQueues& queues, uint32_t i, Asked& asked) {
        (Ls::load_asked(queues, i, static_cast<typename Ls::Asked&>(asked)), ...);
    }
    HD static void store_asked(const ListenerQueues& queues, uint32_t i, const Asked& asked) {
        (Ls::store_asked(queues, i, static_cast<const typename Ls::Asked&>(asked)), ...);
    }
};

} // namespace pertev
