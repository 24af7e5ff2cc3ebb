#include "render/camera_work.h"

#include "base/parallel_for.h"
#include "device/buffer.h"

namespace pertev {

std::vector<RayWork> count_camera_work(Queue& queue, const SceneTracer& tracer, const PictureView& picture) {
    const uint32_t width = picture.camera.width, pixels = width * picture.camera.height;
    std::vector<Ray> rays(pixels);
    parallel_for(pixels, 4096, [&](uint64_t i) {
        const Vec2 position = {static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f};
        rays[i] = make_camera_ray(picture.camera.view, position, {0.5f, 0.5f});
    });
    const Buffer<Ray> rays_there(queue, std::span<const Ray>(rays), "rays of a heat map");
    const Buffer<RayWork> work(queue, pixels, "counts of a heat map");
    const TraceQuery query = {.rays = {.rays = rays_there.data()}};
    if (!tracer.tracer(RayKind::Camera).count_work(false, query, pixels, work.data())) return {};
    return work.download();
}

} // namespace pertev
