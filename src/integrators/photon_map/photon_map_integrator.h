#pragma once

// Photon mapping: each sample of the film is a pass. Photons leave the lights and are left where they meet diffuse
// surfaces (photon_stages.h); a structure is built over them (photon_maps.h); then each pixel's walk looks light up
// there (gather_stages.h, estimate_radiance.h). The next pass begins anew with another radius: a function of the pass's
// number alone, so that passes may be rendered in any order and anywhere, and added as samples are.
//
// Sources: Jensen, "Global Illumination using Photon Maps", EGWR 1996; Knaus, Zwicker, "Progressive Photon Mapping: A
// Probabilistic Approach", TOG 30(3), 2011.
//
// Two bodies give the same bytes: on the CPU each thread takes some walks of its own through all stages; else every
// stage runs over all walks in flight, and their rays go through the scene's tracer.

#include <cstddef>
#include <cstdint>

#include "device/buffer.h"
#include "device/readback.h"
#include "integrators/integrator.h"
#include "integrators/photon_map/gather_memory.h"
#include "integrators/photon_map/photon_maps.h"
#include "integrators/photon_map/photon_stages.h"
#include "integrators/subpaths/subpath_settings.h"

namespace pertev {

struct PhotonJob;

class PhotonMapIntegrator final : public Integrator {
public:
    /// `queue` outlives the integrator. `in_loop`: on the CPU, where it can walk the scene's trees by itself, threads
    /// take walks of their own. `batch`: most walks in flight else; their memory is 1 GiB at most.
    PhotonMapIntegrator(Queue& queue, const SubpathSettings& settings, const PhotonMapSettings& map, bool in_loop,
                        uint32_t batch);

    /// Bytes that begin() takes for so many pixels. `in_loop`: threads take walks of their own.
    static std::size_t predicted_bytes(const SubpathSettings& settings, const PhotonMapSettings& map, uint64_t pixels,
                                       uint32_t batch, bool in_loop, bool on_cuda);

    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;
    /// The loop alone does.
    void abandon_when(const std::atomic<bool>* flag) override { abandon_ = flag; }
    RayCounts rays() const override { return rays_; }
    std::size_t bytes() const override;

    /// Count from the next begin().
    void set_settings(const SubpathSettings& settings, const PhotonMapSettings& map) {
        settings_ = settings;
        map_settings_ = map;
    }

    /// Of the last pass.
    const PhotonCounts& photons() const { return maps_.counts(); }
    /// Likewise, in the queue's memory.
    const PhotonMapsView& maps() const { return maps_.view(); }
    /// From the next pass on tells what becomes of photons, which takes time. Null: no more. In the queue's memory.
    void tell_energy(PhotonEnergy* energy) { energy_ = energy; }
    /// Metres, of a pass of the present picture.
    float global_radius(uint32_t pass) const { return global_radius_ * radius_of_pass(pass); }

private:
    const HostTrees* trees_of_loop() const; // null: all at once
    /// A session throws the film away on the CPU alone.
    bool is_abandoned() const { return abandon_ != nullptr && *abandon_; }
    void find_targets();
    PhotonJob make_job(uint32_t pass, const FilmView& film);
    void render_pass(uint32_t pass, const FilmView& film);
    void in_loop(const HostTrees& trees, const PhotonJob& job, uint64_t walks, bool are_photons);
    void all_at_once(const PhotonJob& job, uint64_t walks, bool are_photons);
    void run(const PhotonJob& job, uint64_t walks, bool are_photons);

    Queue& queue_;
    SubpathSettings settings_, picture_settings_; // asked for; of the picture begun
    PhotonMapSettings map_settings_, picture_map_;
    bool in_loop_;
    uint32_t batch_;
    PictureView picture_{};
    SceneTracer* tracer_ = nullptr;
    const std::atomic<bool>* abandon_ = nullptr;
    PhotonEnergy* energy_ = nullptr;
    RayCounts rays_;

    WorldSphere world_{};
    float global_radius_ = 0, caustic_radius_ = 0; // of the first pass
    PhotonMaps maps_;
    Buffer<Float4> targets_;
    uint32_t target_count_ = 0;
    Buffer<std::byte> memory_;
    uint32_t walks_in_flight_ = 0;
    WalksView walks_{};   // of memory_
    GatherView gather_{}; // of memory_
    Readback<WalkCounts> seen_;
};

} // namespace pertev
