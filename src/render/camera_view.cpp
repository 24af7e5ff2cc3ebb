#include "render/camera_view.h"

#include "math/portable_math.h"

namespace pertev {

float half_view_height(const Camera& camera) {
    return camera.projection == Projection::Perspective ? tan(0.5f * camera.fov_y) : 0.5f * camera.ortho_height;
}

CameraView make_camera_view(const Camera& camera, uint32_t width, uint32_t height, Vec3 centre) {
    const float aspect = aspect_of(width, height);
    const float half_height = half_view_height(camera);
    return {moved_to(camera.world_from_camera, centre),
            camera.projection,
            half_height * aspect,
            half_height,
            1.0f / static_cast<float>(width),
            1.0f / static_cast<float>(height),
            camera.aperture_radius,
            camera.focus_distance};
}

} // namespace pertev
