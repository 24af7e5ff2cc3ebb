#include "denoise/motion_vectors.h"

#include <algorithm>

#include "device/launch.h"

namespace pertev {
namespace {

constexpr uint32_t kAtOnce = 1 << 18; // pixels

uint32_t pixels_at_once(uint32_t width, uint32_t height) {
    return static_cast<uint32_t>(std::min<uint64_t>(kAtOnce, uint64_t(width) * height));
}

} // namespace

MotionVectorMemory::MotionVectorMemory(Queue& queue, uint32_t width, uint32_t height)
    : most(pixels_at_once(width, height)), rays(queue, most, "rays of motion vectors"),
      keys(queue, most, "keys of motion vectors"), instances(queue, most, "motion vectors' hits"),
      hits(queue, most, "motion vectors' hits"), motion(queue, most, "motion vectors") {}

Image motion_vectors(Queue& queue, SceneTracer& tracer, const PictureView& picture, const CameraView& camera_before,
                     const PreviousScene& before) {
    const uint32_t width = picture.camera.width, height = picture.camera.height, pixels = width * height;
    const MotionVectorMemory memory(queue, width, height);
    const FrameCameras cameras = {picture.camera.view, camera_before, width, height};
    Image image{width, height, 2, {}};
    image.pixels.resize(std::size_t(2) * pixels);
    for (uint32_t first = 0; first < pixels; first += memory.most) {
        const uint32_t count = std::min(memory.most, pixels - first);
        const HitQueueView hits = {memory.hits.data(), memory.instances.data()};
        launch(queue, "centre_rays", count,
               CentreRays{cameras.now, width, first, memory.rays.data(), memory.keys.data()});
        tracer.find_hits(RayKind::Camera, {.rays = memory.rays.data(), .keys = memory.keys.data()}, count, hits);
        launch(queue, "motion_of_hits", count,
               MotionOfHits{cameras, picture.scene, before, hits, first, memory.motion.data()});
        queue.copy_to_host(image.pixels.data() + std::size_t(2) * first, memory.motion.data(), count * sizeof(Vec2));
    }
    return image;
}

} // namespace pertev
