#pragma once

// Photon mapping: each sample of the film is a pass. Photons leave the lights and are stored on diffuse surfaces
// (photon_stages.h); a structure is built over them (photon_maps.h); then the camera subpath of each pixel looks up
// light there (gather_stages.h, estimate_radiance.h). Each pass starts again with a radius that depends only on the
// pass's number, so passes may be rendered in any order and anywhere, and are added like samples.
//
// Sources: Jensen, "Global Illumination using Photon Maps", EGWR 1996; Knaus, Zwicker, "Progressive Photon Mapping: A
// Probabilistic Approach", TOG 30(3), 2011.

#include "integrators/photon_map/photon_maps.h"
#include "integrators/photon_map/run_photon_map.h"

namespace pertev {

/// The settings of a photon map render.
struct PhotonMapRequest {
    SubpathSettings subpaths;
    PhotonMapSettings map;
};

class PhotonMapIntegrator final : public TwoSchedules<PhotonMapRequest, PhotonJob> {
public:
    PhotonMapIntegrator(Queue& queue, const PhotonMapRequest& settings, bool in_loop, uint32_t batch)
        : TwoSchedules(queue, settings, in_loop, batch), maps_(queue) {}

    void reserve(const WorkSize& size) override;
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;

    /// Photon counts of the last pass.
    const PhotonCounts& photons() const { return maps_.counts(); }
    /// Maps of the last pass, in the queue's memory.
    const PhotonMapsView& maps() const { return maps_.view(); }
    /// Records what happens to photons from the next pass on, which takes time; null stops it. `energy` is in the
    /// queue's memory.
    void record_energy_in(PhotonEnergy* energy) { energy_ = energy; }
    /// Radius of a pass of the current picture, in metres.
    float global_radius(uint32_t pass) const { return global_radius_ * radius_of_pass(pass); }

private:
    GatherCapacity loop_capacity() const;
    void find_targets();
    PhotonJob make_job(uint32_t pass, const FilmView& film);
    void render_pass(uint32_t pass, const FilmView& film);

    PhotonEnergy* energy_ = nullptr;
    WorldSphere world_{};
    float global_radius_ = 0, caustic_radius_ = 0; // radii of the first pass
    PhotonMaps maps_;
    Buffer<Float4> targets_;
    Buffer<uint64_t> counted_elsewhere_; // number of invalid photons that another part of the picture counts
    uint32_t target_count_ = 0;
};

} // namespace pertev
