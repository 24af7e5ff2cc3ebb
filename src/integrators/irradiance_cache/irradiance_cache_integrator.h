#pragma once

// Irradiance caching: diffuse light of other surfaces changes slowly, so it is found by many rays at a few places, the
// records, and put together from these everywhere else (irradiance_record.h). The records are made before the first
// sample, in rounds (overture_grid.h, hemisphere_stages.h), and stay as they are, so each sample is a function of
// picture, settings and number. Light of lamps and sky, straight or by mirrors, is found by each sample itself
// (cache_stages.h). They are kept from one begin() to the next where the picture is the same.
//
// Source: Ward, Rubinstein, Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988.
//
// Two bodies give the same bytes: on the CPU each thread takes some walks of its own through all stages; else every
// stage runs over all walks in flight, and their rays go through the scene's tracer.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "device/buffer.h"
#include "device/readback.h"
#include "integrators/integrator.h"
#include "integrators/irradiance_cache/cache_memory.h"
#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "integrators/irradiance_cache/record_store.h"
#include "integrators/subpaths/subpath_settings.h"

namespace pertev {

struct CacheJob;
class OvertureProgress;

class IrradianceCacheIntegrator final : public Integrator {
public:
    /// `queue` outlives the integrator. `in_loop`: on the CPU, where it can walk the scene's trees by itself, threads
    /// take walks of their own. `batch`: most walks in flight else, but a record's rays are always; their memory is 1
    /// GiB at most.
    IrradianceCacheIntegrator(Queue& queue, const SubpathSettings& settings, const IrradianceCacheSettings& cache,
                              bool in_loop, uint32_t batch);

    /// Bytes that begin() takes for so many pixels, and on the CPU what the records take beside. `in_loop`: threads
    /// take walks of their own.
    static std::size_t predicted_bytes(const IrradianceCacheSettings& cache, uint64_t pixels, uint32_t batch,
                                       bool in_loop, bool on_cuda);

    void expect_same_picture() override { is_same_picture_ = true; }
    bool has_made() const override { return has_records_ && store_.count() > 0; }
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    /// Makes the records. On the CPU one record a thread is not broken off.
    bool make_ready(const std::function<bool(double share)>& goes_on) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;
    void abandon_when(const std::atomic<bool>* flag) override { abandon_ = flag; }
    RayCounts rays() const override { return rays_; }
    std::size_t bytes() const override;
    /// The most that records have taken of the host's memory beside.
    std::size_t host_bytes() const { return store_.host_bytes(); }

    /// Count from the next begin().
    void set_settings(const SubpathSettings& settings, const IrradianceCacheSettings& cache) {
        settings_ = settings;
        cache_settings_ = cache;
    }

    /// Of the picture begun, once it has samples.
    uint32_t record_count() const { return store_.count(); }
    std::vector<IrradianceRecord> records() const;
    /// Lookups of all samples since begin() that found no record.
    uint64_t missed_lookups() const;

private:
    const HostTrees* trees_of_loop() const; // null: all at once
    /// A session throws the film away on the CPU alone.
    bool is_abandoned() const { return abandon_ != nullptr && *abandon_; }
    CacheJob make_job(uint32_t seed) const;
    bool make_round(uint32_t round, OvertureProgress& progress, const std::function<bool()>& goes_on);
    bool make_hemispheres(CacheJob job, uint32_t records, const std::function<bool()>& goes_on);
    void make_hemispheres_in_loop(const HostTrees& trees, const CacheJob& job, uint64_t begin, uint64_t end);
    template <class Run>
    void run_walks(const CacheJob& job, uint64_t begin, uint64_t end, const Run& run);
    void tell_invalid(uint64_t* invalid);

    Queue& queue_;
    SubpathSettings settings_, picture_settings_; // asked for; of the picture begun
    IrradianceCacheSettings cache_settings_, picture_cache_;
    bool in_loop_;
    uint32_t batch_;
    PictureView picture_{};
    SceneTracer* tracer_ = nullptr;
    const std::atomic<bool>* abandon_ = nullptr;
    RayCounts rays_;

    bool is_same_picture_ = false; // of the next begin()
    bool has_records_ = false;
    RecordStore store_;
    Buffer<uint64_t> counts_; // lookups that found no record; invalid samples of the records
    Buffer<MirroredLamps> mirrored_;
    Buffer<std::byte> memory_;
    uint32_t walks_in_flight_ = 0;
    WalksView walks_{};      // of memory_
    CacheWalksView cache_{}; // of memory_
    Readback<WalkCounts> seen_;
};

} // namespace pertev
