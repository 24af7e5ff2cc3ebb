#pragma once

// Walks in flight, first from the lights and then from the camera, one of each a sample: arrays in one piece of memory,
// placed by lay_out() for a device and for a thread of the CPU alike. Rays that are under way lie side by side; what
// else a walk knows lies at its own number. Vertices of walks from lights stay for the camera's walks to be joined to.

#include <cstddef>
#include <cstdint>

#include "base/host_device.h"
#include "device_scene/accept_hit.h"
#include "device_scene/ray_queue.h"
#include "integrators/lay_out_arrays.h"
#include "math/float4.h"
#include "math/rgb.h"
#include "math/scalar.h"

namespace pertev {

// The weight of a light path among all ways in which it could have been found: a walk from the camera and one from a
// light, joined anywhere. A weight needs the densities of all these ways; two numbers that a walk carries along hold
// what its own side has to say, so that no vertex is looked at twice.
//
// Source: Georgiev, "Implementing Vertex Connection and Merging", 2012, whose dVCM and dVC these are, without merging;
// the power heuristic (Veach 1997, section 9.2.4) with exponent 2, so all densities are squared. Delta scatterings
// count as if drawn with the same density from both sides, which any weights that add up to 1 may do.

/// Odds beyond this decide any weight: what is larger is this.
inline constexpr float kMostOdds = 0x1p+100f;

HD inline float squared_density(float density) { return square(min(density, 0x1p+30f)); }

struct MisWalk {
    // Squared densities over that of this walk as it is: of the way that ends one vertex earlier and reaches the last
    // one from the other side, but for the density of that step, which the other side knows;
    float last = 0;
    // and of all ways that end earlier still, but for the density of the step back from the last vertex.
    float earlier = 0;

    /// The walk reaches a surface under the cosine `cos_in` to its geometric normal, `distance_squared` away; that is 1
    /// where it comes from infinitely far.
    HD void arrive(float cos_in, float distance_squared) {
        const float inverse = 1.0f / max(square(cos_in), 0x1p-60f);
        last = min(last * min(square(distance_squared) * inverse, kMostOdds), kMostOdds);
        earlier = min(earlier * inverse, kMostOdds);
    }
    /// It goes on by the solid angle density `pdf` under `cos_out`; `reverse_pdf`: density of the way back.
    HD void scatter(float cos_out, float pdf, float reverse_pdf) {
        const float by = min(squared_density(cos_out) / square(pdf), kMostOdds);
        earlier = min(by * others(reverse_pdf), kMostOdds);
        last = min(1.0f / square(pdf), kMostOdds);
    }
    HD void scatter_by_delta(float cos_out) {
        earlier = earlier * square(cos_out);
        last = 0;
    }
    /// All ways that this walk knows, over the present one, but for the density of the step onto its last vertex.
    HD float others(float reverse_pdf) const { return min(last + earlier * squared_density(reverse_pdf), kMostOdds); }
};

/// The weight of one way, where the odds of all others add up to `others`; 0 where that is no number.
HD inline float mis_weight(float others) { return others < kInfinity ? 1.0f / (1.0f + others) : 0.0f; }

/// Beside its ray.
struct alignas(16) WalkState {
    Rgb throughput; // from the camera: of radiance; from a light: power, W
    MisWalk mis;
    uint32_t pixel, sample;   // whose it is
    uint16_t scatterings = 0; // so far
    uint16_t is_from_far = 0; // 1: its first way has no distance

    HD uint32_t depth() const { return scatterings; }
};
static_assert(sizeof(WalkState) == 32);

/// A surface that a walk has met, from which the other side's is to be joined.
struct WalkVertex {
    Hit hit;        // no instance: delta lobes alone, nothing can be joined
    Vec3 direction; // of the walk, unit
    Rgb throughput; // on arrival; of a walk from a light over the square of the index where it arrives
    MisWalk mis;
};

struct WalkVerticesView {
    Float4 *places, *directions, *throughputs;

    HD void store(std::size_t at, const WalkVertex& vertex) const {
        const Hit& hit = vertex.hit;
        places[at] = {hit.u, hit.v, float_of(hit.instance), float_of(hit.primitive)};
        directions[at] = {vertex.direction.x, vertex.direction.y, vertex.direction.z, vertex.mis.last};
        throughputs[at] = {vertex.throughput.r, vertex.throughput.g, vertex.throughput.b, vertex.mis.earlier};
    }
    HD void store_none(std::size_t at) const { places[at] = {0, 0, float_of(kNoHit), 0}; }
    HD bool is_there(std::size_t at) const { return bits_of(places[at].z) != kNoHit; }
    HD WalkVertex load(std::size_t at) const {
        const Float4 p = places[at], d = directions[at], t = throughputs[at];
        WalkVertex vertex;
        vertex.hit = {0, p.x, p.y, bits_of(p.z), bits_of(p.w)};
        vertex.direction = {d.x, d.y, d.z};
        vertex.throughput = {t.x, t.y, t.z};
        vertex.mis = {d.w, t.w};
        return vertex;
    }
};

/// What counts if nothing stands between a ray's ends.
struct Connection {
    Ray ray;
    TriangleId start, target;
    uint32_t key; // of blended surfaces' coin
    Rgb light;    // W/(sr m2) of its pixel
};

/// Of one round.
struct WalkCounts {
    uint32_t rays;               // under way
    uint32_t next;               // that go on after it
    uint32_t asked;              // connections, since the last look
    uint32_t vertices;           // of this round's walks that can be joined
    uint32_t pairs;              // of these with some of those of the walks from lights
    uint32_t crowded;            // of look-ups in a photon map, those that threads share
    uint64_t bounces, all_asked; // of all rounds
};

/// How much there is room for.
struct WalkRoom {
    uint32_t count;       // walks
    uint32_t kept;        // vertices of a walk from a light
    uint32_t connections; // of each walk at once
};

struct WalksView {
    WalkRoom room;
    WalkState* states;      // [walks]
    float* squared_indices; // [walks] of walks from lights: where they are, over where their light stands

    // Rays under way, side by side. Rounds read and write these and their owners, the walks, in two arrays in turns.
    Ray* rays[2];
    Uint2* starts;
    uint32_t* keys; // of coins
    uint32_t* owners[2];
    Float4* hit_places;
    uint32_t* hit_instances;

    // Vertices of the walks from lights, vertex k of walk i at k * walks + i, and how many each has.
    WalkVerticesView kept;
    uint32_t* kept_counts;
    // Those of the camera's walks in the present round, side by side.
    WalkVerticesView present;
    uint32_t* present_owners;

    Ray* asked_rays;
    Uint2 *asked_starts, *asked_targets;
    uint32_t* asked_keys; // then what the ray met
    Float4* asked_light;  // rgb, bits of the pixel
    Vec2* asked_rasters;  // [walks] of those of the camera with a particle

    WalkCounts* counts;

    RayQueueView query(uint32_t round) const { return {.rays = rays[round % 2], .starts = starts, .keys = keys}; }
    RayQueueView asked_query() const {
        return {.rays = asked_rays, .starts = asked_starts, .targets = asked_targets, .keys = asked_keys};
    }
    HD HitQueueView hits() const { return {hit_places, hit_instances}; }
    HD std::size_t kept_place(uint32_t walk, uint32_t number) const { return std::size_t(number) * room.count + walk; }

    HD void queue_ray(uint32_t place, uint32_t walk, const Ray& ray, TriangleId start, uint32_t key,
                      uint32_t round) const {
        store_ray(rays[round % 2] + place, ray);
        starts[place] = {start.instance, start.primitive};
        keys[place] = key;
        owners[round % 2][place] = walk;
    }
    HD void ask(uint32_t place, const Connection& connection, uint32_t pixel) const {
        store_ray(asked_rays + place, connection.ray);
        asked_starts[place] = {connection.start.instance, connection.start.primitive};
        asked_targets[place] = {connection.target.instance, connection.target.primitive};
        asked_keys[place] = connection.key;
        asked_light[place] = {connection.light.r, connection.light.g, connection.light.b, float_of(pixel)};
    }
};

/// Places the arrays in one piece of memory (lay_out_arrays).
inline std::size_t lay_out(WalksView& view, std::byte* memory, const WalkRoom& room) {
    view.room = room;
    return lay_out_arrays(memory, [&](const auto& place) {
        const auto place_vertices = [&](WalkVerticesView& vertices, std::size_t count) {
            place(vertices.places, count);
            place(vertices.directions, count);
            place(vertices.throughputs, count);
        };
        const std::size_t walks = room.count, joins = room.kept > 0 ? walks : 0, asked = walks * room.connections;
        place(view.states, walks);
        place(view.squared_indices, walks);
        place(view.rays[0], walks);
        place(view.rays[1], walks);
        place(view.starts, walks);
        place(view.keys, walks);
        place(view.owners[0], walks);
        place(view.owners[1], walks);
        place(view.hit_places, walks);
        place(view.hit_instances, walks);
        place_vertices(view.kept, walks * room.kept);
        place(view.kept_counts, joins);
        place_vertices(view.present, joins);
        place(view.present_owners, joins);
        place(view.asked_rays, asked);
        place(view.asked_starts, asked);
        place(view.asked_targets, asked);
        place(view.asked_keys, asked);
        place(view.asked_light, asked);
        place(view.asked_rasters, walks);
        place(view.counts, 1);
    });
}

} // namespace pertev
