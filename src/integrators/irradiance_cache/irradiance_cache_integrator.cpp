#include "integrators/irradiance_cache/irradiance_cache_integrator.h"

#include <algorithm>
#include <atomic>

#include "base/error.h"
#include "base/parallel_for.h"
#include "integrators/irradiance_cache/run_irradiance_cache.h"

namespace pertev {
namespace {

constexpr std::size_t kMostBytes = std::size_t(1) << 30; // of a device
constexpr uint32_t kLoopWalks = 256;                     // of a thread, at once
constexpr uint64_t kLoopRange = 256;                     // walks at least, that a thread takes at once
constexpr uint32_t kLeastWalks = 32;
constexpr std::size_t kCounts = 2; // of counts_

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

/// Runs all walks [0, all) of the job, so many at once.
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
                                                       uint32_t batch, bool in_loop) {
    const std::size_t bytes = RecordStore::predicted_bytes(pixels) + kCounts * sizeof(uint64_t);
    if (in_loop) return bytes;
    const uint32_t walks = walks_at_once(cache, pixels, batch);
    return bytes + bytes_in_flight(walks, walks);
}

std::size_t IrradianceCacheIntegrator::bytes() const {
    return memory_.size() + store_.bytes() + counts_.size() * sizeof(uint64_t);
}

const HostTrees* IrradianceCacheIntegrator::trees_of_loop() const { return in_loop_ ? tracer_->host_trees() : nullptr; }

void IrradianceCacheIntegrator::begin(const PictureView& picture, SceneTracer& tracer, uint32_t) {
    picture_ = picture;
    tracer_ = &tracer;
    rays_ = {};
    picture_settings_ = settings_;
    picture_cache_ = cache_settings_;
    has_records_ = false;
    const uint64_t pixels = uint64_t(picture.camera.width) * picture.camera.height;
    store_.make_room(pixels);
    if (counts_.size() == 0) counts_ = {queue_, kCounts, "counts of irradiance caching"};
    counts_.zero();
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
    queue_.copy_to_host(&missed, counts_.data(), sizeof missed);
    return missed;
}

CacheJob IrradianceCacheIntegrator::make_job(uint32_t seed) const {
    CacheJob job = {};
    job.walk.scene = {picture_, picture_settings_, {}, false};
    job.walk.scene.settings.seed ^= seed;
    job.records = store_.view();
    job.missed = counts_.data();
    return job;
}

void IrradianceCacheIntegrator::render(uint32_t first, uint32_t count, const FilmView& film) {
    PERTEV_CHECK(!film.frame.is_there());
    if (count == 0) return;
    // What is invalid of the records is told with sample 0, once, however the work is split.
    if (!has_records_ && !make_records(first == 0 ? film.invalid : counts_.data() + 1)) return;
    const uint32_t pixels = picture_.camera.width * picture_.camera.height;
    CacheJob job = make_job(0);
    job.walk.film = film;
    job.shows_records = picture_cache_.show_records;
    const float bright = 4.0f * store_.mean_luminance();
    job.mark = {bright, 0.35f * bright, 0};
    job.walk.samples = {0, pixels, first};
    run_walks(job, uint64_t(pixels) * count, [](auto& way, const CacheJob& part) { run_picture(way, part); });
    rays_.camera += uint64_t(pixels) * count;
}

bool IrradianceCacheIntegrator::make_records(uint64_t* invalid) {
    store_.clear();
    // Light that is scattered once is found by shadow rays alone.
    const uint32_t rounds = picture_settings_.max_depth < 2 ? 0 : kOvertureRounds;
    const RayCounts before = rays_;
    for (uint32_t round = 0; round < rounds && !is_abandoned(); ++round) {
        CacheJob job = make_job(kOvertureSeed);
        job.grid = make_overture_grid(round, picture_.camera.width, picture_.camera.height);
        if (job.grid.count() == 0) continue; // a picture smaller than a step
        job.round = round;
        job.sites = store_.sites();
        run_walks(job, job.grid.count(), [](auto& way, const CacheJob& part) { run_overture(way, part); });
        rays_.camera += job.grid.count();
        if (is_abandoned()) break;
        const uint32_t wanted = store_.gather_sites(job.grid.count());
        if (wanted == 0) continue;
        make_hemispheres(make_job(kHemisphereSeed), wanted, invalid);
        if (!is_abandoned()) store_.take(wanted, picture_cache_.accuracy);
    }
    has_records_ = !is_abandoned();
    if (!has_records_) rays_ = before;
    return has_records_;
}

void IrradianceCacheIntegrator::make_hemispheres(CacheJob job, uint32_t records, uint64_t* invalid) {
    const HemisphereGrid grid = make_hemisphere_grid(picture_cache_.hemisphere_rays);
    const uint32_t cells = grid.cells();
    job.hemispheres = {store_.sites(), store_.count(), 0, grid};
    job.made = store_.records();
    const auto run = [](auto& way, const CacheJob& part) { run_hemispheres(way, part); };
    if (const HostTrees* trees = trees_of_loop()) {
        std::atomic<uint64_t> bounces{0}, connections{0};
        parallel_for_ranges(records, 1, [&](uint64_t begin, uint64_t end) {
            CacheJob part = job;
            ThreadMemory thread(*trees, part, cells);
            part.walk.film = film_of_cells(part.cache, invalid, cells);
            for (uint64_t i = begin; i < end && !is_abandoned(); ++i) {
                part.hemispheres.begin = static_cast<uint32_t>(i);
                std::fill_n(part.cache.light, 3 * std::size_t(cells), FixedSum{});
                run_in_parts(thread.way, part, 0, cells, kLoopWalks, run);
                finish_records(thread.way, part, 1);
            }
            bounces += part.walk.walks.counts->bounces;
            connections += part.walk.walks.counts->all_asked;
        });
        rays_ = rays_ + RayCounts{0, bounces, connections};
        return;
    }
    const uint32_t at_once = walks_in_flight_ / cells;
    for (uint32_t i = 0; i < records && !is_abandoned(); i += at_once) {
        const uint32_t here = std::min(at_once, records - i);
        CacheJob part = job;
        part.hemispheres.begin = i;
        part.walk.film = film_of_cells(cache_, invalid, here * cells);
        queue_.zero(cache_.light, 3 * std::size_t(here) * cells * sizeof(FixedSum));
        run_walks(part, uint64_t(here) * cells, run);
        part.cache = cache_;
        WalksOnDevice way(queue_, *tracer_, seen_);
        finish_records(way, part, here);
    }
}

template <class Run>
void IrradianceCacheIntegrator::run_walks(const CacheJob& job, uint64_t walks, const Run& run) {
    if (walks == 0) return;
    if (const HostTrees* trees = trees_of_loop()) {
        std::atomic<uint64_t> bounces{0}, connections{0};
        parallel_for_ranges(walks, kLoopRange, [&](uint64_t begin, uint64_t end) {
            if (is_abandoned()) return;
            CacheJob part = job;
            ThreadMemory thread(*trees, part, 0);
            run_in_parts(thread.way, part, begin, end, kLoopWalks, run);
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
    run_in_parts(way, part, 0, walks, walks_in_flight_, run);
    way.begin_rounds(0);
    WalkCounts counts;
    queue_.copy_to_host(&counts, walks_.counts, sizeof counts);
    rays_ = rays_ + RayCounts{0, counts.bounces, counts.all_asked};
}

} // namespace pertev
