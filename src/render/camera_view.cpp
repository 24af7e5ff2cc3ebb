#include "render/camera_view.h"

#include <cmath>

#include "math/portable_math.h"
#include "math/portable_trig.h"

namespace pertev {
namespace {

RegularPolygon blades_of(const ApertureShape& aperture) {
    if (aperture.blades == 0) return {};
    const double turns = static_cast<double>(aperture.rotation_deg) / 360;
    const auto turn = static_cast<float>(turns - std::floor(turns)); // rounds to 1 just below it
    RegularPolygon polygon = {.sides = static_cast<float>(aperture.blades)};
    polygon.inv_sides = 1.0f / polygon.sides;
    float half_side;
    sin_cos_2pi(0.5f * polygon.inv_sides, half_side, polygon.apothem);
    polygon.side = 2 * half_side;
    polygon.turn = turn < 1 ? turn : 0;
    return polygon;
}

} // namespace

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
                       camera.aperture_radius / camera.aperture.ratio,
                       blades_of(camera.aperture),
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
