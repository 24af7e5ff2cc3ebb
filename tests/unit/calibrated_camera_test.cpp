// Cameras of calibrations and pictures: a matrix in three conventions, K, a lens, an EXR's metadata.

#include <cmath>

#include <doctest/doctest.h>

#include "base/error.h"
#include "image/write_exr.h"
#include "session/opening/calibrated_camera.h"
#include "session/opening/choose_camera.h"
#include "session/writing/picture_metadata.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

using Convention = PoseConvention;

/// Returns the matrix with these columns, row by row.
std::vector<double> rows_of(Vec3 x, Vec3 y, Vec3 z, DoubleVec3 place) {
    const auto d = [](float f) { return static_cast<double>(f); };
    return {d(x.x), d(y.x), d(z.x), place.x, d(x.y), d(y.y), d(z.y), place.y,
            d(x.z), d(y.z), d(z.z), place.z, 0,      0,      0,      1};
}

const Transform kPlaced = look_at({1.25f, 2.5f, 3}, {-0.3f, 0.7f, -1}, {0.1f, 1, 0});

std::vector<double> pose_in(Convention convention) {
    const Vec3 x = column(kPlaced, 0), y = column(kPlaced, 1), z = column(kPlaced, 2);
    const Vec3 at = kPlaced.translation;
    const auto blender = [](Vec3 v) { return Vec3{v.x, -v.z, v.y}; }; // converts to a world with z up
    switch (convention) {
    case Convention::OpenGl:
        break;
    case Convention::OpenCv:
        return rows_of(x, -y, -z, to_double(at));
    case Convention::Blender:
        return rows_of(blender(x), blender(y), blender(z), to_double(blender(at)));
    }
    return rows_of(x, y, z, to_double(at));
}

Camera made_of(const CameraChoice& choice, const Scene& scene = {}) {
    Messages messages;
    return choose_camera(choice, scene, 1.5f, messages);
}

/// Returns the error of a pose.
std::optional<Error> fault_of_pose(std::vector<double> pose) {
    return test::thrown_error([&] { made_of({.pose = std::move(pose)}); });
}

CameraChoice of_intrinsics(std::vector<double> k) {
    return {.eye = DoubleVec3{0, 0, 1}, .intrinsics = std::move(k), .intrinsics_size = PictureSize{640, 480}};
}

std::filesystem::path written_camera(const CameraSource& source, ExrMetadata more = {}) {
    ExrMetadata metadata = camera_metadata(source);
    metadata.insert(metadata.end(), more.begin(), more.end());
    const std::filesystem::path path = test::scratch_folder() / "camera.exr";
    write_exr(path, Image{40, 30, 3, std::vector<float>(3600)}, {}, metadata);
    return path;
}

/// Returns the camera that camera_from makes of the file, with further settings.
Camera read_back(const std::filesystem::path& path, const std::vector<std::pair<std::string, std::string>>& more = {},
                 const Scene& scene = {}) {
    PictureOptions options;
    options.scene.camera.camera_from = path.string();
    for (const auto& [name, text] : more) set_value(options, *find_setting(name), {&text, 1});
    apply_camera_from(options);
    return made_of(options.scene.camera, scene);
}

} // namespace

TEST_CASE("all three conventions of a pose place the camera of eye and target, to the bit") {
    for (const Convention convention : {Convention::OpenGl, Convention::OpenCv, Convention::Blender}) {
        CAPTURE(static_cast<int>(convention));
        std::vector<double> pose = pose_in(convention);
        CHECK(made_of({.pose = pose, .convention = convention}).world_from_camera == kPlaced);
        pose.resize(12);
        CHECK(made_of({.pose = pose, .convention = convention}).world_from_camera == kPlaced);
    }
    CHECK(made_of({.pose = pose_in(Convention::OpenGl)}).world_from_camera == kPlaced); // the default
    // An unrotated camera at Blender's origin looks down, with the world's y up in the picture.
    const Camera down = made_of({.pose = {1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7}, .convention = Convention::Blender});
    CHECK(column(down.world_from_camera, 2) == Vec3{0, 1, 0});
    CHECK(column(down.world_from_camera, 1) == Vec3{0, 0, -1});
    CHECK(down.world_from_camera.translation == Vec3{5, 7, -6});
}

TEST_CASE("a pose with few digits is rounded to a rotation, and a matrix that is not a rotation is refused") {
    const Camera camera = made_of({.pose = {0.7071, 0, 0.7071, 0, 0, 1, 0, 0, -0.7071, 0, 0.7071, 0}});
    CHECK(length(column(camera.world_from_camera, 2)) == doctest::Approx(1).epsilon(1e-6));
    CHECK(column(camera.world_from_camera, 0).x == doctest::Approx(std::sqrt(0.5)).epsilon(1e-4));
    const std::vector<std::vector<double>> wrong = {{2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0},              // scale
                                                    {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0},             // mirror
                                                    {1, 0.1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},            // shear
                                                    {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1}}; // transposed
    for (const std::vector<double>& pose : wrong) {
        CHECK(test::is_about(fault_of_pose(pose), ErrorCode::BadInput, "camera_pose"));
    }
    CHECK(test::is_about(fault_of_pose({1, 0, 0, 2e12, 0, 1, 0, 0, 0, 0, 1, 0}), ErrorCode::OverLimit, "camera_pose"));
}

TEST_CASE("a pose is in the coordinates of the scene's file") {
    Scene far;
    far.origin_in_file = {500000, 100, -4000000};
    const Camera camera = made_of({.pose = {1, 0, 0, 500001.5, 0, 1, 0, 102, 0, 0, 1, -3999999.75}}, far);
    CHECK(camera.world_from_camera.translation == Vec3{1.5f, 2, 0.25f});
}

TEST_CASE("intrinsics are four numbers or the nine of K, and unsupported entries of K are refused") {
    const Camera four = made_of(of_intrinsics({500, 550, 310, 250})),
                 nine = made_of(of_intrinsics({500, 0, 310, 0, 550, 250, 0, 0, 1}));
    CHECK(four.intrinsics == Intrinsics{500, 550, 310, 250, 640, 480});
    CHECK(nine.intrinsics == four.intrinsics);
    CHECK(four.fov_y == doctest::Approx(2 * std::atan(240 / 550.0)));
    for (const std::vector<double>& k : {std::vector<double>{500, 1, 310, 0, 550, 250, 0, 0, 1},
                                         {500, 0, 310, 0, 550, 250, 0, 0, 2},
                                         {0, 1, 2, 3},
                                         {-500, 500, 1, 1},
                                         {1e30, 500, 1, 1},
                                         {500, 500, 1e12, 1}}) {
        CHECK(
            test::is_about(test::thrown_error([&] { made_of(of_intrinsics(k)); }), ErrorCode::BadInput, "intrinsics"));
    }
}

TEST_CASE("intrinsics of an angle of view give its view, within rounding") {
    const double focal = 240 / std::tan(0.35);
    const CameraView view = make_camera_view(made_of(of_intrinsics({focal, focal, 320, 240})), 320, 240);
    Camera plain;
    plain.fov_y = 0.7f;
    const CameraView expected = make_camera_view(plain, 320, 240);
    CHECK(view.half_height == doctest::Approx(expected.half_height).epsilon(1e-6));
    CHECK(view.half_width == doctest::Approx(expected.half_width).epsilon(1e-6));
    CHECK((view.centre.x == 1 && view.centre.y == 1));
}

TEST_CASE("intrinsics take the picture's size if they have none, and refuse a picture of another shape") {
    CameraChoice choice = {.intrinsics = {1, 1, 1, 1}};
    fit_intrinsics({640, 480}, choice);
    CHECK(choice.intrinsics_size == PictureSize{640, 480});
    fit_intrinsics({320, 240}, choice);
    fit_intrinsics({333, 250}, choice); // the nearest size in whole pixels
    CHECK(choice.intrinsics_size == PictureSize{640, 480});
    const auto error = test::thrown_error([&] { fit_intrinsics({1280, 720}, choice); });
    CHECK(test::is_about(error, ErrorCode::BadInput, "intrinsics_size", "640x480"));
}

TEST_CASE("the eyes of a stereo pair lie beside the camera, and their pictures coincide at the convergence") {
    CameraChoice choice = {.eye = DoubleVec3{1, 2, 3}, .target = DoubleVec3{1, 2, -7}, .fov_deg = 50.0f, .focus = 4.0f};
    const Camera middle = made_of(choice);
    CHECK(!middle.intrinsics);
    for (const double offset : {-0.25, 0.25}) {
        choice.eye_offset = offset;
        choice.convergence.reset();
        Camera parallel = middle;
        parallel.world_from_camera.translation.x += static_cast<float>(offset);
        CHECK(made_of(choice) == parallel);
        choice.convergence = 5;
        for (const bool is_calibrated : {false, true}) {
            CameraChoice of_picture = choice;
            if (is_calibrated) of_picture.fov_deg.reset(), of_picture.intrinsics = {500, 600, 310, 250};
            fit_intrinsics({640, 480}, of_picture);
            const Camera eye = made_of(of_picture);
            REQUIRE(eye.intrinsics);
            const double focal = eye.intrinsics->focal_x;
            CHECK(eye.intrinsics->centre_x == doctest::Approx((is_calibrated ? 310 : 320) + focal * offset / 5));
            CHECK(eye.intrinsics->centre_y == doctest::Approx(is_calibrated ? 250 : 240));
            const CameraView view = make_camera_view(eye, 640, 480);
            const double tangent = 5 * (400 - eye.intrinsics->centre_x) / focal + offset;
            CHECK(tangent == doctest::Approx(5 * (400 - (is_calibrated ? 310 : 320)) / focal));
            CHECK(view.half_height == doctest::Approx(0.5 * 480 / eye.intrinsics->focal_y));
        }
    }
    choice.lens = LensModel::Equirectangular;
    CHECK(test::is_about(test::thrown_error([&] { made_of(choice); }), ErrorCode::BadInput, "eye_offset"));
    choice.lens = LensModel::Fisheye, choice.distortion = {0, 0, 0, 0};
    CHECK(test::is_about(test::thrown_error([&] { made_of(choice); }), ErrorCode::BadInput, "convergence"));
}

TEST_CASE("a fisheye has four coefficients and no depth of field") {
    CameraChoice choice = {.eye = DoubleVec3{0, 0, 1}, .lens = LensModel::Fisheye, .distortion = {0, 0, 0, 0, 0}};
    CHECK(test::is_about(test::thrown_error([&] { made_of(choice); }), ErrorCode::BadInput, "distortion"));
    choice.distortion = {0.1, 0, 0, 0};
    CHECK(made_of(choice).lens == LensModel::Fisheye);
    choice.aperture = 0.1f;
    choice.focus = 1.0f;
    CHECK(test::is_about(test::thrown_error([&] { made_of(choice); }), ErrorCode::BadInput, "lens"));
    CHECK(made_of({.eye = DoubleVec3{0, 0, 1}, .distortion = {0.1, 0, 0, 0}}).lens == LensModel::OpenCv);
}

TEST_CASE("the metadata of a picture give its camera back to the bit") {
    CameraSource source;
    Camera& camera = source.camera;
    camera.world_from_camera = kPlaced;
    for (const float fov_y : {0.7f, 0.70000005f, 0.7000001f, 1.1f, 1.1000001f}) { // some have no angle in degrees
        camera.fov_y = fov_y;
        const Camera again = read_back(written_camera(source));
        CHECK(again.world_from_camera == kPlaced);
        CHECK(again.fov_y == fov_y);
        CHECK(!again.intrinsics);
        CHECK(again.aspect == 0);
    }
    camera.aperture_radius = 0.01f, camera.focus_distance = 3.3f;
    camera.aperture = {.blades = 5, .rotation_deg = 33.3f, .ratio = 1.7f};
    camera.intrinsics = Intrinsics{500.1, 550.7, 310, 250.3, 640, 480};
    camera.lens = LensModel::OpenCv;
    camera.distortion = {-0.28, 0.07, 0.001, -0.0005, 0.02};
    const std::filesystem::path file = written_camera(source);
    const Camera again = read_back(file);
    CHECK(again.world_from_camera == kPlaced);
    CHECK(again.intrinsics == camera.intrinsics);
    CHECK(again.lens == camera.lens);
    CHECK(again.distortion == camera.distortion);
    CHECK(again.aperture_radius == camera.aperture_radius);
    CHECK(again.aperture == camera.aperture);
    CHECK(again.focus_distance == camera.focus_distance);

    SUBCASE("other settings override a picture's camera") {
        const Camera turned =
            read_back(file, {{"eye", "0,0,5"}, {"target", "0,0,0"}, {"fov", "40"}, {"aperture", "0"}});
        CHECK(turned.world_from_camera == look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}));
        CHECK(!turned.intrinsics);
        CHECK(turned.distortion == camera.distortion);
        CHECK(turned.aperture_radius == 0);
        const Camera round = read_back(file, {{"aperture_blades", "0"}});
        CHECK(round.aperture == ApertureShape{.ratio = 1.7f}); // a disk has no rotation
        const Camera flat = read_back(file, {{"projection", "orthographic"}});
        CHECK((flat.projection == Projection::Orthographic && flat.distortion.empty() && !flat.intrinsics));
    }
    SUBCASE("the metadata of an orthographic camera and of a far scene give the camera back, too") {
        camera = {.projection = Projection::Orthographic, .world_from_camera = kPlaced, .ortho_height = 2.7f};
        Scene far;
        source.origin = far.origin_in_file = {500000, 100, -4000000};
        const Camera there = read_back(written_camera(source), {}, far);
        CHECK(there.world_from_camera == kPlaced);
        CHECK((there.projection == Projection::Orthographic && there.ortho_height == 2.7f));
    }
    SUBCASE("the picture has the size of its file unless another is given") {
        camera.intrinsics.reset();
        PictureOptions options;
        options.scene.camera.camera_from = written_camera(source).string();
        apply_camera_from(options);
        CHECK(options.size == PictureSize{40, 30});
    }
}

TEST_CASE("a picture without a camera's metadata is refused") {
    const std::filesystem::path path = test::scratch_folder() / "plain.exr";
    write_exr(path, Image{2, 2, 3, std::vector<float>(12)});
    CHECK(test::is_about(test::thrown_error([&] { read_back(path); }), ErrorCode::BadInput, "camera_from"));
}
