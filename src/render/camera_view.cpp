#include "render/camera_view.h"

#include "math/portable_math.h"

namespace pertev {

float half_view_height(const Camera& camera) {
    return camera.projection == Projection::Perspective ? tan(0.5f * camera.fov_y) : 0.5f * camera.ortho_height;
}

CameraView make_camera_view(const Camera& camera, uint32_t width, uint32_t height, Vec3 centre) {
    const float aspect = aspect_of(width, height);
    const float half_height = half_view_height(camera);
    CameraView view = {moved_to(camera.world_from_camera, centre),
                       camera.projection,
                       half_height * aspect,
                       half_height,
                       1.0f / static_cast<float>(width),
                       1.0f / static_cast<float>(height),
                       camera.aperture_radius,
                       camera.focus_distance,
                       {1, 1},
                       {}};
    view.lens = make_lens_view(camera);
    if (camera.projection != Projection::Perspective) return view;
    if (is_panorama(view.lens.model)) {
        const Vec2 half = panorama_half_size(view.lens.model);
        view.half_width = half.x, view.half_height = half.y;
    } else if (const auto& own = camera.intrinsics) {
        const auto halves = [](double pixels, uint32_t side) { return static_cast<float>(2 * pixels / side); };
        view.half_width = static_cast<float>(0.5 * own->width / own->focal_x);
        view.half_height = static_cast<float>(0.5 * own->height / own->focal_y);
        view.centre = {halves(own->centre_x, own->width), halves(own->centre_y, own->height)};
    } else {
        view.half_height = half_height_through(view.lens, 0.5f * camera.fov_y);
        view.half_width = view.half_height * aspect;
    }
    return view;
}

} // namespace pertev
