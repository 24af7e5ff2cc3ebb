#pragma once

// Irradiance caching: diffuse light of other surfaces changes slowly, so it is found by many rays at a few places, the
// records, and put together from these everywhere else (irradiance_record.h). The records are made before the first
// sample, in rounds (overture_grid.h, hemisphere_stages.h), and stay as they are, so each sample is a function of
// picture, settings and number. Light of lamps and sky, straight or by mirrors, is found by each sample itself
// (cache_stages.h). They are kept from one begin() to the next where the picture is the same.
//
// Source: Ward, Rubinstein, Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988.

#include <vector>

#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "integrators/irradiance_cache/record_store.h"
#include "integrators/irradiance_cache/run_irradiance_cache.h"

namespace pertev {

class OvertureProgress;

/// The settings of an irradiance cache render.
struct IrradianceCacheRequest {
    SubpathSettings walks;
    IrradianceCacheSettings cache;
};

/// A wavefront holds at least all rays of one record, even if its batch is smaller.
class IrradianceCacheIntegrator final : public TwoSchedules<IrradianceCacheRequest, CacheJob> {
public:
    IrradianceCacheIntegrator(Queue& queue, const IrradianceCacheRequest& settings, bool in_loop, uint32_t batch)
        : TwoSchedules(queue, settings, in_loop, batch), store_(queue) {}

    void reserve(const WorkSize& size) override;
    /// Returns the bytes of the records and their octree.
    std::size_t most_host_bytes(const WorkSize& size) const override {
        return RecordStore::most_host_bytes(size.pixels());
    }
    void expect_same_picture() override { is_same_picture_ = true; }
    bool has_made() const override { return has_records_ && store_.count() > 0; }
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    /// Makes the records. On the CPU one record a thread is not broken off.
    bool make_ready(const std::function<bool(double share)>& goes_on) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;
    /// The most that records have taken of the host's memory beside.
    std::size_t host_bytes() const { return store_.host_bytes(); }

    /// Of the picture begun, once it has samples.
    uint32_t record_count() const { return store_.count(); }
    std::vector<IrradianceRecord> records() const;
    /// Lookups of all samples since begin() that found no record.
    uint64_t missed_lookups() const;

private:
    CacheJob make_job(uint32_t seed) const;
    bool make_round(uint32_t round, OvertureProgress& progress, const std::function<bool()>& goes_on);
    bool make_hemispheres(CacheJob job, uint32_t records, const std::function<bool()>& goes_on);
    void make_hemispheres_in_loop(const HostTrees& trees, const CacheJob& job, uint64_t begin, uint64_t end);
    template <class Run>
    void run_walks(const CacheJob& job, uint64_t begin, uint64_t end, const Run& run) {
        run_stages(job, begin, end, {kLoopCount, 0}, 1, run);
    }
    void tell_invalid(uint64_t* invalid);

    bool is_same_picture_ = false; // of the next begin()
    bool has_records_ = false;
    RecordStore store_;
    Buffer<uint64_t> counts_; // lookups that found no record; invalid samples of the records
    Buffer<MirroredLamps> mirrored_;
};

} // namespace pertev
