// Files of many cameras, valid and invalid: Pertev's JSON, NeRF's transforms.json, and COLMAP's text and binary files.

#include <cmath>
#include <cstring>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "formats/cameras/read_cameras.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace {

std::string stated(const CameraOfFile& camera, std::string_view name) {
    for (const SuggestedSetting& one : camera.settings) {
        if (one.name == name) return one.text;
    }
    return "none";
}

std::vector<double> numbers_in_text(const std::string& text) {
    std::vector<double> all;
    for (const char* at = text.c_str(); *at != '\0';) {
        char* end = nullptr;
        all.push_back(std::strtod(at, &end));
        at = *end == ',' ? end + 1 : end;
    }
    return all;
}

std::vector<CameraOfFile> cameras_in(const std::string& json, uint32_t width = 0, uint32_t height = 0) {
    return read_cameras(test::write_text(test::scratch_folder() / "cameras.json", json), width, height);
}
std::string pointer_of_fault(const std::string& json) {
    const auto error = test::thrown_error([&] { cameras_in(json); });
    return error && error->location() ? error->location()->pointer.value_or("none") : "no error";
}

struct Colmap {
    std::filesystem::path folder = test::scratch_folder();

    Colmap(const std::string& cameras, const std::string& images, const char* ending = ".txt") {
        test::write_text(folder / (std::string("cameras") + ending), cameras);
        test::write_text(folder / (std::string("images") + ending), images);
    }
    /// Returns the file and line of the error.
    std::pair<std::string, uint64_t> fault() const {
        const auto error = test::thrown_error([&] { read_cameras(folder); });
        if (!error || !error->location()) return {"no error", 0};
        return {std::filesystem::path(error->location()->file).filename().string(), error->location()->line};
    }
};

template <class... Values>
std::string packed(Values... values) {
    std::string bytes;
    const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    (add(values), ...);
    return bytes;
}

constexpr const char* kColmapCameras =
    "# Camera list\n1 OPENCV 640 480 500 550 320.5 241 -0.1 0.02 0.001 -0.002\n"
    "7 OPENCV_FISHEYE 800 600 300 301 400 300 0.1 0.2 0.3 0.4\n2 SIMPLE_RADIAL 64 48 50 32 24 0.5\n";

} // namespace

TEST_CASE("Pertev's file states settings for each camera and for all cameras") {
    const auto cameras =
        cameras_in(R"({"cameras":[{"name":"a","eye":[0,1,2.5],"fov":40},{"camera_pose":[[1,0,0,4],[0,1,0,5],
        [0,0,1,6]],"lens":"opencv"}],"lens":"fisheye","intrinsics_size":"64x48"})");
    REQUIRE(cameras.size() == 2);
    CHECK(cameras[0].name == "a");
    CHECK(stated(cameras[0], "eye") == "0,1,2.5");
    CHECK(stated(cameras[0], "fov") == "40");
    CHECK(stated(cameras[0], "lens") == "fisheye");
    CHECK(cameras[1].name == "1");
    CHECK(stated(cameras[1], "camera_pose") == "1,0,0,4,0,1,0,5,0,0,1,6");
    CHECK(stated(cameras[1], "lens") == "opencv");
    CHECK(stated(cameras[1], "intrinsics_size") == "64x48");
    CHECK(cameras[1].location.pointer == "/cameras/1");
}

TEST_CASE("transforms.json has poses, focal lengths for all frames or one, and lenses") {
    const std::string matrix = R"("transform_matrix":[[1,0,0,2],[0,1,0,3],[0,0,1,4],[0,0,0,1]])";
    const auto angle =
        cameras_in(R"({"camera_angle_x":0.8,"frames":[{"file_path":"./train/r_0.png",)" + matrix + "}]}", 400, 300);
    REQUIRE(angle.size() == 1);
    CHECK(angle[0].name == "train_r_0");
    CHECK(stated(angle[0], "camera_pose") == "1,0,0,2,0,1,0,3,0,0,1,4,0,0,0,1");
    CHECK(stated(angle[0], "convention") == "none"); // opengl or the stated convention
    CHECK(stated(angle[0], "intrinsics_size") == "400x300");
    CHECK(numbers_in_text(stated(angle[0], "intrinsics"))[0] == doctest::Approx(200 / std::tan(0.4)).epsilon(1e-6));
    CHECK(numbers_in_text(stated(angle[0], "intrinsics"))[3] == 150);
    const auto calibrated =
        cameras_in(R"({"fl_x":500,"fl_y":510,"cx":311,"cy":222,"w":640,"h":480,"k1":0.1,"p2":0.2,"frames":[
        {"file_path":"../images/1.jpg",)" +
                   matrix + R"(},{"file_path":"2.jpg","fl_x":400,"camera_model":"PINHOLE",)" + matrix +
                   R"(},{"file_path":"3","camera_model":"OPENCV_FISHEYE","k4":4,)" + matrix + "}]}");
    REQUIRE(calibrated.size() == 3);
    CHECK(calibrated[0].name == "images_1");
    CHECK(stated(calibrated[0], "intrinsics") == "500,510,311,222");
    CHECK(stated(calibrated[0], "distortion") == "0.1,0,0,0.2,0");
    CHECK(stated(calibrated[1], "intrinsics") == "400,510,311,222");
    CHECK(stated(calibrated[1], "lens") == "none");
    CHECK(stated(calibrated[2], "lens") == "fisheye");
    CHECK(stated(calibrated[2], "distortion") == "0.1,0,0,4");
}

TEST_CASE("an invalid JSON file of cameras is refused with the location of its fault") {
    const std::string matrix = R"("transform_matrix":[[1,0,0,2],[0,1,0,3],[0,0,1,4],[0,0,0,1]])";
    CHECK(pointer_of_fault(R"({"w":8,"h":8,"frames":[{"file_path":"a",)" + matrix + "}]}") == "/frames/0");
    CHECK(pointer_of_fault(R"({"camera_angle_x":1,"frames":[{)" + matrix + "}]}") == "/frames/0"); // no size
    CHECK(pointer_of_fault(R"({"fl_x":8,"w":8,"h":0,"frames":[{)" + matrix + "}]}") == "/h");
    CHECK(pointer_of_fault(R"({"fl_x":8,"w":8,"h":8,"frames":[{"transform_matrix":[[1,0,0],[0,1,0],[0,0,1]]}]})") ==
          "/frames/0/transform_matrix/0");
    CHECK(pointer_of_fault(R"({"fl_x":8,"w":8,"h":8,"frames":[{}]})") == "/frames/0");
    CHECK(pointer_of_fault(R"({"fl_x":8,"w":8,"h":8,"camera_model":"FOV","frames":[{)" + matrix + "}]}") ==
          "/camera_model");
    CHECK(pointer_of_fault(R"({"cameras":[{"name":"a"},{"name":"a"}]})") == "/cameras/1");
    CHECK(pointer_of_fault(R"({"cameras":[{"name":"a/b"}]})") == "/cameras/0");
    CHECK(pointer_of_fault(R"({"cameras":3})") == "/cameras");
    CHECK(test::thrown_error([] { cameras_in(R"({"cameras":[]})"); }));
    CHECK(test::thrown_error([] { cameras_in("{}"); }));
}

TEST_CASE("COLMAP's text files give the inverses of their poses, in the order of names") {
    // A quarter turn about y, and a camera whose picture has no points and whose name has a space.
    const double half = std::sqrt(0.5);
    const Colmap files(kColmapCameras,
                       fmt::format("# images\n3 1 0 0 0 1 2 3 7 right/b 1.png\n\n"
                                   "1 {0} 0 {0} 0 1 2 3 1 a.jpg\n10 20 -1 30 40 5\n2 1 0 0 0 0 0 0 2 c.jpg\n\n",
                                   half));
    const auto cameras = read_cameras(files.folder);
    REQUIRE(cameras.size() == 3);
    CHECK(cameras[0].name == "a");
    CHECK(cameras[1].name == "c");
    CHECK(cameras[2].name == "right_b 1");
    CHECK(stated(cameras[0], "convention") == "opencv");
    const std::vector<double> pose = numbers_in_text(stated(cameras[0], "camera_pose"));
    const std::vector<double> expected = {0, 0, -1, 3, 0, 1, 0, -2, 1, 0, 0, -1};
    REQUIRE(pose.size() == 12);
    for (std::size_t i = 0; i < 12; ++i) CHECK(std::abs(pose[i] - expected[i]) < 1e-12);
    CHECK(stated(cameras[0], "intrinsics") == "500,550,320.5,241");
    CHECK(stated(cameras[0], "intrinsics_size") == "640x480");
    CHECK(stated(cameras[0], "distortion") == "-0.1,0.02,0.001,-0.002");
    CHECK(stated(cameras[1], "intrinsics") == "50,50,32,24");
    CHECK(stated(cameras[1], "distortion") == "0.5,0,0,0");
    CHECK(stated(cameras[2], "lens") == "fisheye");
    CHECK(stated(cameras[2], "distortion") == "0.1,0.2,0.3,0.4");
    CHECK(read_cameras(files.folder / "images.txt").size() == 3);
}

TEST_CASE("COLMAP's binary files give the same cameras as its text files") {
    const std::string cameras = packed(uint64_t{1}, uint32_t{1}, uint32_t{4}, uint64_t{640}, uint64_t{480}, 500.0,
                                       550.0, 320.5, 241.0, -0.1, 0.02, 0.001, -0.002);
    const std::string image = packed(uint64_t{1}, uint32_t{5}, 1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, uint32_t{1});
    const std::string points = packed(uint64_t{1}, 10.0, 20.0, int64_t{-1});
    const std::string images = image + "a.jpg" + '\0' + points;
    const auto cameras_of_bytes = read_cameras(Colmap(cameras, images, ".bin").folder);
    REQUIRE(cameras_of_bytes.size() == 1);
    CHECK(stated(cameras_of_bytes[0], "camera_pose") == "1,0,0,-1,0,1,0,-2,0,0,1,-3");
    CHECK(stated(cameras_of_bytes[0], "intrinsics") == "500,550,320.5,241");
    CHECK(stated(cameras_of_bytes[0], "distortion") == "-0.1,0.02,0.001,-0.002");
    for (std::size_t size = 0; size < images.size(); size += 7) {
        CHECK(Colmap(cameras, images.substr(0, size), ".bin").fault().first == "images.bin");
    }
    CHECK(Colmap(cameras.substr(0, 30), images, ".bin").fault().first == "cameras.bin");
    const std::string many = image + "a.jpg" + '\0' + packed(UINT64_MAX);
    CHECK(Colmap(cameras, many, ".bin").fault().first == "images.bin");
}

TEST_CASE("COLMAP's workspaces give the cameras of their first model") {
    const Colmap model(kColmapCameras, "1 1 0 0 0 0 0 0 1 a.jpg\n\n");
    const std::filesystem::path workspace = test::scratch_folder();
    const auto error = test::thrown_error([&] { read_cameras(workspace); });
    REQUIRE(error);
    REQUIRE(error->location());
    CHECK(error->location()->file == workspace);
    CHECK(error->reason().find("images.txt or images.bin") != std::string::npos);
    std::filesystem::create_directories(workspace / "sparse");
    std::filesystem::rename(model.folder, workspace / "sparse" / "0");
    CHECK(read_cameras(workspace).front().name == "a");
}

TEST_CASE("invalid COLMAP files are refused with file and line") {
    const std::string image = "1 1 0 0 0 0 0 0 1 a.jpg\n\n";
    using Place = std::pair<std::string, uint64_t>;
    CHECK(Colmap("1 PINHOLE 640 480 500 500 320\n", image).fault() == Place{"cameras.txt", 1});
    CHECK(Colmap("# x\n1 PINHOLE 640 480 500 500 320 240 1\n", image).fault() == Place{"cameras.txt", 2});
    CHECK(Colmap("1 PINHOLE 640 480 500 five 320 240\n", image).fault() == Place{"cameras.txt", 1});
    CHECK(Colmap("1 FISHY 640 480 500 500 320 240\n", image).fault() == Place{"cameras.txt", 1});
    CHECK(Colmap("1 FOV 640 480 500 500 320 240 1\n", image).fault() == Place{"cameras.txt", 1});
    CHECK(Colmap(kColmapCameras, image + "2 1 0 0 0 0 0 0 9 b.jpg\n\n").fault() ==
          Place{"images.txt", 3}); // no camera 9
    CHECK(Colmap(kColmapCameras, image + "2 1 0 0 0 0 0 0 1\n").fault() == Place{"images.txt", 3});
    CHECK(Colmap(kColmapCameras, image + "2 0 0 0 0 0 0 0 1 b.jpg\n").fault() == Place{"images.txt", 3});
    CHECK(Colmap(kColmapCameras, image + "2 1 0 0 inf 0 0 0 1 b.jpg\n").fault() == Place{"images.txt", 3});
    CHECK(Colmap(kColmapCameras, image + image).fault() == Place{"images.txt", 3}); // two cameras have the same name
    CHECK(test::thrown_error([] { read_cameras(test::scratch_folder()); }));
}
