#pragma once

// Photon mapping: each sample of the film is a pass. Photons leave the lights and are left where they meet diffuse
// surfaces (photon_stages.h); a structure is built over them (photon_maps.h); then each pixel's walk looks light up
// there (gather_stages.h, estimate_radiance.h). The next pass begins anew with another radius: a function of the pass's
// number alone, so that passes may be rendered in any order and anywhere, and added as samples are.
//
// Sources: Jensen, "Global Illumination using Photon Maps", EGWR 1996; Knaus, Zwicker, "Progressive Photon Mapping: A
// Probabilistic Approach", TOG 30(3), 2011.

#include "integrators/photon_map/photon_maps.h"
#include "integrators/photon_map/run_photon_map.h"

namespace pertev {

/// The settings of a photon map render.
struct PhotonMapRequest {
    SubpathSettings walks;
    PhotonMapSettings map;
};

class PhotonMapIntegrator final : public TwoSchedules<PhotonMapRequest, PhotonJob> {
public:
    PhotonMapIntegrator(Queue& queue, const PhotonMapRequest& settings, bool in_loop, uint32_t batch)
        : TwoSchedules(queue, settings, in_loop, batch), maps_(queue) {}

    void reserve(const WorkSize& size) override;
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;

    /// Of the last pass.
    const PhotonCounts& photons() const { return maps_.counts(); }
    /// Likewise, in the queue's memory.
    const PhotonMapsView& maps() const { return maps_.view(); }
    /// From the next pass on tells what becomes of photons, which takes time. Null: no more. In the queue's memory.
    void tell_energy(PhotonEnergy* energy) { energy_ = energy; }
    /// Metres, of a pass of the present picture.
    float global_radius(uint32_t pass) const { return global_radius_ * radius_of_pass(pass); }

private:
    GatherRoom loop_room() const;
    void find_targets();
    PhotonJob make_job(uint32_t pass, const FilmView& film);
    void render_pass(uint32_t pass, const FilmView& film);

    PhotonEnergy* energy_ = nullptr;
    WorldSphere world_{};
    float global_radius_ = 0, caustic_radius_ = 0; // of the first pass
    PhotonMaps maps_;
    Buffer<Float4> targets_;
    uint32_t target_count_ = 0;
};

} // namespace pertev
