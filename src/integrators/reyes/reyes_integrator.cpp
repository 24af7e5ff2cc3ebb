#include "integrators/reyes/reyes_integrator.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "device/launch.h"
#include "integrators/reyes/shade_samples.h"

namespace pertev {
namespace {

constexpr uint64_t kMaxSamplesAtOnce = uint64_t(1) << 23; // samples of all pixels, but at least one of each
constexpr double kMaxPiecesOfTriangle = 64;               // added to kMaxWorkOfPixel
constexpr uint32_t kRoundsPerUpdate = 8;                  // rounds between updates of the farthest depths
constexpr uint32_t kStack = 1u << 19, kMaxPieces = 1u << 16;

// Why the stack suffices: a round takes at least `kMinRound` pieces off the top and leaves at most four of each, one
// level deeper. Thus a piece 4 kMinRound higher is one level deeper, and no level exceeds kMaxLevels. Larger rounds
// never use the reserve for that.
constexpr uint32_t kMinRound = 1024, kReserve = 4 * kMinRound * (kMaxLevels + 2);

uint32_t pieces_at_once(uint32_t height) {
    const uint32_t capacity_left = height < kStack - kReserve ? (kStack - kReserve - height) / 4 : 0;
    return std::min({height, std::max(kMinRound, capacity_left), kMaxPieces});
}

uint64_t samples_held(uint64_t pixels, uint32_t samples) {
    return std::clamp(ReyesIntegrator::samples_at_once(pixels), 1u, std::max(samples, 1u)) * pixels;
}

uint64_t texels(const HeightMaps& maps) {
    uint64_t sum = 0;
    for (const HeightMap& map : maps) sum += map.heights.pixels.size();
    return sum;
}

/// Returns the number of materials up to the last one with heights.
uint64_t materials_of(const HeightMaps& maps) {
    uint64_t count = 0;
    for (const HeightMap& map : maps) count = std::max(count, uint64_t(map.material) + 1);
    return count;
}

/// Returns the maximum of |scale (h - middle)|.
float reach_of(const HeightMap& map) {
    float reach = 0;
    for (const float h : map.heights.pixels) reach = std::max(reach, std::abs(map.scale * (h - map.middle)));
    return reach * (1 + 0x1p-20f);
}

} // namespace

uint32_t ReyesIntegrator::samples_at_once(uint64_t pixels) {
    return static_cast<uint32_t>(std::max<uint64_t>(kMaxSamplesAtOnce / pixels, 1));
}

void ReyesIntegrator::reserve(const WorkSize& size) {
    const uint64_t all = samples_held(size.pixels(), size.samples);
    count_.grow(queue_, 2, "pieces of triangles");
    positions_.grow(queue_, all, "positions of samples");
    nearest_.grow(queue_, all, "samples' nearest triangles");
    split_paths_.grow(queue_, all, "samples' micropolygons");
    next_.grow(queue_, all, "lists of samples");
    heads_.grow(queue_, size.pixels(), "lists of samples");
    far_.grow(queue_, size.pixels(), "farthest samples");
    stack_.grow(queue_, kStack, "pieces of triangles");
    pieces_.grow(queue_, kMaxPieces, "pieces of triangles");
    if (!settings_.heights || settings_.heights == uploaded_) return;
    uploaded_ = nullptr;
    heights_ = Buffer<float>(), displacements_ = Buffer<DisplacementView>(); // freed before the new allocations
    heights_ = Buffer<float>(queue_, texels(*settings_.heights), "heights");
    displacements_ = Buffer<DisplacementView>(queue_, materials_of(*settings_.heights), "heights");
}

void ReyesIntegrator::begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) {
    if (picture.scene.triangle_count >= kNoHit) {
        throw Error(ErrorCode::OverLimit, "integrator", "reyes",
                    fmt::format("{} triangles in all instances of the scene; the limit is {}",
                                picture.scene.triangle_count, kNoHit - 1));
    }
    IntegratorBase::begin(picture, tracer, samples);
    camera_ = make_pinhole(picture.camera);
    light_ = {settings_.ambient, settings_.max_depth};
    const LightSetView& lights = picture.scene.lights;
    if (!settings_.has_ambient && lights.has_environment()) light_.ambient = lights.environment.mean;
    if (settings_.heights && settings_.heights != uploaded_) upload_heights();
}

void ReyesIntegrator::upload_heights() {
    std::vector<DisplacementView> views(displacements_.size());
    uint64_t at = 0;
    for (const HeightMap& map : *settings_.heights) {
        heights_.upload_at(at, map.heights.pixels);
        views[map.material] = {heights_.data() + at, map.heights.width, map.heights.height, map.scale,
                               map.middle,           reach_of(map)};
        at += map.heights.pixels.size();
    }
    displacements_.upload(views);
    uploaded_ = settings_.heights;
}

/// Throws Error(OverLimit) for too much work: heights that are large relative to the scene fold its surfaces over each
/// other without end. Because hidden pieces are found in arbitrary order, two runs may differ by some pieces before
/// this limit.
void ReyesIntegrator::check_work(uint64_t pieces, uint32_t wide) const {
    if (!settings_.heights) return;
    const uint64_t pixels = uint64_t(picture_.camera.width) * picture_.camera.height;
    const double finer = 1 / std::min(1.0, static_cast<double>(settings_.shading_rate));
    const double most = kMaxPiecesOfTriangle * static_cast<double>(picture_.scene.triangle_count) +
                        static_cast<double>(max_work(pixels)) * finer * finer;
    if (static_cast<double>(pieces) <= most && wide <= max_wide(pixels)) return;
    throw Error(ErrorCode::OverLimit, "displacement", "",
                fmt::format("surfaces are displaced so far that dicing does not end (over {} pieces per pixel); use a "
                            "smaller SCALE or a larger `shading_rate`",
                            kMaxWorkOfPixel));
}

template <HidingPass kPass>
bool ReyesIntegrator::hide(const ReyesPass& pass, const std::function<bool()>& goes_on) {
    const PiecesView pieces = {stack_.data(), pieces_.data(), count_.data(), kStack};
    const auto triangles = static_cast<uint32_t>(picture_.scene.triangle_count);
    uint32_t height = 0, round = 0;
    uint64_t taken_in_all = 0;
    Stopwatch since_request;
    queue_.zero(count_.data() + 1, sizeof(uint32_t));
    for (uint32_t begun = 0; height > 0 || begun < triangles; ++round) {
        if (is_abandoned()) return false;
        if (since_request.seconds() > 0.1) {
            if (!goes_on()) return false;
            since_request = {};
        }
        const bool updates = kPass == HidingPass::FindNearest ? round % kRoundsPerUpdate == 0 : round == 0;
        if (updates) launch(queue_, "find_far", pass.samples.pixels(), FindFar{pass.samples});
        const uint32_t taken = pieces_at_once(height);
        const uint32_t more = taken == height ? std::min(kMaxPieces - taken, triangles - begun) : 0;
        launch(queue_, "take_pieces", taken + more, TakePieces{pieces, height, taken, begun});
        launch(queue_, "split_pieces", taken + more, SplitPieces<kPass>{pass, pieces});
        begun += more;
        uint32_t counts[2]; // pieces on the stack; wide micropolygons
        queue_.copy_to_host(counts, count_.data(), sizeof counts);
        height = counts[0];
        PERTEV_CHECK(height <= kStack);
        taken_in_all += taken + more;
        check_work(taken_in_all, counts[1]);
    }
    return true;
}

void ReyesIntegrator::render(uint32_t first, uint32_t count, const FilmView& film) {
    render_while(first, count, film, [] { return true; });
}

uint32_t ReyesIntegrator::render_while(uint32_t first, uint32_t count, const FilmView& film,
                                       const std::function<bool()>& goes_on) {
    check_sums(film);
    const uint32_t pixels = picture_.camera.width * picture_.camera.height;
    const auto at_once = static_cast<uint32_t>(std::min<uint64_t>(count, positions_.size() / pixels));
    DisplacementsView displacements;
    if (settings_.heights) displacements = {displacements_.data(), static_cast<uint32_t>(displacements_.size())};
    for (uint32_t done = 0; done < count; done += at_once) {
        const uint32_t now = std::min(at_once, count - done);
        const ReyesPass pass = {camera_,
                                picture_,
                                displacements,
                                static_cast<double>(settings_.shading_rate),
                                light_,
                                settings_.seed,
                                settings_.heights ? count_.data() + 1 : nullptr,
                                {positions_.data(), nearest_.data(), split_paths_.data(), next_.data(), heads_.data(),
                                 far_.data(), picture_.camera.width, picture_.camera.height, first + done, now}};
        nearest_.fill(0xff);     // kNothingThere
        split_paths_.fill(0xff); // kNoSplitPath
        heads_.fill(0xff);       // kNoSample
        launch(queue_, "place_samples", pixels * now,
               PositionSamples{picture_.camera, settings_.sampler, settings_.seed, pass.samples});
        if (!hide<HidingPass::FindNearest>(pass, goes_on) || !hide<HidingPass::FindMicropolygon>(pass, goes_on)) {
            queue_.wait();
            return done;
        }
        launch_for_pixels("shade_samples", ShadeSamples{pass, film});
    }
    queue_.wait();
    return count;
}

} // namespace pertev
