#include "integrators/path/path_loop.h"

#include <type_traits>

#include "device_scene/find_hits.h"
#include "integrators/path/eight_samples.h"
#include "integrators/path/host_shading.h"
#include "integrators/path/shade_to_layers.h"

namespace pertev {
namespace {

constexpr uint32_t kPaths = 128; // side by side: 30 KB, of a cache of 1 MB that the trees want too

/// Of each path, where it stands in the automaton of light-path expressions; for those that ask for layers.
struct LayersOfGroup {
    const LightPathView& view; // may be none
    bool is_meter;
    LightPathState states[kPaths];
    LayerShadow shadows[kPaths + 1];
};
struct NoLayers {};

/// `Layers`: LayersOfGroup or NoLayers.
template <class Layers>
class PathGroup {
    static constexpr bool kHasLayers = std::is_same_v<Layers, LayersOfGroup>;

public:
    PathGroup(const PictureView& picture, const PathSettings& settings, const LoopTrees& trees, const FilmView& film,
              const Layers& layers)
        : picture_(picture), settings_(settings), trees_(trees.trees), raster_(trees.raster), film_(film),
          layers_(layers) {}

    bool is_full() const { return count_ == kPaths; }
    bool is_empty() const { return count_ == 0; }
    void add(const PathState& path) {
        if constexpr (kHasLayers) layers_.states[count_] = layers_.view.begin();
        paths_[count_++] = path;
    }

    /// Takes each path to its next vertex. Those that have been added since the last call start at the camera.
    void advance(RayCounts& counts) {
        find_hits_of(0, going_on_);
        find_hits_of(going_on_, count_);
        uint32_t shadows = 0;
        VertexWords<Words8> words;
        for (uint32_t i = 0; i < count_; ++i) {
            if (i % kWords == 0) words = draw_for(i);
            ask_for_indices(i + 16);
            ask_for_vertices(i + 8);
            Asked& asked = asked_[shadows];
            const uint32_t key = key_of(paths_[i], true);
            const bool wants_shadow = shade(i, DrawnNumbers(words, i % kWords), shadows);
            asked.start = {hits_[i].instance, hits_[i].primitive};
            asked.key = key, asked.path = i;
            shadows += wants_shadow ? 1 : 0;
        }
        add_light(shadows);
        counts.shadow += shadows;
        keep_those_that_go_on();
        counts.bounce += going_on_;
    }

private:
    struct Asked {
        ShadowRay ray;
        TriangleId start;
        uint32_t key, path;
    };

    /// What paths [begin, begin + 8) draw at the vertices that they have come to.
    VertexWords<Words8> draw_for(uint32_t begin) const {
        SampleKeyOf<Words8> keys;
        Words8 depths = {};
        bool has_choices = picture_.scene.known == MaterialsKnown::Nothing; // lobes
        for (uint32_t i = begin; i < begin + kWords && i < count_; ++i) {
            const PathState& path = paths_[i];
            set_lane(keys, i - begin, sample_key(settings_, path.pixel, path.sample));
            depths[i - begin] = path.depth;
            has_choices = has_choices || may_end_by_chance(settings_, path.depth + 1);
        }
        return draw_vertex(settings_.sampler, keys, depths, has_choices);
    }

    /// Takes path i over what it met; true where it asks for the shadow ray at place `shadow`.
    bool shade(uint32_t i, const DrawnNumbers& numbers, uint32_t shadow) {
        bool wants_shadow = false;
        if constexpr (kHasLayers) {
            goes_on_[i] = shade_hit_to_layers<MotionKnown::Perhaps>(
                picture_, settings_, film_, layers_.view, layers_.is_meter, layers_.states[i], paths_[i], hits_[i],
                numbers, asked_[shadow].ray, wants_shadow, layers_.shadows[shadow]);
            return wants_shadow;
        }
        LightSplit split;
        if (splits_light_) split.take_out(paths_[i], paths_[i].depth > 0 ? diffuse_[i] : Float4{0, 0, 0, 0});
        goes_on_[i] =
            shade_(picture_, settings_, film_, paths_[i], hits_[i], numbers, asked_[shadow].ray, wants_shadow);
        if (splits_light_) {
            split.put_back(paths_[i]);
            diffuse_[i] = split.diffuse;
        }
        return wants_shadow;
    }

    /// Of the path's ray at its depth, for the coins of blended surfaces; nothing else asks for it.
    uint32_t key_of(const PathState& path, bool is_shadow) const {
        return picture_.scene.any_alpha != 0 ? path_key(path, settings_.seed, is_shadow) : 0;
    }

    // What make_surface reads of hit i, asked for in time: its vertices are known once its indices are there.
    const MeshView* mesh_of(uint32_t i) const {
        if (i >= count_ || hits_[i].instance == kNoHit) return nullptr;
        return picture_.scene.meshes + picture_.scene.instances[hits_[i].instance].mesh;
    }
    void ask_for_indices(uint32_t i) const {
        if (const MeshView* mesh = mesh_of(i)) __builtin_prefetch(mesh->indices + 3 * uint64_t(hits_[i].primitive));
    }
    void ask_for_vertices(uint32_t i) const {
        const MeshView* const mesh = mesh_of(i);
        if (mesh == nullptr) return;
        const TriangleIndices at = triangle_indices(*mesh, hits_[i].primitive);
        for (const uint32_t vertex : {at.a, at.b, at.c}) {
            __builtin_prefetch(mesh->positions + vertex);
            if (mesh->normals != nullptr) __builtin_prefetch(mesh->normals + vertex);
            if (mesh->uv[0] != nullptr) __builtin_prefetch(mesh->uv[0] + vertex);
        }
    }

    void find_hits_of(uint32_t begin, uint32_t end) {
        const auto ray_of = [&](uint32_t i) {
            const PathState& path = paths_[begin + i];
            return Ray{path.origin, 0.0f, path.direction, kInfinity};
        };
        const auto accept_of = [&](uint32_t i) {
            const PathState& path = paths_[begin + i];
            return AcceptHit{picture_.scene, path.start, {}, key_of(path, false), path.time};
        };
        if (begin == end) return;
        const bool from_camera = paths_[begin].depth == 0;
        if (from_camera && raster_ != nullptr) {
            for (uint32_t i = begin; i < end; ++i) {
                hits_[i] = find_in_tile(*raster_, picture_.scene, ray_of(i - begin), paths_[i].pixel,
                                        key_of(paths_[i], false));
            }
            return;
        }
        const RayOrder order = from_camera ? RayOrder::Together : RayOrder::Scattered;
        if (from_camera && picture_.scene.any_hidden_back != 0) {
            const auto accept_camera = [&](uint32_t i) {
                return AcceptCameraHit{accept_of(i), paths_[begin + i].direction};
            };
            find_hits(trees_, end - begin, order, ray_of, accept_camera, hits_ + begin);
        } else {
            find_hits(trees_, end - begin, order, ray_of, accept_of, hits_ + begin);
        }
    }

    void add_light(uint32_t shadows) {
        const auto ray_of = [&](uint32_t i) {
            const ShadowRay& ray = asked_[i].ray;
            return Ray{ray.origin, 0.0f, ray.direction, ray.t_max};
        };
        const auto accept_of = [&](uint32_t i) {
            return AcceptHit{picture_.scene, asked_[i].start, asked_[i].ray.target, asked_[i].key,
                             paths_[asked_[i].path].time};
        };
        find_occlusions(trees_, shadows, RayOrder::Together, ray_of, accept_of, occluded_);
        for (uint32_t i = 0; i < shadows; ++i) {
            if (occluded_[i]) continue;
            const uint32_t path = asked_[i].path;
            paths_[path].radiance += asked_[i].ray.contribution;
            if constexpr (kHasLayers) {
                if (layers_.view.is_there())
                    add_to_layers(layers_.view, film_, paths_[path].pixel, layers_.shadows[i],
                                  asked_[i].ray.contribution);
            }
            if (tells_bounce_) film_.frame.first_bounce.add_sent(paths_[path].pixel, asked_[i].ray.sent);
            if (splits_light_) {
                const Rgb add = asked_[i].ray.diffuse;
                Float4& d = diffuse_[path];
                d = {d.x + add.r, d.y + add.g, d.z + add.b, d.w};
            }
        }
    }

    void keep_those_that_go_on() {
        going_on_ = 0;
        for (uint32_t i = 0; i < count_; ++i) {
            if (!goes_on_[i]) {
                finish(i);
            } else if (going_on_++ != i) {
                paths_[going_on_ - 1] = paths_[i];
                if (splits_light_) diffuse_[going_on_ - 1] = diffuse_[i];
                if constexpr (kHasLayers) layers_.states[going_on_ - 1] = layers_.states[i];
            }
        }
        count_ = going_on_;
    }

    void finish(uint32_t i) {
        const PathState& path = paths_[i];
        if (film_.frame.is_there()) {
            store_sample(film_, path.pixel, path.radiance, {diffuse_[i].x, diffuse_[i].y, diffuse_[i].z});
        } else {
            add_radiance(film_, path.pixel, path.radiance);
        }
    }

    const PictureView& picture_;
    const PathSettings& settings_;
    const HostTrees& trees_;
    const TileRasterView* raster_;
    const FilmView& film_;
    const ShadeOnHost shade_ = shading_for(picture_, film_);
    const bool splits_light_ = film_.frame.splits_light();
    const bool tells_bounce_ = film_.frame.first_bounce.tells_bounce();
    uint32_t count_ = 0, going_on_ = 0; // paths; of which those that are not new
    PathState paths_[kPaths];
    Float4 diffuse_[kPaths]; // LightSplit's, where a frame splits light
    Hit hits_[kPaths];
    bool goes_on_[kPaths];
    Asked asked_[kPaths + 1]; // one more: written before it is known whether it is wanted
    bool occluded_[kPaths];
    [[no_unique_address]] Layers layers_;
};

template <class Layers>
void render_group(const PictureView& picture, const PathSettings& settings, const LoopTrees& trees,
                  const FilmView& film, const Layers& layers, const BeginOrder& work, RayCounts& counts) {
    PathGroup<Layers> group(picture, settings, trees, film, layers);
    const uint32_t width = picture.camera.width, height = picture.camera.height;
    EightSamples samples(picture.camera, settings);
    const auto trace = [&](const PathState& path) {
        group.add(path);
        while (group.is_full()) group.advance(counts);
    };
    for (uint32_t i = 0; i < work.pixels; ++i) {
        const uint32_t pixel = ordered_pixel(work.first_place + i, width, height);
        for (uint32_t k = 0; k < work.samples; ++k) {
            samples.add(pixel, work.first_sample + k);
            if (samples.is_full()) samples.begin(trace);
        }
    }
    samples.begin(trace);
    while (!group.is_empty()) group.advance(counts);
}

} // namespace

void render_pixels(const PictureView& picture, const PathSettings& settings, const LoopTrees& trees,
                   const FilmView& film, const LightPathView& layers, bool is_meter, const BeginOrder& work,
                   RayCounts& counts) {
    if (!layers.is_there() && !is_meter) return render_group(picture, settings, trees, film, NoLayers{}, work, counts);
    render_group(picture, settings, trees, film, LayersOfGroup{layers, is_meter, {}, {}}, work, counts);
}

} // namespace pertev
