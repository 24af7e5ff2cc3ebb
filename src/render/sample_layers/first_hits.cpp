#include "render/sample_layers/first_hits.h"

#include <algorithm>

#include "base/error.h"
#include "device/launch.h"
#include "render/sample_layers/matte_target.h"

namespace pertev {
namespace {

/// Returns the elements of a film's target from the first row of its view on; null without a target.
template <class Target>
auto* array_of(const Target* target, const Film& film) {
    return target == nullptr ? nullptr : target->elements().data() + std::size_t{film.first_row()} * film.width();
}

FirstHitArrays arrays_of(const Film& film) {
    return {array_of(find_target<UvTarget>(film), film), array_of(find_matte_target(film, kObjectMattes), film),
            array_of(find_matte_target(film, kMaterialMattes), film)};
}

} // namespace

void FirstHits::reserve(uint64_t pixels, bool has_times) {
    const auto rays = static_cast<std::size_t>(std::min<uint64_t>(pixels, at_once_));
    rays_.grow(queue_, rays, "rays of first hits");
    keys_.grow(queue_, rays, "rays of first hits");
    records_.grow(queue_, rays, "first hits");
    instances_.grow(queue_, rays, "first hits");
    if (has_times) times_.grow(queue_, rays, "rays of first hits");
}

void FirstHits::upload(const std::shared_ptr<const MatteNames>& names) {
    if (!names || names == names_) return;
    queue_.wait();
    const auto put = [&](const std::vector<uint32_t>& ids, Buffer<uint32_t>& to) {
        to = {queue_, ids.size(), "ids of mattes"};
        to.upload(std::span<const uint32_t>(ids));
    };
    put(names->object_ids, object_ids_);
    put(names->material_ids, material_ids_);
    names_ = names;
}

void FirstHits::add(const PictureView& picture, SceneTracer& tracer, SamplerKind sampler, uint32_t seed,
                    const std::shared_ptr<const MatteNames>& names, uint32_t first, uint32_t count, const Film& film) {
    const PixelWindow window = film.view().window;
    if (uint32_t* const counts = array_of(find_target<CountTarget>(film), film))
        launch(queue_, "count_samples", window.count(), CountSamples{counts, count});
    const FirstHitArrays into = arrays_of(film);
    if (into.are_empty()) return queue_.wait();
    PERTEV_CHECK(names != nullptr || (into.objects == nullptr && into.materials == nullptr));
    const SceneView& scene = picture.scene;
    const bool has_times = scene.motions.is_there();
    reserve(window.count(), has_times);
    upload(names);
    uint32_t* const keys = scene.any_alpha != 0 ? keys_.data() : nullptr;
    float* const times = has_times ? times_.data() : nullptr;
    const HitQueueView hits = {records_.data(), instances_.data()};
    for (uint32_t sample = first; sample < first + count; ++sample) {
        for (uint32_t begin = 0; begin < window.count(); begin += at_once_) {
            const uint32_t rays = std::min(window.count() - begin, at_once_);
            launch(queue_, "make_sample_rays", rays,
                   MakeSampleRays{picture.camera, sampler, seed, sample, window, begin, rays_.data(), keys, times});
            tracer.find_hits(RayKind::Camera, {.rays = rays_.data(), .keys = keys, .times = times}, rays, hits);
            launch(queue_, "add_first_hits", rays,
                   AddFirstHits{scene, hits, window, begin, object_ids_.data(), material_ids_.data(), into});
        }
    }
    queue_.wait();
}

} // namespace pertev
