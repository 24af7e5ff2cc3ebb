#include "integrators/irradiance_cache/irradiance_cache_integrator.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "base/error.h"
#include "base/parallel_for.h"
#include "integrators/irradiance_cache/do_in_parts.h"
#include "integrators/irradiance_cache/overture_progress.h"
#include "integrators/irradiance_cache/run_irradiance_cache.h"

namespace pertev {
namespace {

constexpr std::size_t kMostBytes = std::size_t(1) << 30; // of a device
constexpr uint32_t kLoopWalks = 256;                     // of a thread, at once
constexpr uint64_t kLoopRange = 256;                     // walks at least, that a thread takes at once
constexpr uint32_t kLeastWalks = 32;

enum : std::size_t { kMissed, kInvalid, kCounts }; // of counts_

WalkRoom room_of(uint32_t walks) { return {walks, 0, 1}; }
std::size_t bytes_in_flight(uint32_t walks, uint32_t cells) {
    return bytes_of(room_of(walks)) + cache_walk_bytes(walks, cells);
}
uint32_t cells_of(const IrradianceCacheSettings& cache) { return make_hemisphere_grid(cache.hemisphere_rays).cells(); }

/// Of all at once: the picture's, or all rays of some records. No less than one record's.
uint32_t walks_at_once(const IrradianceCacheSettings& cache, uint64_t pixels, uint32_t batch) {
    const std::size_t each = bytes_in_flight(kLeastWalks, kLeastWalks) / kLeastWalks;
    const uint64_t wanted = std::max<uint64_t>(pixels, uint64_t(cells_of(cache)) * 64);
    const uint64_t most = std::min<uint64_t>({wanted, batch, kMostBytes / each});
    return static_cast<uint32_t>(std::max<uint64_t>(most, cells_of(cache)));
}
void lay_out_both(WalksView& walks, CacheWalksView& cache, std::byte* memory, uint32_t count, uint32_t cells) {
    lay_out(walks, memory, room_of(count));
    lay_out(cache, memory + bytes_of(room_of(count)), count, cells);
}

/// What a thread of the CPU runs walks in.
struct ThreadMemory {
    std::vector<Float4> memory;
    WalksInThread way;

    ThreadMemory(const HostTrees& trees, CacheJob& job, uint32_t cells)
        : memory(bytes_in_flight(kLoopWalks, cells) / sizeof(Float4) + 1), way(trees, room_of(kLoopWalks)) {
        lay_out_both(job.walk.walks, job.cache, reinterpret_cast<std::byte*>(memory.data()), kLoopWalks, cells);
        *job.walk.walks.counts = {};
    }
};

/// Runs walks [begin, end) of the job, so many at once.
template <class Way, class Run>
void run_in_parts(Way& way, CacheJob& job, uint64_t begin, uint64_t end, uint32_t at_once, const Run& run) {
    for (job.walk.first = begin; job.walk.first < end; job.walk.first += at_once) {
        job.walk.count = static_cast<uint32_t>(std::min<uint64_t>(at_once, end - job.walk.first));
        run(way, job);
    }
}

FilmView film_of_cells(const CacheWalksView& cache, uint64_t* invalid, uint32_t cells) {
    return {cache.light, nullptr, invalid, 3, 0, cells, 1, {}};
}

} // namespace

IrradianceCacheIntegrator::IrradianceCacheIntegrator(Queue& queue, const SubpathSettings& settings,
                                                     const IrradianceCacheSettings& cache, bool in_loop, uint32_t batch)
    : queue_(queue), settings_(settings), cache_settings_(cache), in_loop_(in_loop), batch_(batch), store_(queue),
      seen_(queue) {}

std::size_t IrradianceCacheIntegrator::predicted_bytes(const IrradianceCacheSettings& cache, uint64_t pixels,
                                                       uint32_t batch, bool in_loop, bool on_cuda) {
    std::size_t bytes = RecordStore::predicted_bytes(pixels) + kCounts * sizeof(uint64_t) + sizeof(MirroredLamps);
    if (!on_cuda) bytes += RecordStore::predicted_host_bytes(pixels);
    if (in_loop) return bytes;
    const uint32_t walks = walks_at_once(cache, pixels, batch);
    return bytes + bytes_in_flight(walks, walks);
}

std::size_t IrradianceCacheIntegrator::bytes() const {
    return memory_.size() + store_.bytes() + counts_.size() * sizeof(uint64_t) +
           mirrored_.size() * sizeof(MirroredLamps);
}

const HostTrees* IrradianceCacheIntegrator::trees_of_loop() const { return in_loop_ ? tracer_->host_trees() : nullptr; }

void IrradianceCacheIntegrator::begin(const PictureView& picture, SceneTracer& tracer, uint32_t) {
    picture_ = picture;
    tracer_ = &tracer;
    rays_ = {};
    picture_settings_ = settings_;
    picture_cache_ = cache_settings_;
    const uint64_t pixels = uint64_t(picture.camera.width) * picture.camera.height;
    if (!std::exchange(is_same_picture_, false)) has_records_ = false;
    store_.make_room(pixels);
    if (counts_.size() == 0) counts_ = {queue_, kCounts, "counts of irradiance caching"};
    queue_.zero(counts_.data() + kMissed, sizeof(uint64_t));
    if (mirrored_.size() == 0) mirrored_ = {queue_, 1, "counts of mirrors and lamps"};
    queue_.zero(mirrored_.data(), sizeof(MirroredLamps));
    launch(queue_, "count mirrored lamps", picture.scene.instance_count,
           CountMirroredLamps{picture.scene, mirrored_.data()});
    if (trees_of_loop() != nullptr) return;
    walks_in_flight_ = walks_at_once(picture_cache_, pixels, batch_);
    const std::size_t bytes = bytes_in_flight(walks_in_flight_, walks_in_flight_);
    if (memory_.size() < bytes) {
        memory_ = {}; // before there is more
        memory_ = {queue_, bytes, "walks of irradiance caching"};
    }
    lay_out_both(walks_, cache_, memory_.data(), walks_in_flight_, walks_in_flight_);
}

std::vector<IrradianceRecord> IrradianceCacheIntegrator::records() const {
    std::vector<IrradianceRecord> records(store_.count());
    queue_.copy_to_host(records.data(), store_.records(), records.size() * sizeof(IrradianceRecord));
    return records;
}

uint64_t IrradianceCacheIntegrator::missed_lookups() const {
    uint64_t missed = 0;
    queue_.copy_to_host(&missed, counts_.data() + kMissed, sizeof missed);
    return missed;
}

CacheJob IrradianceCacheIntegrator::make_job(uint32_t seed) const {
    CacheJob job = {};
    job.walk.scene = {picture_, picture_settings_, {}, false};
    job.walk.scene.settings.seed ^= seed;
    job.records = store_.view();
    job.missed = counts_.data() + kMissed;
    job.mirrored = mirrored_.data();
    return job;
}

void IrradianceCacheIntegrator::render(uint32_t first, uint32_t count, const FilmView& film) {
    PERTEV_CHECK(!film.frame.is_there());
    if (count == 0) return;
    if (!make_ready([this](double) { return !is_abandoned(); })) return;
    if (first == 0) tell_invalid(film.invalid);
    const uint32_t pixels = picture_.camera.width * picture_.camera.height;
    CacheJob job = make_job(0);
    job.walk.film = film;
    job.shows_records = picture_cache_.show_records;
    const float bright = 4.0f * store_.mean_luminance();
    job.mark = {bright, 0.35f * bright, 0};
    job.walk.samples = {0, pixels, first, count};
    run_walks(job, 0, job.walk.samples.count(), [this](auto& way, const CacheJob& part) {
        if (!is_abandoned()) run_picture(way, part);
    });
    rays_.camera += job.walk.samples.count();
}

/// What is invalid of the records is told with sample 0, once, however the work is split.
void IrradianceCacheIntegrator::tell_invalid(uint64_t* invalid) {
    uint64_t of_records = 0, so_far = 0;
    queue_.copy_to_host(&of_records, counts_.data() + kInvalid, sizeof of_records);
    if (of_records == 0) return;
    queue_.copy_to_host(&so_far, invalid, sizeof so_far);
    so_far += of_records;
    queue_.copy_to_device(invalid, &so_far, sizeof so_far);
}

bool IrradianceCacheIntegrator::make_ready(const std::function<bool(double share)>& goes_on) {
    if (has_records_) return true;
    store_.clear();
    queue_.zero(counts_.data() + kInvalid, sizeof(uint64_t));
    // Light that is scattered once is found by shadow rays alone.
    const uint32_t rounds = picture_settings_.max_depth < 2 ? 0 : kOvertureRounds;
    const uint32_t width = picture_.camera.width, height = picture_.camera.height;
    OvertureProgress progress(width, height, cells_of(picture_cache_), most_records(uint64_t(width) * height));
    const auto goes_on_here = [&] { return goes_on(progress.share(rays_.total())); };
    for (uint32_t round = 0; round < rounds; ++round) {
        if (!make_round(round, progress, goes_on_here)) return false;
    }
    has_records_ = true;
    return true;
}

bool IrradianceCacheIntegrator::make_round(uint32_t round, OvertureProgress& progress,
                                           const std::function<bool()>& goes_on) {
    progress.begin_walks(rays_.total());
    CacheJob job = make_job(kOvertureSeed);
    job.grid = make_overture_grid(round, picture_.camera.width, picture_.camera.height);
    job.round = round;
    job.sites = store_.sites();
    const PartSizes parts = trees_of_loop() != nullptr
                                ? PartSizes{kLoopRange * static_cast<uint64_t>(thread_count()), job.grid.count()}
                                : PartSizes{walks_in_flight_, walks_in_flight_};
    const bool went_on = do_in_parts(job.grid.count(), parts, goes_on, [&](uint64_t begin, uint64_t end) {
        run_walks(job, begin, end, [](auto& way, const CacheJob& part) { run_overture(way, part); });
        rays_.camera += end - begin;
    });
    if (!went_on) return false;
    const uint32_t wanted = store_.gather_sites(job.grid.count());
    progress.begin_records(wanted, rays_.total());
    if (wanted == 0) return true; // of a picture smaller than a step, too
    if (!make_hemispheres(make_job(kHemisphereSeed), wanted, goes_on)) return false;
    store_.take(wanted, picture_cache_.accuracy);
    return true;
}

bool IrradianceCacheIntegrator::make_hemispheres(CacheJob job, uint32_t records, const std::function<bool()>& goes_on) {
    const HemisphereGrid grid = make_hemisphere_grid(picture_cache_.hemisphere_rays);
    const uint32_t cells = grid.cells();
    job.hemispheres = {store_.sites(), store_.count(), 0, grid};
    job.made = store_.records();
    if (const HostTrees* trees = trees_of_loop()) {
        const PartSizes parts = {static_cast<uint64_t>(thread_count()), records};
        return do_in_parts(records, parts, goes_on,
                           [&](uint64_t begin, uint64_t end) { make_hemispheres_in_loop(*trees, job, begin, end); });
    }
    const uint32_t at_once = walks_in_flight_ / cells;
    return do_in_parts(records, {at_once, at_once}, goes_on, [&](uint64_t begin, uint64_t end) {
        CacheJob part = job;
        part.hemispheres.begin = static_cast<uint32_t>(begin);
        const auto here = static_cast<uint32_t>(end - begin);
        part.walk.film = film_of_cells(cache_, counts_.data() + kInvalid, here * cells);
        queue_.zero(cache_.light, 3 * std::size_t(here) * cells * sizeof(FixedSum));
        run_walks(part, 0, uint64_t(here) * cells,
                  [](auto& way, const CacheJob& walks) { run_hemispheres(way, walks); });
        part.cache = cache_;
        WalksOnDevice way(queue_, *tracer_, seen_);
        finish_records(way, part, here);
    });
}

void IrradianceCacheIntegrator::make_hemispheres_in_loop(const HostTrees& trees, const CacheJob& job, uint64_t begin,
                                                         uint64_t end) {
    const uint32_t cells = job.hemispheres.grid.cells();
    std::atomic<uint64_t> bounces{0}, connections{0};
    parallel_for_ranges(end - begin, 1, [&](uint64_t from, uint64_t to) {
        CacheJob part = job;
        ThreadMemory thread(trees, part, cells);
        part.walk.film = film_of_cells(part.cache, counts_.data() + kInvalid, cells);
        for (uint64_t i = begin + from; i < begin + to; ++i) {
            part.hemispheres.begin = static_cast<uint32_t>(i);
            std::fill_n(part.cache.light, 3 * std::size_t(cells), FixedSum{});
            run_in_parts(thread.way, part, 0, cells, kLoopWalks,
                         [](auto& way, const CacheJob& walks) { run_hemispheres(way, walks); });
            finish_records(thread.way, part, 1);
        }
        bounces += part.walk.walks.counts->bounces;
        connections += part.walk.walks.counts->all_asked;
    });
    rays_ = rays_ + RayCounts{0, bounces, connections};
}

template <class Run>
void IrradianceCacheIntegrator::run_walks(const CacheJob& job, uint64_t begin, uint64_t end, const Run& run) {
    if (begin >= end) return;
    if (const HostTrees* trees = trees_of_loop()) {
        std::atomic<uint64_t> bounces{0}, connections{0};
        parallel_for_ranges(end - begin, kLoopRange, [&](uint64_t from, uint64_t to) {
            CacheJob part = job;
            ThreadMemory thread(*trees, part, 0);
            run_in_parts(thread.way, part, begin + from, begin + to, kLoopWalks, run);
            bounces += part.walk.walks.counts->bounces;
            connections += part.walk.walks.counts->all_asked;
        });
        rays_ = rays_ + RayCounts{0, bounces, connections};
        return;
    }
    CacheJob part = job;
    part.walk.walks = walks_;
    part.cache = cache_;
    queue_.zero(walks_.counts, sizeof(WalkCounts));
    WalksOnDevice way(queue_, *tracer_, seen_);
    run_in_parts(way, part, begin, end, walks_in_flight_, run);
    way.begin_rounds(0);
    WalkCounts counts;
    queue_.copy_to_host(&counts, walks_.counts, sizeof counts);
    rays_ = rays_ + RayCounts{0, counts.bounces, counts.all_asked};
}

} // namespace pertev
