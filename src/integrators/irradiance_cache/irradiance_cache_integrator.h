#pragma once

// Irradiance caching: indirect diffuse light varies slowly, so many rays find it at a few points, the records, and it
// is interpolated everywhere else (irradiance_record.h). Records are made in rounds before the first sample
// (overture_grid.h, hemisphere_stages.h) and then do not change, so each sample depends only on picture, settings and
// its number. Each sample finds the light of emitters and sky, direct or mirrored, itself (cache_stages.h). Records
// are kept from one begin() to the next if the picture is the same.
//
// Source: Ward, Rubinstein, Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988.

#include <span>
#include <vector>

#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "integrators/irradiance_cache/record_store.h"
#include "integrators/irradiance_cache/run_irradiance_cache.h"

namespace pertev {

class OvertureProgress;

/// The settings of an irradiance cache render.
struct IrradianceCacheRequest {
    SubpathSettings subpaths;
    IrradianceCacheSettings cache;
};

/// Renders with an irradiance cache. A wavefront holds at least all rays of one record, even if its batch is smaller.
class IrradianceCacheIntegrator final : public TwoSchedules<IrradianceCacheRequest, CacheJob> {
public:
    IrradianceCacheIntegrator(Queue& queue, const IrradianceCacheRequest& settings, bool in_loop, uint32_t batch)
        : TwoSchedules(queue, settings, in_loop, batch), store_(queue) {}

    void reserve(const WorkSize& size) override;
    /// Returns the bytes of the records and their octree.
    std::size_t host_bytes() const override { return store_.host_bytes(); }
    void expect_same_picture() override { is_same_picture_ = true; }
    bool has_made() const override { return has_records_ && store_.count() > 0; }
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    /// Makes the records, or takes those of the settings; throws Error(BadInput) if they are none of this picture. On
    /// the CPU the record that each thread is working on is always finished.
    bool prepare(const std::function<bool(double share)>& goes_on) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;

    /// Number of records of the current picture, once it has samples.
    uint32_t record_count() const { return store_.count(); }
    std::vector<IrradianceRecord> records() const;
    /// Number of lookups of all samples since begin() that found no record.
    uint64_t missed_lookups() const;

private:
    void leave_records(std::vector<std::byte>& made) const;
    void take_records(std::span<const std::byte> made);
    CacheJob make_job(uint32_t seed) const;
    bool make_round(uint32_t round, OvertureProgress& progress, const std::function<bool()>& goes_on);
    bool make_hemispheres(CacheJob job, uint32_t records, const std::function<bool()>& goes_on);
    void make_hemispheres_in_loop(const HostTrees& trees, const CacheJob& job, uint64_t begin, uint64_t end);
    template <class Run>
    void run_subpaths(const CacheJob& job, uint64_t begin, uint64_t end, const Run& run) {
        run_stages(job, begin, end, {kLoopCount, 0, uses_light_tree(job.scene)}, 1, run);
    }
    void report_invalid(uint64_t* invalid);

    bool is_same_picture_ = false; // whether the next begin() gets the same picture
    bool has_records_ = false;
    RecordStore store_;
    Buffer<uint64_t> counts_; // lookups without a record; invalid samples of the records
    Buffer<MirroredEmitters> mirrored_;
};

} // namespace pertev
