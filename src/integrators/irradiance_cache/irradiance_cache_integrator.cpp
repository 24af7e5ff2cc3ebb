#include "integrators/irradiance_cache/irradiance_cache_integrator.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/error.h"
#include "integrators/irradiance_cache/overture_progress.h"

namespace pertev {
namespace {

enum : std::size_t { kMissed, kInvalid, kCounts }; // indices into counts_

uint32_t cells_of(const IrradianceCacheSettings& cache) { return make_hemisphere_grid(cache.hemisphere_rays).cells(); }

FilmView film_of_cells(const CacheSubpathsView& cache, uint64_t* invalid, uint32_t cells) {
    return {cache.light, nullptr, invalid, 3, 0, {.width = cells, .height = 1}, {}};
}

/// Returns whether a tree can be built over the record, wherever its bytes come from.
bool is_sound_record(const IrradianceRecord& record) {
    const CachePoint& point = record.point;
    return is_finite(point.position) && is_finite(point.normal) && is_finite(record.light) && record.radius >= 0 &&
           is_finite(record.radius);
}

} // namespace

void IrradianceCacheIntegrator::reserve(const WorkSize& size) {
    store_.allocate(size.pixels());
    counts_.grow(queue_, kCounts, "counts of irradiance caching");
    mirrored_.grow(queue_, 1, "counts of mirrors and emitters");
    if (uses_loop(size)) return;
    // The wavefront holds the picture's samples or all rays of some records, at least of one.
    const uint32_t cells = cells_of(settings_.cache);
    const uint64_t wanted = std::max<uint64_t>(size.pixels(), uint64_t(cells) * 64);
    const bool has_normals = uses_light_tree(settings_.subpaths.light_choice, size.tree_lights, size.has_times);
    const uint64_t most =
        std::min<uint64_t>({wanted, batch_, kMaxBytes / (bytes_of({kMinCount, kMinCount, has_normals}) / kMinCount)});
    const auto subpaths = static_cast<uint32_t>(std::max<uint64_t>(most, cells));
    allocate_capacity({subpaths, subpaths, has_normals}, "subpaths of irradiance caching");
}

void IrradianceCacheIntegrator::begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) {
    TwoSchedules::begin(picture, tracer, samples);
    if (!std::exchange(is_same_picture_, false)) has_records_ = false;
    queue_.zero(counts_.data() + kMissed, sizeof(uint64_t));
    queue_.zero(mirrored_.data(), sizeof(MirroredEmitters));
    launch(queue_, "count mirrored emitters", picture.scene.instance_count,
           CountMirroredEmitters{picture.scene, mirrored_.data()});
}

std::vector<IrradianceRecord> IrradianceCacheIntegrator::records() const {
    std::vector<IrradianceRecord> records(store_.count());
    queue_.copy_to_host(records.data(), store_.records(), records.size() * sizeof(IrradianceRecord));
    return records;
}

/// Leaves the number of invalid samples of the records' rays, and the records.
void IrradianceCacheIntegrator::leave_records(std::vector<std::byte>& made) const {
    made.resize(sizeof(uint64_t) + store_.count() * sizeof(IrradianceRecord));
    queue_.copy_to_host(made.data(), counts_.data() + kInvalid, sizeof(uint64_t));
    if (store_.count() > 0)
        queue_.copy_to_host(made.data() + sizeof(uint64_t), store_.records(), made.size() - sizeof(uint64_t));
}

void IrradianceCacheIntegrator::take_records(std::span<const std::byte> made) {
    const std::size_t size = made.size() < sizeof(uint64_t) ? 1 : made.size() - sizeof(uint64_t);
    std::vector<IrradianceRecord> records(size / sizeof(IrradianceRecord));
    const uint32_t most = max_records(uint64_t(picture_.camera.width) * picture_.camera.height);
    bool is_sound = size % sizeof(IrradianceRecord) == 0 && records.size() <= most;
    if (is_sound && !records.empty()) std::memcpy(records.data(), made.data() + sizeof(uint64_t), size);
    is_sound = is_sound && std::ranges::all_of(records, is_sound_record);
    if (!is_sound) throw Error(ErrorCode::BadInput, "records", "", "the file does not hold records of this picture");
    queue_.copy_to_device(counts_.data() + kInvalid, made.data(), sizeof(uint64_t));
    if (records.empty()) return;
    queue_.copy_to_device(store_.records(), records.data(), size);
    store_.take(static_cast<uint32_t>(records.size()), picture_settings_.cache.accuracy);
}

uint64_t IrradianceCacheIntegrator::missed_lookups() const {
    uint64_t missed = 0;
    queue_.copy_to_host(&missed, counts_.data() + kMissed, sizeof missed);
    return missed;
}

CacheJob IrradianceCacheIntegrator::make_job(uint32_t seed) const {
    CacheJob job = {};
    job.scene = {picture_, picture_settings_.subpaths, {}, false};
    job.scene.settings.seed ^= seed;
    job.records = store_.view();
    job.missed = counts_.data() + kMissed;
    job.mirrored = mirrored_.data();
    return job;
}

void IrradianceCacheIntegrator::render(uint32_t first, uint32_t count, const FilmView& film) {
    check_sums(film);
    if (count == 0) return;
    if (!prepare([this](double) { return !is_abandoned(); })) return;
    if (first == 0 && film.is_first) report_invalid(film.invalid);
    CacheJob job = make_job(0);
    job.film = film;
    job.shows_records = picture_settings_.cache.show_records;
    const float bright = 4.0f * store_.mean_luminance();
    job.mark = {bright, 0.35f * bright, 0};
    job.samples = {film.window, first, count};
    run_subpaths(job, 0, job.samples.count(), [this](auto& schedule, const CacheJob& part) {
        if (!is_abandoned()) run_picture(schedule, part);
    });
    rays_.camera += job.samples.count();
}

/// Adds invalid samples of the records to the count together with sample 0 of the first pixel, thus once, however the
/// work is split.
void IrradianceCacheIntegrator::report_invalid(uint64_t* invalid) {
    uint64_t of_records = 0, so_far = 0;
    queue_.copy_to_host(&of_records, counts_.data() + kInvalid, sizeof of_records);
    if (of_records == 0) return;
    queue_.copy_to_host(&so_far, invalid, sizeof so_far);
    so_far += of_records;
    queue_.copy_to_device(invalid, &so_far, sizeof so_far);
}

bool IrradianceCacheIntegrator::prepare(const std::function<bool(double share)>& goes_on) {
    if (has_records_) return true;
    const UseThreads use(queue_.threads());
    store_.clear();
    queue_.zero(counts_.data() + kInvalid, sizeof(uint64_t));
    const auto& shared = picture_settings_.cache.shared;
    if (shared && !shared->empty()) {
        take_records(*shared);
        has_records_ = true;
        return true;
    }
    // Shadow rays alone find light that is scattered once.
    const uint32_t rounds = picture_settings_.subpaths.max_depth < 2 ? 0 : kOvertureRounds;
    const uint32_t width = picture_.camera.width, height = picture_.camera.height;
    OvertureProgress progress(width, height, cells_of(picture_settings_.cache), max_records(uint64_t(width) * height));
    const auto goes_on_here = [&] { return goes_on(progress.share(rays_.total())); };
    for (uint32_t round = 0; round < rounds; ++round) {
        if (!make_round(round, progress, goes_on_here)) return false;
    }
    has_records_ = true;
    if (shared) leave_records(*shared);
    return true;
}

bool IrradianceCacheIntegrator::make_round(uint32_t round, OvertureProgress& progress,
                                           const std::function<bool()>& goes_on) {
    progress.begin_subpaths(rays_.total());
    CacheJob job = make_job(kOvertureSeed);
    job.grid = make_overture_grid(round, picture_.camera.width, picture_.camera.height);
    job.round = round;
    job.sites = store_.sites();
    const PartSizes parts =
        trees_of_loop() != nullptr
            ? PartSizes{uint64_t(kLoopCount) * static_cast<uint64_t>(thread_count()), job.grid.count()}
            : PartSizes{capacity_.count, capacity_.count};
    const bool went_on = do_in_parts(job.grid.count(), parts, goes_on, [&](uint64_t begin, uint64_t end) {
        run_subpaths(job, begin, end, [](auto& schedule, const CacheJob& part) { run_overture(schedule, part); });
        rays_.camera += end - begin;
    });
    if (!went_on) return false;
    const uint32_t wanted = store_.gather_sites(job.grid.count());
    progress.begin_records(wanted, rays_.total());
    if (wanted == 0) return true; // the picture may be smaller than a step
    if (!make_hemispheres(make_job(kHemisphereSeed), wanted, goes_on)) return false;
    store_.take(wanted, picture_settings_.cache.accuracy);
    return true;
}

bool IrradianceCacheIntegrator::make_hemispheres(CacheJob job, uint32_t records, const std::function<bool()>& goes_on) {
    const HemisphereGrid grid = make_hemisphere_grid(picture_settings_.cache.hemisphere_rays);
    const uint32_t cells = grid.cells();
    job.hemispheres = {store_.sites(), store_.count(), 0, grid};
    job.made = store_.records();
    if (const HostTrees* trees = trees_of_loop()) {
        const PartSizes parts = {static_cast<uint64_t>(thread_count()), records};
        return do_in_parts(records, parts, goes_on,
                           [&](uint64_t begin, uint64_t end) { make_hemispheres_in_loop(*trees, job, begin, end); });
    }
    const uint32_t at_once = capacity_.count / cells;
    return do_in_parts(records, {at_once, at_once}, goes_on, [&](uint64_t begin, uint64_t end) {
        CacheJob part = job;
        lay_out_job(part);
        part.hemispheres.begin = static_cast<uint32_t>(begin);
        const auto here = static_cast<uint32_t>(end - begin);
        part.film = film_of_cells(part.cache, counts_.data() + kInvalid, here * cells);
        queue_.zero(part.cache.light, 3 * std::size_t(here) * cells * sizeof(FixedSum));
        run_subpaths(part, 0, uint64_t(here) * cells,
                     [](auto& schedule, const CacheJob& subpaths) { run_hemispheres(schedule, subpaths); });
        SubpathsWavefront schedule(queue_, *tracer_, seen_);
        finish_records(schedule, part, here);
    });
}

void IrradianceCacheIntegrator::make_hemispheres_in_loop(const HostTrees& trees, const CacheJob& job, uint64_t begin,
                                                         uint64_t end) {
    const uint32_t cells = job.hemispheres.grid.cells();
    trace_ranges(end - begin, 1, [&](uint64_t from, uint64_t to) {
        CacheJob part = job;
        Thread thread(trees, part, {kLoopCount, cells, uses_light_tree(part.scene)});
        part.film = film_of_cells(part.cache, counts_.data() + kInvalid, cells);
        for (uint64_t i = begin + from; i < begin + to; ++i) {
            part.hemispheres.begin = static_cast<uint32_t>(i);
            std::fill_n(part.cache.light, 3 * std::size_t(cells), FixedSum{});
            run_in_parts(thread.schedule, part, 0, cells, kLoopCount,
                         [](auto& schedule, const CacheJob& subpaths) { run_hemispheres(schedule, subpaths); });
            finish_records(thread.schedule, part, 1);
        }
        return rays_of(*part.counts());
    });
}

} // namespace pertev
