#include "render/hidden_back_share.h"

#include <vector>

#include "device/buffer.h"
#include "math/random.h"

namespace pertev {

double hidden_back_share(Queue& queue, SceneTracer& tracer, const PictureView& picture) {
    if (picture.scene.any_hidden_back == 0) return 0;
    constexpr uint32_t kSide = 64, kRays = kSide * kSide;
    const float width = static_cast<float>(picture.camera.width), height = static_cast<float>(picture.camera.height);
    std::vector<Ray> rays;
    std::vector<uint32_t> keys;
    for (uint32_t i = 0; i < kRays; ++i) {
        const Vec2 position = {(static_cast<float>(i % kSide) + 0.5f) * (width / kSide),
                               (static_cast<float>(i / kSide) + 0.5f) * (height / kSide)};
        rays.push_back(make_camera_ray(picture.camera.view, position, {0.5f, 0.5f})); // through the middle of the lens
        keys.push_back(hash_words(i, 0, 0, 0).x);
    }
    const Buffer<Ray> rays_there(queue, std::span<const Ray>(rays), "rays that count backs");
    const Buffer<uint32_t> keys_there(queue, std::span<const uint32_t>(keys), "keys that count backs");
    const Buffer<Float4> records(queue, kRays, "hits that count backs");
    const auto find = [&](RayKind kind) {
        const Buffer<uint32_t> instances(queue, kRays, "hits that count backs");
        tracer.find_hits(kind, {.rays = rays_there.data(), .keys = keys_there.data()}, kRays,
                         {records.data(), instances.data()});
        return std::pair(records.download(), instances.download());
    };
    const auto [hits, hit_instances] = find(RayKind::Bounce); // bounce rays hit back faces
    const auto [seen_hits, seen_instances] = find(RayKind::Camera);
    uint32_t passed = 0;
    for (uint32_t i = 0; i < kRays; ++i) {
        passed += hit_instances[i] != seen_instances[i] || bits_of(hits[i].w) != bits_of(seen_hits[i].w) ? 1 : 0;
    }
    return static_cast<double>(passed) / kRays;
}

} // namespace pertev
