#pragma once

// Pictures of a Session for the viewer. While the camera or time moves: frames of one sample, reconstructed with the
// history of earlier ones, at a resolution that meets the frame rate. At rest, if a sample of all pixels takes long:
// pictures that grow (rest_growth.h). Then samples accumulate at full size until all requested ones are done; that
// film equals the one of `pertev render`, to the bit.

#include "apps/viewer/frame_pace.h"
#include "apps/viewer/frame_source.h"
#include "apps/viewer/rest_growth.h"
#include "session/adaptive_exposure.h"
#include "session/moving_scene.h"
#include "session/session.h"

namespace pertev {

class SessionFrames final : public FrameSource {
public:
    /// `frame_s` is the target time of moving frames in seconds; on a GPU until the screen's rate is known. `session`
    /// has the scene of `scene`; both outlive it. `soon_s`: see RestGrowth.
    SessionFrames(Session& session, MovingScene& scene, double frame_s, double soon_s = RestGrowth::kSoon);

    void set_time(double time_s) override;
    std::optional<ShownFrame> next(const FrameRequest& request) override;
    std::atomic<bool>& abandon() override { return abandon_; }
    std::atomic<bool>& hurry() override { return hurry_; }
    std::optional<PickedPoint> pick(const Camera& camera, float x, float y) override;
    float meter(const FrameRequest& request) override;
    RenderResult result() override { return session_.result(); }
    /// Uses an exposure that was already metered for this view.
    void begin_exposed(const FrameRequest& request, float stops);

private:
    /// The size of the film relative to the picture's. It is smaller while the view moves, or grows at rest.
    struct FilmSize {
        float scale = 1;
        bool is_of_movement = false, is_growing = false;
        bool is_small() const { return is_of_movement || is_growing; }
    };
    std::optional<ShownFrame> make_next(const FrameRequest& request);
    bool prepare_competition(const FrameRequest& request, const FilmSize& size);
    bool add_samples(const FrameRequest& request, const FilmSize& size, bool competes, ShownFrame& frame);
    void show_film(const FrameRequest& request, const FilmSize& size, ShownFrame& frame);
    std::optional<ShownFrame> reconstruct(const FrameRequest& request, float scale, bool is_growing);
    std::optional<float> growth_scale(const FrameRequest& request);
    bool film_goes_on(const FrameRequest& request);
    std::optional<ShownFrame> show_reconstruction_again(const FrameRequest& request);
    RenderSettings settings_for(const FrameRequest& request, float scale);
    RenderSettings small_settings_for(const FrameRequest& request, float scale);
    float scale_for(const FrameRequest& request);
    void report_pace(const FrameRequest& request, ShownFrame& frame) const;
    void use(const RenderSettings& settings);
    Rgba8Image show(const FrameRequest& request, ShownFrame& frame);
    Rgba8Image show_layer(const FrameRequest& request, ShownFrame& frame);
    void expose(const FrameRequest& request, ShownFrame& frame);
    bool beats_reconstruction(const FrameRequest& request);
    void meter_still(const FrameRequest& request, bool is_small);

    Session& session_;
    MovingScene& scene_;
    uint64_t scene_changes_ = 0;
    bool is_behind_ = false; // the last set_time threw
    double update_s_ = 0;    // time of the scene's update since the last frame
    FramePace pace_;
    RestGrowth growth_;
    /// A view, and the size of its picture.
    struct Seen {
        RenderSettings picture;
        Camera camera;
        ShownLayer layer = ShownLayer::Beauty;
        uint64_t scene_changes = 0;
        float scale = 0; // 0: none
        /// Returns whether this is the view of `request`, at any size.
        bool is_of(const FrameRequest& request, uint64_t changes) const;
    };
    Seen grown_;       // the view of growth_
    Seen seen_;        // view of the last small picture, while nothing larger is shown
    Display shown_as_; // display of the last picture, with all stops
    std::atomic<bool> abandon_{false}, hurry_{false};
    ReconstructionSettings reconstruction_settings_; // settings of the last frame
    RenderSettings reconstructed_as_;                // settings of the last frame
    RestirSettings restir_settings_;
    uint32_t next_sample_ = 0;  // sample number of real-time frames
    uint32_t still_frames_ = 0; // frames since the camera stopped
    bool shows_reconstruction_ = false;
    bool shows_layer_ = false;   // whether it shows a layer of the reconstruction
    bool shows_film_ = false;    // the last picture was that at rest
    Rgba8Image reconstruction_;  // the last one as displayed; empty while nothing competes with it
    Image reconstruction_light_; // the last one in linear light
    Rgba8Image half_;            // the picture at rest that is not shown yet, at half_samples_ of its samples
    uint32_t half_samples_ = 0;
    /// The hash of the current film; cached while the film does not change.
    const std::string& film_hash();
    struct Hashed {
        std::string hash;
        Camera camera;
        uint64_t cuts = 0, scene_changes = 0;
        uint32_t samples = 0;
    } hashed_;
    AdaptiveExposure exposure_;
    /// The view for which exposure_ was metered, as long as no frame has adapted it.
    struct Metered {
        RenderSettings picture;
        Camera camera;
        ToneMap tone_map = ToneMap::Agx;
        uint64_t scene_changes = 0;
        bool is_there = false;
    } metered_;
    double sample_s_ = 0; // time of one sample of all pixels of the last reference; 0: unknown
};

} // namespace pertev
