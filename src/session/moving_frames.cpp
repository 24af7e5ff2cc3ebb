#include "session/moving_frames.h"

#include <utility>

#include "denoise/motion_vectors.h"

namespace pertev {

bool MovingFrames::render(uint32_t number, const Camera& camera, const RenderSettings& settings,
                          const ReconstructionSettings& reconstruction, const RestirSettings& restir, Sink& sink) {
    before_.reset();
    if (last_) before_ = {*last_, has_moved()};
    last_.reset(); // the next line may throw
    if (!FrameSequence::render(number, camera, settings, reconstruction, restir, sink)) return false;
    last_ = camera;
    return true;
}

void MovingFrames::restore(FrameHistory history, const RenderSettings& settings, Sink& sink) {
    last_ = history.camera;
    FrameSequence::restore(std::move(history), settings, sink);
}

RenderResult MovingFrames::result(const Camera& camera, const RenderSettings& settings) {
    RenderResult result = FrameSequence::result(camera, settings);
    if ((settings.aovs & kAovMotion) != 0) result.layers.push_back(motion_layer(motion_of_frame(camera, settings)));
    return result;
}

Image MovingFrames::motion_of_frame(const Camera& camera, const RenderSettings& settings) {
    if (!before_ || reconstruction().frames() < 2) { // there was a cut
        Image none{settings.width, settings.height, 2, {}};
        none.pixels.resize(std::size_t(2) * settings.width * settings.height);
        return none;
    }
    DeviceScene& scene = pictures().scene();
    const PictureView picture = pictures().view_of(camera, settings);
    const CameraView before = make_camera_view(before_->camera, settings.width, settings.height, picture.scene.centre);
    const PreviousScene positions =
        before_->has_moved ? scene.before() : PreviousScene{picture.scene.instances, picture.scene.meshes};
    return motion_vectors(pictures().queue(), scene.tracer(), picture, before, positions);
}

FilmLayer motion_layer(Image motion) {
    const AovGroup& group = aov_group(kAovMotion);
    return {group.layer, channel_names(group), std::move(motion)};
}

} // namespace pertev
