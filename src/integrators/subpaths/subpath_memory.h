#pragma once

// Subpaths in flight, first from the lights and then from the camera, one of each per sample. The arrays share one
// allocation, which lay_out() divides, for the device as for a CPU thread. Current rays are contiguous; other data of
// a subpath is at its own index. Vertices of light subpaths stay for the camera subpaths to connect to.

#include <cstddef>
#include <cstdint>

#include "base/host_device.h"
#include "device_scene/accept_hit.h"
#include "device_scene/interior_list.h"
#include "device_scene/ray_queue.h"
#include "integrators/lay_out_arrays.h"
#include "math/float4.h"
#include "math/rgb.h"
#include "math/scalar.h"

namespace pertev {

// MIS weights over all techniques that could have found a light path: a camera subpath and a light subpath of any
// lengths, connected. A weight needs the densities of all techniques; each subpath carries two numbers that summarize
// its side, so that no vertex is visited twice.
//
// Source: Georgiev, "Implementing Vertex Connection and Merging", 2012, whose dVCM and dVC these are, without
// merging; the power heuristic (Veach 1997, section 9.2.4) with exponent 2, so all densities are squared. Delta
// scatterings count as sampled with the same density from both sides, which is valid for any weights that add up to
// 1.

/// Maximum weight sum; larger ones are clamped, because they determine any weight.
inline constexpr float kMaxWeightSum = 0x1p+100f;

HD inline float squared_density(float density) { return square(min(density, 0x1p+30f)); }

struct MisSums {
    // Squared density over that of this subpath, for the technique that ends one vertex earlier and reaches the last
    // vertex from the other side, without the density of that step, which the other side knows;
    float last = 0;
    // and for all techniques that end even earlier, without the density of the step back from the last vertex.
    float earlier = 0;

    /// Updates the weights on arrival at a surface with cosine `cos_in` to its geometric normal, or at a point of a
    /// medium (then 1), at the squared distance `distance_squared`, over the probability that a flight passes it. The
    /// squared distance is 1 for an infinite one.
    HD void arrive(float cos_in, float distance_squared) {
        const float inverse = 1.0f / max(square(cos_in), 0x1p-60f);
        last = min(last * min(square(distance_squared) * inverse, kMaxWeightSum), kMaxWeightSum);
        earlier = min(earlier * inverse, kMaxWeightSum);
    }
    /// Updates the weights for a scattering with solid angle density `pdf` and cosine `cos_out`; `reverse_pdf` is the
    /// density of the reverse direction.
    HD void scatter(float cos_out, float pdf, float reverse_pdf) {
        const float by = min(squared_density(cos_out) / square(pdf), kMaxWeightSum);
        earlier = min(by * weight_sum(reverse_pdf), kMaxWeightSum);
        last = min(1.0f / square(pdf), kMaxWeightSum);
    }
    /// Updates the weights of a light subpath on arrival at its first vertex, for which next-event estimation selects
    /// the light with `ratio` times the probability of its emission.
    HD void select_light(float ratio) { last = min(last * squared_density(ratio), kMaxWeightSum); }
    HD void scatter_by_delta(float cos_out) {
        earlier = earlier * square(cos_out);
        last = 0;
    }
    /// Weight sum of all other techniques that this subpath knows, without the density of the step to its last
    /// vertex.
    HD float weight_sum(float reverse_pdf) const {
        return min(last + earlier * squared_density(reverse_pdf), kMaxWeightSum);
    }
};

/// MIS weight of one technique if the weight sum of all others is `weight_sum`; 0 if that is not finite.
HD inline float mis_weight(float weight_sum) { return weight_sum < kInfinity ? 1.0f / (1.0f + weight_sum) : 0.0f; }

/// State of a subpath besides its ray.
struct alignas(16) SubpathState {
    Rgb throughput; // from the camera: of radiance; from a light: power, W
    MisSums mis;
    uint32_t pixel, sample;   // pixel and sample of the path; photons and rays of records have other numbers
    uint16_t scatterings = 0; // so far
    uint16_t is_from_far = 0; // 1 if the first segment has no distance

    HD uint32_t depth() const { return scatterings; }
};
static_assert(sizeof(SubpathState) == 32);

/// Instance of a SubpathVertex in a medium.
inline constexpr uint32_t kMediumInstance = kNoHit - 1;

/// A surface that a subpath has hit, or a point of a medium that has scattered it, to which the other subpath may
/// connect.
struct SubpathVertex {
    Hit hit;        // without instance if there are only delta lobes, which cannot connect; kMediumInstance with the
                    // bits of the position in u, v and `primitive` for a point of a medium
    Vec3 direction; // direction of the subpath, unit
    Rgb throughput; // on arrival; for a light subpath divided by the squared index there
    MisSums mis;

    HD bool is_in_medium() const { return hit.instance == kMediumInstance; }
    HD Vec3 position_in_medium() const { return {hit.u, hit.v, float_of(hit.primitive)}; }
    HD static Hit hit_in_medium(Vec3 position) {
        return {0, position.x, position.y, kMediumInstance, bits_of(position.z)};
    }
};

struct SubpathVerticesView {
    Float4 *hits, *directions, *throughputs;
    Uint2* interiors; // null unless solids are nested in a scene with media

    HD void store(std::size_t at, const SubpathVertex& vertex) const {
        const Hit& hit = vertex.hit;
        hits[at] = {hit.u, hit.v, float_of(hit.instance), float_of(hit.primitive)};
        directions[at] = {vertex.direction.x, vertex.direction.y, vertex.direction.z, vertex.mis.last};
        throughputs[at] = {vertex.throughput.r, vertex.throughput.g, vertex.throughput.b, vertex.mis.earlier};
    }
    HD void store_interior(std::size_t at, InteriorList interior) const {
        if (interiors != nullptr) interiors[at] = interior.words();
    }
    HD InteriorList load_interior(std::size_t at) const {
        return interiors != nullptr ? InteriorList::of_words(interiors[at]) : InteriorList{};
    }
    HD void store_none(std::size_t at) const { hits[at] = {0, 0, float_of(kNoHit), 0}; }
    HD bool is_there(std::size_t at) const { return bits_of(hits[at].z) != kNoHit; }
    HD SubpathVertex load(std::size_t at) const {
        const Float4 p = hits[at], d = directions[at], t = throughputs[at];
        SubpathVertex vertex;
        vertex.hit = {0, p.x, p.y, bits_of(p.z), bits_of(p.w)};
        vertex.direction = {d.x, d.y, d.z};
        vertex.throughput = {t.x, t.y, t.z};
        vertex.mis = {d.w, t.w};
        return vertex;
    }
};

/// A connection; `light` counts if it is unoccluded.
struct Connection {
    Ray ray;
    TriangleId start, target;
    uint32_t key; // key of the coin of blended surfaces
    Rgb light;    // for its pixel, W/(sr m2)
};

/// Counts of one round.
struct SubpathCounts {
    uint32_t rays;                     // current rays
    uint32_t next;                     // rays that continue after the round
    uint32_t connections;              // connections since the last count
    uint32_t vertices;                 // vertices of this round that can connect
    uint32_t pairs;                    // pairs of these with vertices of light subpaths
    uint32_t crowded;                  // lookups in a photon map that threads share
    uint64_t bounces, all_connections; // totals of all rounds
};

/// Sizes of the arrays.
struct SubpathCapacity {
    uint32_t count;             // subpaths
    uint32_t kept;              // stored vertices per light subpath
    uint32_t connections;       // connections per subpath at once
    bool has_interiors = false; // solids are nested in a scene with media
    bool has_normals = false;   // lights are selected by a tree
};

struct SubpathsView {
    SubpathCapacity capacity;
    SubpathState* states;   // [subpaths]
    float* squared_indices; // [subpaths] for light subpaths: squared index at their vertex, over that at their light
    Uint2* interiors;       // [subpaths] solids that hold their rays; null unless capacity.has_interiors
    Vec3* normals;          // [subpaths] normals of the contexts that selected lights where their rays start; null
                            // unless capacity.has_normals
    uint32_t* lights;       // [subpaths] Particle::light of light subpaths; null unless capacity.has_normals and they
                            // are kept

    // Current rays, contiguous. Rounds alternate between two arrays for them, for the triangles that they leave, and
    // for their owners, the subpaths.
    Ray* rays[2];
    Uint2* starts[2];
    uint32_t* keys; // keys of coins
    uint32_t* owners[2];
    Float4* hit_records;
    uint32_t* hit_instances;

    // Vertices of the light subpaths: vertex k of subpath i at k * subpaths + i, and how many each has.
    SubpathVerticesView kept;
    uint32_t* kept_counts;
    // Vertices of the camera subpaths in the current round, contiguous.
    SubpathVerticesView present;
    uint32_t* present_owners;

    Ray* connection_rays;
    Uint2 *connection_starts, *connection_targets;
    uint32_t* connection_keys; // keys, and after tracing the results
    Float4* connection_light;  // rgb, bits of the pixel
    Vec2* connection_rasters;  // [subpaths] positions of the particles' connections to the camera

    SubpathCounts* counts;

    RayQueueView query(uint32_t round) const {
        return {.rays = rays[round % 2], .starts = starts[round % 2], .keys = keys};
    }
    /// Returns the triangle that ray `i` of a round leaves.
    HD TriangleId start_of(uint32_t i, uint32_t round) const {
        const Uint2 start = starts[round % 2][i];
        return {start.x, start.y};
    }
    RayQueueView connection_query() const {
        return {.rays = connection_rays,
                .starts = connection_starts,
                .targets = connection_targets,
                .keys = connection_keys};
    }
    HD HitQueueView hits() const { return {hit_records, hit_instances}; }
    HD std::size_t kept_index(uint32_t subpath, uint32_t number) const {
        return std::size_t(number) * capacity.count + subpath;
    }

    HD void store_interior(uint32_t subpath, InteriorList interior) const {
        if (interiors != nullptr) interiors[subpath] = interior.words();
    }
    HD InteriorList load_interior(uint32_t subpath) const {
        return interiors != nullptr ? InteriorList::of_words(interiors[subpath]) : InteriorList{};
    }

    HD void queue_ray(uint32_t slot, uint32_t subpath, const Ray& ray, TriangleId start, uint32_t key,
                      uint32_t round) const {
        store_ray(rays[round % 2] + slot, ray);
        starts[round % 2][slot] = {start.instance, start.primitive};
        keys[slot] = key;
        owners[round % 2][slot] = subpath;
    }
    HD void queue_connection(uint32_t slot, const Connection& connection, uint32_t pixel) const {
        store_ray(connection_rays + slot, connection.ray);
        connection_starts[slot] = {connection.start.instance, connection.start.primitive};
        connection_targets[slot] = {connection.target.instance, connection.target.primitive};
        connection_keys[slot] = connection.key;
        connection_light[slot] = {connection.light.r, connection.light.g, connection.light.b, float_of(pixel)};
    }
};

/// Places the arrays in one piece of memory (lay_out_arrays).
inline std::size_t lay_out(SubpathsView& view, std::byte* memory, const SubpathCapacity& capacity) {
    view.capacity = capacity;
    return lay_out_arrays(memory, [&](const auto& add_array) {
        const auto add_vertices = [&](SubpathVerticesView& vertices, std::size_t count) {
            add_array(vertices.hits, count);
            add_array(vertices.directions, count);
            add_array(vertices.throughputs, count);
            add_array(vertices.interiors, capacity.has_interiors ? count : 0);
        };
        const std::size_t subpaths = capacity.count, connects = capacity.kept > 0 ? subpaths : 0,
                          connections = subpaths * capacity.connections;
        add_array(view.states, subpaths);
        add_array(view.squared_indices, subpaths);
        add_array(view.rays[0], subpaths);
        add_array(view.rays[1], subpaths);
        add_array(view.starts[0], subpaths);
        add_array(view.starts[1], subpaths);
        add_array(view.keys, subpaths);
        add_array(view.owners[0], subpaths);
        add_array(view.owners[1], subpaths);
        add_array(view.hit_records, subpaths);
        add_array(view.hit_instances, subpaths);
        add_vertices(view.kept, subpaths * capacity.kept);
        add_array(view.kept_counts, connects);
        add_vertices(view.present, connects);
        add_array(view.present_owners, connects);
        add_array(view.connection_rays, connections);
        add_array(view.connection_starts, connections);
        add_array(view.connection_targets, connections);
        add_array(view.connection_keys, connections);
        add_array(view.connection_light, connections);
        add_array(view.connection_rasters, subpaths);
        add_array(view.interiors, capacity.has_interiors ? subpaths : 0);
        add_array(view.normals, capacity.has_normals ? subpaths : 0);
        add_array(view.lights, capacity.has_normals ? connects : 0);
        add_array(view.counts, 1);
    });
}

} // namespace pertev
