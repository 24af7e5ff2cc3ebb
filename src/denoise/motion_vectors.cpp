#include "denoise/motion_vectors.h"

#include <algorithm>
#include <vector>

#include "device/launch.h"

namespace pertev {
namespace {

constexpr uint32_t kAtOnce = 1 << 18; // pixels

uint32_t pixels_at_once(uint32_t width, uint32_t height) {
    return static_cast<uint32_t>(std::min<uint64_t>(kAtOnce, uint64_t(width) * height));
}

} // namespace

std::size_t motion_vector_bytes(uint32_t width, uint32_t height) {
    return pixels_at_once(width, height) *
           (sizeof(Ray) + sizeof(uint32_t) + sizeof(Float4) + sizeof(uint32_t) + sizeof(Vec2));
}

Image motion_vectors(Queue& queue, SceneTracer& tracer, const PictureView& picture, const CameraView& camera_before,
                     const PreviousScene& before) {
    const uint32_t width = picture.camera.width, height = picture.camera.height, pixels = width * height;
    const uint32_t most = pixels_at_once(width, height);
    const FrameCameras cameras = {picture.camera.view, camera_before, width, height};
    const Buffer<Ray> rays(queue, most, "rays of motion vectors");
    const Buffer<uint32_t> keys(queue, most, "keys of motion vectors"), instances(queue, most, "motion vectors' hits");
    const Buffer<Float4> places(queue, most, "motion vectors' hits");
    const Buffer<Vec2> motion(queue, most, "motion vectors");
    Image image{width, height, 2, {}};
    image.pixels.resize(std::size_t(2) * pixels);
    for (uint32_t first = 0; first < pixels; first += most) {
        const uint32_t count = std::min(most, pixels - first);
        const HitQueueView hits = {places.data(), instances.data()};
        launch(queue, "centre_rays", count, CentreRays{cameras.now, width, first, rays.data(), keys.data()});
        tracer.find_hits(RayKind::Camera, {.rays = rays.data(), .keys = keys.data()}, count, hits);
        launch(queue, "motion_of_hits", count,
               MotionOfHits{cameras, picture.scene, before, hits, first, motion.data()});
        queue.copy_to_host(image.pixels.data() + std::size_t(2) * first, motion.data(), count * sizeof(Vec2));
    }
    return image;
}

} // namespace pertev
