// Body of path_loop.h. The file that includes it names the number type of camera rays and of packets: `Floats` is
// Floats8 or Floats16. All of it is in anonymous namespaces, so that a file for AVX-512 keeps it to itself.

#include <new>

#include "device_scene/find_hits.h"
#include "integrators/path/host_shading.h"
#include "integrators/path/lane_samples.h"
#include "integrators/path/path_loop.h"
#include "integrators/path/shade_lanes.h"

namespace pertev {
namespace {

constexpr uint32_t kPaths = 512; // paths side by side: 120 KB of a 1 MB cache, which the trees need too

/// Paths side by side and the rays that they trace.
class PathRays {
public:
    PathRays(const PathJob& job, const LoopTrees& trees) : job_(job), trees_(trees.trees), raster_(trees.raster) {}

protected:
    /// Traces the rays of paths [begin, end), all of which start at the camera or none.
    void find_hits_of(uint32_t begin, uint32_t end) {
        const auto ray_of = [&](uint32_t i) {
            const PathState& path = paths_[begin + i];
            return Ray{path.origin, 0.0f, path.direction, kInfinity};
        };
        const auto accept_of = [&](uint32_t i) {
            const PathState& path = paths_[begin + i];
            return AcceptHit{scene_of(path), path.start, {}, key_of(path, false), path.time};
        };
        if (begin == end) return;
        const bool from_camera = paths_[begin].depth == 0;
        if (from_camera && raster_ != nullptr) {
            for (uint32_t i = begin; i < end; ++i) {
                hits_[i] = find_in_tile(*raster_, scene_of(paths_[i]), ray_of(i - begin), paths_[i].pixel,
                                        key_of(paths_[i], false));
            }
            return;
        }
        find_hits<Floats>(trees_, job_.picture.scene, from_camera, end - begin, ray_of, accept_of, hits_ + begin);
    }

    /// Traces the shadow rays.
    void find_occlusions_of_shadows() {
        const auto ray_of = [&](uint32_t i) {
            const ShadowRay& ray = shadow_rays_[i];
            return Ray{ray.origin, 0.0f, ray.direction, ray.t_max};
        };
        const auto accept_of = [&](uint32_t i) {
            const PathState& path = paths_[shadow_paths_[i]];
            return AcceptHit{scene_of(path), shadow_rays_[i].start, shadow_rays_[i].target, shadow_keys_[i],
                             path.time,      job_.passes_thin_walls};
        };
        find_occlusions<Floats>(trees_, shadows_, RayOrder::Together, ray_of, accept_of, occluded_);
    }

    /// Key of the path's ray at its depth, for blended surfaces only.
    uint32_t key_of(const PathState& path, bool is_shadow) const {
        return scene_of(path).any_alpha != 0 ? coin_key(sample_of(path), path.depth, is_shadow) : 0;
    }

    const SceneView& scene_of(const PathState& path) const { return job_.picture.scene_of(path.pixel); }
    SampleKey sample_of(const PathState& path) const { return sample_key<kBatched>(job_, path.pixel, path.sample); }

    /// Random numbers of at most eight paths at their present vertices.
    VertexWords<Words8> draw_for(const uint32_t* which, uint32_t count) const {
        SampleKeyOf<Words8> keys;
        Words8 depths = {};
        bool has_choices = has_lobes(job_.picture.scene.variant); // lobes have choices
        for (uint32_t lane = 0; lane < count; ++lane) {
            const PathState& path = paths_[which[lane]];
            set_lane(keys, lane, sample_of(path));
            depths[lane] = path.depth;
            has_choices = has_choices || may_end_by_chance(job_.settings, path.depth + 1);
        }
        return draw_vertex(job_.settings.sampler, keys, depths, has_choices);
    }

    // Prefetches what shading reads of the k-th of some hits; vertices follow once the indices have arrived.
    void prefetch_indices(const uint32_t* which, uint32_t k, uint32_t count) const {
        if (k >= count) return;
        const Hit& hit = hits_[which[k]];
        __builtin_prefetch(mesh_of_hit(which[k]).indices + 3 * uint64_t(hit.primitive));
    }
    void prefetch_vertices(const uint32_t* which, uint32_t k, uint32_t count) const {
        if (k >= count) return;
        const Hit& hit = hits_[which[k]];
        const MeshView& mesh = mesh_of_hit(which[k]);
        const TriangleIndices at = triangle_indices(mesh, hit.primitive);
        for (const uint32_t vertex : {at.a, at.b, at.c}) {
            __builtin_prefetch(mesh.positions + vertex);
            if (mesh.normals != nullptr) __builtin_prefetch(mesh.normals + vertex);
            if (mesh.uv[0] != nullptr) __builtin_prefetch(mesh.uv[0] + vertex);
        }
    }

    const PathJob& job_;
    uint32_t count_ = 0, going_on_ = 0; // paths; those that are not new
    uint32_t shadows_ = 0;
    PathState paths_[kPaths];
    Hit hits_[kPaths];
    ShadowRay shadow_rays_[kPaths]; // a path has at most one
    uint32_t shadow_keys_[kPaths], shadow_paths_[kPaths];
    bool occluded_[kPaths];

private:
    const MeshView& mesh_of_hit(uint32_t i) const {
        const SceneView& scene = scene_of(paths_[i]);
        return scene.meshes[scene.instances[hits_[i].instance].mesh];
    }

    const HostTrees& trees_;
    const TileRasterView* raster_;
};

template <class Listener>
class PathGroup : PathRays {
public:
    using PathRays::PathRays;

    bool is_full() const { return count_ == kPaths; }
    bool is_empty() const { return count_ == 0; }
    /// Adds the path that `make` returns.
    template <class Make>
    void add(const Make& make) {
        ::new (paths_ + count_++) PathState(make());
    }

    /// Advances each path to its next vertex. Paths that were added since the last call start at the camera.
    void advance(RayCounts& counts) {
        find_hits_of(0, going_on_);
        find_hits_of(going_on_, count_);
        shadows_ = 0;
        uint32_t missed = 0, alone = 0, diffuse = 0, glossy = 0;
        for (uint32_t i = 0; i < count_; ++i) {
            if (hits_[i].instance == kNoHit) {
                missed_[missed++] = i;
                continue;
            }
            switch (may_be_in_lanes(i) ? lane_lobes(this->scene_of(paths_[i]), paths_[i], hits_[i]) : LaneLobes::None) {
            case LaneLobes::None:
                alone_[alone++] = i;
                break;
            case LaneLobes::Diffuse:
                diffuse_[diffuse++] = i;
                break;
            case LaneLobes::Glossy:
                glossy_[glossy++] = i;
                break;
            }
        }
        shade_together(lanes_.shade_diffuse, diffuse_, diffuse);
        shade_together(lanes_.shade_glossy, glossy_, glossy);
        shade_alone(alone_, alone);
        VertexWords<Words8> words = {};
        for (uint32_t k = 0; k < missed; ++k) { // a medium may scatter rays that leave the scene
            if (k % kWords == 0 && job_.picture.scene.has_media != 0) {
                words = draw_for(missed_ + k, min(missed - k, kWords));
            }
            shade(missed_[k], words, k % kWords);
        }
        add_light();
        counts.shadow += shadows_;
        compact();
        counts.bounce += going_on_;
    }

private:
    bool may_be_in_lanes(uint32_t i) const {
        return paths_[i].depth >= depth_of_lanes_ &&
               Listener(job_).may_be_in_lanes(this->scene_of(paths_[i]), paths_[i], hits_[i]);
    }

    template <class Shade>
    void shade_together(const Shade& shade, const uint32_t* which, uint32_t count) {
        const uint32_t lanes = lanes_.lanes;
        for (uint32_t first = 0; first < count; first += lanes) {
            LaneVertices vertices = {.count = min(count - first, lanes), .paths = {}, .hits = {}};
            for (uint32_t lane = 0; lane < lanes; ++lane) {
                const uint32_t i = which[first + min(lane, vertices.count - 1)];
                vertices.paths[lane] = paths_ + i, vertices.hits[lane] = hits_ + i;
                prefetch_indices(which, first + lane + 2 * lanes, count);
                prefetch_vertices(which, first + lane + lanes, count);
            }
            std::array<uint32_t, kMaxLanes> keys;
            for (uint32_t lane = 0; lane < vertices.count; ++lane) {
                Listener(job_).vertex_in_lanes(*vertices.paths[lane], *vertices.hits[lane]);
                keys[lane] = key_of(*vertices.paths[lane], true);
            }
            const LaneResults results = shade(job_, vertices, shadow_rays_ + shadows_);
            for (uint32_t lane = 0; lane < vertices.count; ++lane) {
                const uint32_t i = which[first + lane];
                goes_on_[i] = (results.goes_on >> lane & 1) != 0;
                if ((results.has_shadow_ray >> lane & 1) == 0) continue;
                Listener(job_).shadow_in_lanes(kept_[i], shadow_rays_[shadows_], shadow_data_[shadows_] = {});
                shadow_keys_[shadows_] = keys[lane], shadow_paths_[shadows_++] = i;
            }
        }
    }

    void shade_alone(const uint32_t* which, uint32_t count) {
        VertexWords<Words8> words;
        for (uint32_t k = 0; k < count; ++k) {
            if (k % kWords == 0) words = draw_for(which + k, min(count - k, kWords));
            prefetch_indices(which, k + 16, count);
            prefetch_vertices(which, k + 8, count);
            shade(which[k], words, k % kWords);
        }
    }

    /// Shades the vertex of path i, or its miss, with the random numbers of a lane.
    void shade(uint32_t i, const VertexWords<Words8>& words, uint32_t lane) {
        const uint32_t key = key_of(paths_[i], true);
        const bool has_shadow_ray =
            shade_(job_, paths_[i], kept_[i], hits_[i], DrawnNumbers(words, lane),
                   VertexShadow<Listener>{shadow_rays_[shadows_], shadow_data_[shadows_]}, goes_on_[i]);
        if (!has_shadow_ray) return;
        shadow_keys_[shadows_] = key, shadow_paths_[shadows_++] = i;
    }

    void add_light() {
        find_occlusions_of_shadows();
        const Listener listener(job_);
        for (uint32_t i = 0; i < shadows_; ++i) {
            if (occluded_[i]) continue;
            const uint32_t path = shadow_paths_[i];
            paths_[path].radiance += shadow_rays_[i].contribution;
            listener.arrived(kept_[path], shadow_data_[i], shadow_rays_[i].contribution);
        }
    }

    void compact() {
        going_on_ = 0;
        for (uint32_t i = 0; i < count_; ++i) {
            if (!goes_on_[i]) {
                Listener(job_).ended(paths_[i].pixel, paths_[i].radiance, kept_[i]);
            } else if (going_on_++ != i) {
                paths_[going_on_ - 1] = paths_[i];
                kept_[going_on_ - 1] = kept_[i];
            }
        }
        count_ = going_on_;
    }

    const ShadeOnHost<Listener> shade_ = shading_for<Listener>(job_);
    const uint32_t depth_of_lanes_ = can_shade_lanes(job_) ? Listener::depth_of_lanes(job_) : kNoLaneDepth;
    const VertexShading& lanes_ = vertex_shading();
    uint32_t diffuse_[kPaths], glossy_[kPaths]; // paths in lanes
    uint32_t alone_[kPaths], missed_[kPaths];   // paths one by one, and without a hit
    bool goes_on_[kPaths];
    typename Listener::PathData kept_[kPaths];
    typename Listener::ShadowData shadow_data_[kPaths]; // the listener's data of shadow_rays_
};

template <class Listener>
void render_group(const PathJob& job, const LoopTrees& trees, const BeginOrder& order, PixelRange range,
                  RayCounts& counts) {
    PathGroup<Listener> group(job, trees);
    LaneSamples<Floats> samples(job.picture.camera, job.settings, job.picture.batch, job.film.frame.aims);
    const auto trace = [&](const auto& make) {
        group.add(make);
        while (group.is_full()) group.advance(counts);
    };
    for (uint32_t i = range.begin; i < range.end; ++i) {
        const uint32_t pixel = order.pixel(i);
        if (!samples.can_add(pixel)) samples.begin(trace);
        for (uint32_t k = 0; k < order.samples; ++k) {
            samples.add(pixel, order.first_sample + k);
            if (samples.is_full()) samples.begin(trace);
        }
    }
    samples.begin(trace);
    while (!group.is_empty()) group.advance(counts);
}

void render_range(const PathJob& job, const LoopTrees& trees, const BeginOrder& order, PixelRange range,
                  RayCounts& counts) {
    if (job.film.frame.is_there()) return render_group<ReuseListeners>(job, trees, order, range, counts);
    if (job.layers.is_there() || job.is_meter) return render_group<LayerListeners>(job, trees, order, range, counts);
    render_group<FilmListeners>(job, trees, order, range, counts);
}

} // namespace
} // namespace pertev
