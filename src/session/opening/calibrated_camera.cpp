#include "session/opening/calibrated_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/limits.h"
#include "image/read_exr.h"
#include "math/portable_math.h"
#include "scene/projection_features.h"
#include "scene/scene_origin.h"
#include "settings/parse_values.h"
#include "settings/setting_table.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

constexpr double kRigid = 1e-3;       // how far the products of a pose's axes may be from those of a rotation
constexpr double kAsStated = 0x1p-20; // up to which the axes stay as they are stated

std::string text_of(const std::vector<double>& numbers) { return fmt::format("{}", fmt::join(numbers, ",")); }

/// Returns the greatest difference of the axes' products from those of unit axes at right angles.
double distance_from_rigid(const std::array<DoubleVec3, 3>& axes) {
    double distance = 0;
    for (int i = 0; i < 3; ++i) {
        for (int k = i; k < 3; ++k) distance = std::max(distance, ::fabs(dot(axes[i], axes[k]) - (i == k)));
    }
    return distance;
}

/// Returns whether the 3x3 matrix of K has nothing but focal lengths and a principal point.
bool is_plain(const std::vector<double>& k) { return k[1] == 0 && k[3] == 0 && k[6] == 0 && k[7] == 0 && k[8] == 1; }

/// Returns whether a focal length or a principal point is near a picture with sides of `side` pixels.
bool is_near(double pixels, uint32_t side) { return ::fabs(pixels) <= 1e6 * side; }

/// Returns the text of an entry under the name of a setting; nothing if there is none.
std::optional<std::string> entry_of(const ExrFile& file, std::string_view name) {
    for (const auto& [key, value] : file.metadata) {
        if (key == fmt::format("pertev.{}", name))
            return std::visit([](const auto& v) { return fmt::format("{}", v); }, value);
    }
    return std::nullopt;
}

void set_from(PictureOptions& options, const char* name, const std::string& text) {
    const auto given = options.given;
    set_value(options, *find_setting(name), {&text, 1});
    options.given = given;
}

} // namespace

Transform placed_by_pose(const CameraChoice& choice, const Scene& scene) {
    const std::vector<double>& m = choice.pose;
    const auto refuse = [&](const char* why) { throw Error(ErrorCode::BadInput, "camera_pose", text_of(m), why); };
    if (m.size() == 16 && !(m[12] == 0 && m[13] == 0 && m[14] == 0 && m[15] == 1)) {
        refuse("expected 0,0,0,1 as the last row of a pose");
    }
    std::array<DoubleVec3, 4> columns; // axes, then the place
    for (std::size_t k = 0; k < 4; ++k) columns[k] = {m[k], m[4 + k], m[8 + k]};
    const PoseConvention convention = choice.convention.value_or(PoseConvention::OpenGl);
    if (convention == PoseConvention::OpenCv) {
        for (DoubleVec3* axis : {&columns[1], &columns[2]}) *axis = {-axis->x, -axis->y, -axis->z};
    }
    if (convention == PoseConvention::Blender) {
        for (DoubleVec3& column : columns) column = {column.x, column.z, -column.y};
    }
    const double off = distance_from_rigid({columns[0], columns[1], columns[2]});
    if (!(off <= kRigid)) refuse("the columns of a pose are its axes; expected unit length and right angles");
    if (!(dot(columns[0], cross(columns[1], columns[2])) > 0))
        refuse("the pose mirrors, because its third axis has the wrong sign");
    const Vec3 x = to_float(columns[0]), y = to_float(columns[1]), z = to_float(columns[2]);
    if (max_component(abs(to_float(columns[3]))) > kMaxCoordinate) {
        throw Error(ErrorCode::OverLimit, "camera_pose", text_of(m),
                    fmt::format("beyond the limit of {} m from the origin", limit_text(kMaxCoordinate)));
    }
    const Transform stated = {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}, in_scene(scene, columns[3])};
    return off <= kAsStated ? stated : *without_scale(stated);
}

void set_lens(const CameraChoice& choice, Camera& camera) {
    if (choice.fov_deg) camera.intrinsics.reset();
    if (!choice.intrinsics.empty()) {
        const std::vector<double>& k = choice.intrinsics;
        const auto refuse = [&](const char* why) { throw Error(ErrorCode::BadInput, "intrinsics", text_of(k), why); };
        if (k.size() == 9 && !is_plain(k)) refuse("expected fx,0,cx,0,fy,cy,0,0,1; skew is not supported");
        const PictureSize size = choice.intrinsics_size.value_or(PictureSize{});
        PERTEV_CHECK(size.width > 0 && size.height > 0);
        Intrinsics own = {k[0], k[1], k[2], k[3], size.width, size.height};
        if (k.size() == 9) own = {k[0], k[4], k[2], k[5], size.width, size.height};
        constexpr double kLeast = 1e-6; // focal length, in sides of the picture
        for (const auto& [focal, centre, side] :
             {std::tuple(own.focal_x, own.centre_x, own.width), {own.focal_y, own.centre_y, own.height}}) {
            if (!(focal >= kLeast * side && is_near(focal, side) && is_near(centre, side)))
                refuse("expected focal lengths above 0, and a principal point near the picture");
        }
        camera.intrinsics = own;
        camera.fov_y = 2 * atan(static_cast<float>(0.5 * own.height / own.focal_y));
    }
    if (choice.lens) camera.lens = *choice.lens;
    if (is_panorama(camera.lens)) camera.intrinsics.reset(); // a scene's camera may have them
    if (!choice.distortion.empty()) {
        if (camera.lens == LensModel::Straight) camera.lens = LensModel::OpenCv;
        camera.distortion = choice.distortion;
    }
    const std::string_view lens = name_of(camera.lens);
    if (!takes_coefficients(camera.lens, camera.distortion.size())) {
        throw Error(ErrorCode::BadInput, "distortion", text_of(camera.distortion),
                    fmt::format("expected {} with `lens={}`", coefficient_names(camera.lens), lens));
    }
    if (sees_behind(camera.lens) && camera.aperture_radius > 0) {
        throw Error(ErrorCode::BadInput, "lens", std::string(lens),
                    "this lens has no depth of field; set `aperture=0`");
    }
}

void check_aperture(const CameraChoice& choice) {
    const uint32_t blades = choice.aperture_blades.value_or(0);
    if (is_blade_count(blades)) return;
    throw Error(ErrorCode::BadInput, "aperture_blades", fmt::format("{}", blades),
                fmt::format("expected from {} to {}, or 0 for a disk", kMinBlades, kMaxBlades));
}

void offset_eye(const CameraChoice& choice, Camera& camera) {
    if (choice.eye_offset == 0) return;
    if (is_panorama(camera.lens)) {
        throw Error(ErrorCode::BadInput, "eye_offset", fmt::format("{}", choice.eye_offset),
                    "the eyes of a panorama would lie on a circle, which is not supported");
    }
    Transform& placed = camera.world_from_camera;
    placed.translation = placed.translation + static_cast<float>(choice.eye_offset) * column(placed, 0);
    if (max_component(abs(placed.translation)) > kMaxCoordinate) {
        throw Error(ErrorCode::OverLimit, "eye_offset", fmt::format("{}", choice.eye_offset),
                    fmt::format("beyond the limit of {} m from the origin", limit_text(kMaxCoordinate)));
    }
    if (!choice.convergence) return;
    const auto refuse = [&](const char* why) {
        throw Error(ErrorCode::BadInput, "convergence", fmt::format("{}", *choice.convergence), why);
    };
    if (has_parallel_rays(camera.projection)) refuse("the view is orthographic, whose pictures never coincide");
    if (!camera.intrinsics) {
        if (camera.lens != LensModel::Straight) refuse("a lens with distortion needs its `intrinsics`");
        const PictureSize size = choice.intrinsics_size.value_or(PictureSize{});
        PERTEV_CHECK(size.width > 0 && size.height > 0);
        const double focal = 0.5 * size.height / static_cast<double>(tan(0.5f * camera.fov_y));
        camera.intrinsics = {focal, focal, 0.5 * size.width, 0.5 * size.height, size.width, size.height};
    }
    camera.intrinsics->centre_x += camera.intrinsics->focal_x * choice.eye_offset / *choice.convergence;
    if (!is_near(camera.intrinsics->centre_x, camera.intrinsics->width))
        refuse("too near for this distance of the eyes");
}

void fit_intrinsics(PictureSize picture, CameraChoice& choice) {
    if (choice.intrinsics.empty() && !choice.convergence) return;
    if (!choice.intrinsics_size) choice.intrinsics_size = picture;
    const PictureSize own = *choice.intrinsics_size;
    const auto across = [](uint32_t a, uint32_t b) { return static_cast<int64_t>(uint64_t{a} * b); };
    const int64_t off = across(picture.width, own.height) - across(picture.height, own.width);
    if (std::abs(off) <= std::max({picture.width, picture.height, own.width, own.height})) return;
    throw Error(ErrorCode::BadInput, "intrinsics_size", fmt::format("{}x{}", own.width, own.height),
                fmt::format("`size={}x{}` has another shape; crop the calibration to it, or choose a size that is a "
                            "multiple",
                            picture.width, picture.height));
}

void apply_camera_from(PictureOptions& options) {
    CameraChoice& choice = options.scene.camera;
    if (choice.camera_from.empty()) return;
    const ExrFile file = read_exr(choice.camera_from);
    const auto is_given = [&](const char* name) { return options.is_given(name); };
    const auto take = [&](const char* name) {
        const auto text = entry_of(file, name);
        if (text && !text->empty() && !is_given(name)) set_from(options, name, *text);
    };
    const std::optional<std::string> columns = entry_of(file, "world_from_camera");
    if (!columns) {
        throw Error(ErrorCode::BadInput, "camera_from", choice.camera_from,
                    "the metadata of the file have no camera (`pertev.world_from_camera`)");
    }
    if (!is_given("camera_pose") && !choice.eye && !choice.target && !choice.up) {
        std::string text = *columns; // "x,y,z x,y,z x,y,z x,y,z", by columns
        std::ranges::replace(text, ' ', ',');
        set_from(options, "camera_pose", text);
        const std::vector<double> c = choice.pose;
        for (std::size_t i = 0; i < 12; ++i) choice.pose[i] = c[i % 4 * 3 + i / 4];
        choice.convention.reset();
    }
    take("projection");
    const bool has_angle = has_angle_of_view(choice.projection.value_or(Projection{}));
    const bool has_own_view = is_given("fov") || is_given("intrinsics") || !has_angle;
    if (!has_own_view && entry_of(file, "intrinsics")) {
        take("intrinsics");
        take("intrinsics_size");
    } else if (!is_given("intrinsics")) {
        take("fov");
        const std::optional<std::string> radians = entry_of(file, "fov_y");
        if (radians && !is_given("fov")) choice.fov_y = parse_number("fov_y", *radians);
    }
    for (const char* name : {"view_height", "aperture", "lens", "distortion"}) take(name);
    if (choice.aperture != 0.0f) {
        for (const char* name : {"aperture_blades", "aperture_ratio", "focus"}) take(name);
        if (choice.aperture_blades != 0u) take("aperture_rotation"); // a disk has none
    }
    if (!has_angle) choice.lens.reset(), choice.distortion.clear();
    if (!options.size && !choice.intrinsics_size) options.size = PictureSize{file.width, file.height};
}

} // namespace pertev
