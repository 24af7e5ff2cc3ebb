#include "restir/restir.h"

#include <cstring>

#include "base/error.h"
#include "device/launch.h"
#include "restir/add_direct_light.h"
#include "restir/add_indirect_light.h"
#include "restir/initial_candidates.h"
#include "restir/initial_gi_reservoirs.h"
#include "shading/with_stacks.h"

namespace pertev {
namespace {

constexpr uint32_t kMaxTraces = 20; // maximum number of traces per frame
constexpr std::size_t kBounceArrays = 4;

} // namespace

Restir::Restir(Queue& queue, uint32_t width, uint32_t height, RestirLight light, ShadingVariant variant)
    : queue_(&queue), width_(width), height_(height), pixels_(width * height), light_(light),
      hit_emitters_(queue, pixels_, "reservoirs"), reservoirs_(queue, std::size_t(2) * pixels_, "reservoirs"),
      seen_before_(queue, std::size_t(2) * pixels_, "reservoirs"),
      receivers_(queue, has_lobes(variant) ? 0 : pixels_, "receivers"), neighbours_(queue, pixels_, "reservoirs"),
      shares_(queue, pixels_, "reservoirs"), rays_(queue, pixels_, "reservoirs' rays"),
      ray_ends_(queue, std::size_t(2) * pixels_, "reservoirs' rays"),
      ray_words_(queue, std::size_t(2) * pixels_, "reservoirs' rays"),
      ray_counts_(queue, kMaxTraces, "reservoirs' rays") {
    if (light == RestirLight::Indirect) {
        bounces_ = {queue, std::size_t(2) * pixels_, "reservoirs"};
        bounce_numbers_ = {queue, kBounceArrays * pixels_, "first bounces"};
    }
    shares_.zero();
    ray_counts_.zero();
}

FirstBounceView Restir::first_bounce() const {
    if (light_ != RestirLight::Indirect) return {hit_emitters_.data()};
    Float4* const numbers = bounce_numbers_.data();
    const std::size_t pixels = pixels_;
    return {hit_emitters_.data(), numbers, numbers + pixels, numbers + 2 * pixels, numbers + 3 * pixels};
}

std::vector<RowArray> Restir::rows_of_history() const {
    if (!has_history_) return {};
    std::vector<RowArray> arrays = {{reservoirs_.data() + pixels_, width_ * sizeof(LightReservoir), height_},
                                    {seen_before_.data(), width_ * sizeof(Float4), height_},
                                    {seen_before_.data() + pixels_, width_ * sizeof(Float4), height_}};
    if (light_ == RestirLight::Indirect) {
        arrays.push_back({bounces_.data() + pixels_, width_ * sizeof(BounceReservoir), height_});
    }
    return arrays;
}

bool Restir::are_of_scene(std::span<const std::vector<std::byte>> arrays, std::span<const uint32_t> triangle_counts) {
    const auto is_triangle = [&](uint32_t instance, uint32_t primitive) {
        return instance < triangle_counts.size() && primitive < triangle_counts[instance];
    };
    const auto all_are = [&]<class Element>(std::size_t array, const Element&, const auto& is_sound) {
        for (std::size_t at = 0; at + sizeof(Element) <= arrays[array].size(); at += sizeof(Element)) {
            Element element;
            std::memcpy(&element, arrays[array].data() + at, sizeof element);
            if (!is_sound(element)) return false;
        }
        return true;
    };
    // An empty reservoir is not looked at, and neither is a hit where there is none.
    const auto has_light = [&](const LightReservoir& reservoir) {
        const EmitterPoint& point = reservoir.point;
        if (!(reservoir.weight > 0) || !point.is_there()) return true;
        switch (point.kind()) {
        case SourceKind::Punctual:
        case SourceKind::Environment:
            return true;
        case SourceKind::Triangle:
            break;
        }
        return is_triangle(point.instance, point.index);
    };
    const auto has_surface = [&](const Float4& hit) {
        return bits_of(hit.x) == kNoHit || is_triangle(bits_of(hit.x), bits_of(hit.y));
    };
    const auto has_point = [&](const BounceReservoir& reservoir) {
        return !(reservoir.weight > 0) || is_triangle(reservoir.instance, reservoir.primitive);
    };
    return all_are(0, LightReservoir(), has_light) && all_are(1, Float4(), has_surface) &&
           (arrays.size() < 4 || all_are(3, BounceReservoir(), has_point));
}

uint64_t Restir::rays() const {
    uint64_t sum = 0;
    for (const uint32_t count : ray_counts_.download()) sum += count;
    return sum;
}

/// Arguments of the steps of a frame.
struct Restir::Frame {
    const NoisyFrameView& noisy;
    const FilmView& film;
    const SceneView& scene;
    PixelSurfaces here;
    GBufferView last; // the previous frame
    const RestirSettings& settings;
    SceneTracer& tracer;
};

void Restir::add(const NoisyFrame& noisy, const PictureView& picture, const SampleNumbers& numbers, SceneTracer& tracer,
                 const PreviousScene& before, const ChangedLight& change, const RestirSettings& settings,
                 LightSelection selection) {
    PERTEV_CHECK(noisy.width() == width_ && noisy.height() == height_);
    const FilmView film = noisy.film_view();
    Frame frame = {noisy.view(),
                   film,
                   picture.scene,
                   {noisy.view(), picture.camera, numbers.sampler, numbers.sample, numbers.seed, numbers.filters},
                   {seen_before_.data(), seen_before_.data() + pixels_},
                   settings,
                   tracer};
    ray_counts_.zero();
    traced_ = 0;
    rows_ = own_rows(others_, height_);
    make_initial(selection, frame);
    if (has_history_ && settings.history > 0) {
        const FrameCameras cameras = {picture.camera.view, camera_before_.view, width_, height_};
        reuse_before(before, cameras, change, frame);
    }
    if (others_ != nullptr) take_rows(frame);
    reuse_beside(frame);
    const std::size_t first = std::size_t(rows_.first) * width_, bytes = rows_.count() * width_ * sizeof(Float4);
    queue_->copy_on_device(frame.last.hit + first, frame.noisy.hit + first, bytes);
    queue_->copy_on_device(frame.last.normal + first, frame.noisy.normal + first, bytes);
    camera_before_ = picture.camera;
    numbers_before_ = numbers;
    has_history_ = true;
}

/// Makes the reservoirs of this frame's own samples.
void Restir::make_initial(LightSelection selection, Frame& frame) {
    const SceneView& scene = frame.scene;
    PixelSurfaces& here = frame.here;
    if (has_bounces())
        with_textures(scene.variant, [&]<ShadingVariant kVariant>() {
            launch_in_band(*queue_, "initial_gi_reservoirs", rows_, width_,
                           MakeInitialGiReservoirs<kVariant>{scene, here, frame.film, bounces_.data()});
        });
    const auto sample_candidates = [&]<class Choice>() {
        with_textures(scene.variant, [&]<ShadingVariant kVariant>() {
            launch_in_band(*queue_, "initial_candidates", rows_, width_,
                           SampleInitialCandidates<kVariant, Choice>{scene, here, hit_emitters_.data(),
                                                                     reservoirs_.data(), receivers_.data(),
                                                                     frame.settings.candidates});
        });
    };
    const bool is_by_tree = uses_light_tree(selection, scene);
    is_by_tree ? sample_candidates.template operator()<ChosenByTree>()
               : sample_candidates.template operator()<ChosenByPower>();
    here.stored = receivers_.data();
    test_visibility(scene, here, reservoirs_.data(), frame.tracer, 0);
}

/// Combines this frame's reservoirs with those of the previous one.
void Restir::reuse_before(const PreviousScene& before, const FrameCameras& cameras, const ChangedLight& change,
                          const Frame& frame) {
    const PixelSurfaces there = {
        frame.last,           camera_before_,         numbers_before_.sampler, numbers_before_.sample,
        numbers_before_.seed, numbers_before_.filters};
    launch_in_band(*queue_, "find_before", rows_, width_,
                   FindBefore{frame.scene, before, cameras, frame.noisy, frame.last, change,
                              static_cast<float>(frame.settings.history), neighbours_.data()});
    LightReservoir *const fresh = reservoirs_.data(), *const kept = fresh + pixels_;
    reuse(frame.scene, frame.here, there, fresh, kept, fresh, 2, frame.tracer, kGroupReuse);
    if (!has_bounces()) return;
    BounceReservoir *const fresh_bounces = bounces_.data(), *const kept_bounces = fresh_bounces + pixels_;
    reuse(frame.scene, frame.here, there, fresh_bounces, kept_bounces, fresh_bounces, 2, frame.tracer, kGroupReuse + 1);
}

/// Takes the rows beside this device's own that other devices have made.
void Restir::take_rows(const Frame& frame) {
    std::vector<RowArray> arrays = {{reservoirs_.data(), width_ * sizeof(LightReservoir), height_},
                                    {frame.noisy.hit, width_ * sizeof(Float4), height_},
                                    {frame.noisy.normal, width_ * sizeof(Float4), height_}};
    if (receivers_.size() > 0) arrays.push_back({receivers_.data(), width_ * sizeof(DiffuseReceiver), height_});
    if (has_bounces()) arrays.push_back({bounces_.data(), width_ * sizeof(BounceReservoir), height_});
    others_->take(arrays, rows_.grown(FindNeighbours::reach(frame.settings.radius), height_));
}

/// Combines the reservoirs of neighbours into those that the next frame begins with, and adds their light to the frame.
void Restir::reuse_beside(const Frame& frame) {
    const SceneView& scene = frame.scene;
    const PixelSurfaces& here = frame.here;
    launch_in_band(*queue_, "find_beside", rows_, width_,
                   FindNeighbours{here, frame.settings.neighbours, frame.settings.radius, neighbours_.data()});
    LightReservoir *const fresh = reservoirs_.data(), *const kept = fresh + pixels_;
    reuse(scene, here, here, fresh, fresh, kept, kMaxEntries, frame.tracer, kGroupReuse + 2);
    with_textures(scene.variant, [&]<ShadingVariant kVariant>() {
        launch_in_band(*queue_, "add_direct_light", rows_, width_,
                       AddDirectLight<kVariant>{scene, here, kept, frame.film});
    });
    if (!has_bounces()) return;
    BounceReservoir *const fresh_bounces = bounces_.data(), *const kept_bounces = fresh_bounces + pixels_;
    reuse(scene, here, here, fresh_bounces, fresh_bounces, kept_bounces, kMaxEntries, frame.tracer, kGroupReuse + 3);
    with_textures(scene.variant, [&]<ShadingVariant kVariant>() {
        launch_in_band(*queue_, "add_indirect_light", rows_, width_,
                       AddIndirectLight<kVariant>{scene, here, kept_bounces, frame.film});
    });
}

/// Combines `own` with reservoirs of `others` at the selected neighbours into `to`, for at most `entries` pixels
/// each.
template <class Reservoir>
void Restir::reuse(const SceneView& scene, const PixelSurfaces& here, const PixelSurfaces& there, const Reservoir* own,
                   const Reservoir* others, Reservoir* to, uint32_t entries, SceneTracer& tracer, uint32_t group) {
    with_textures(scene.variant, [&]<ShadingVariant kVariant>() {
        launch_in_band(*queue_, "reuse_reservoirs", rows_, width_,
                       ReuseReservoirs<Reservoir, kVariant>{scene, here, there, own, others, neighbours_.data(), to,
                                                            shares_.data(), group});
    });
    for (uint32_t entry = 0; entry < entries; ++entry) {
        test_visibility(scene, entry == 0 ? here : there, to, tracer, entry);
    }
    launch_in_band(*queue_, "finish_reuse", rows_, width_, FinishReuse<Reservoir>{to});
}

/// Finds whether the pixel of entry `entry` sees the points of `reservoirs`.
template <class Reservoir>
void Restir::test_visibility(const SceneView& scene, const PixelSurfaces& surfaces, Reservoir* reservoirs,
                             SceneTracer& tracer, uint32_t entry) {
    PERTEV_CHECK(traced_ < kMaxTraces);
    if (rows_.is_empty()) return;
    uint32_t* const count = ray_counts_.data() + traced_++;
    const VisibilityRaysView rays = {
        rays_.data(), ray_ends_.data(), ray_ends_.data() + pixels_, ray_words_.data(), ray_words_.data() + pixels_,
        count};
    const uint32_t pixels = rows_.count() * width_;
    launch(*queue_, "queue_visibility_rays", pixels,
           QueueVisibilityRays<Reservoir>{scene, surfaces, neighbours_.data(), shares_.data(), reservoirs, rays, entry,
                                          rows_.first * width_});
    const WorkCount visibility_rays = {pixels, count};
    tracer.find_occlusions(rays.query(), visibility_rays, {nullptr, rays.keys});
    launch(*queue_, "count_visible", visibility_rays, CountVisible<Reservoir>{rays, shares_.data(), reservoirs, entry});
}

} // namespace pertev
