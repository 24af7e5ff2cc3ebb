#include "formats/cameras/read_cameras.h"

#include <algorithm>
#include <array>
#include <set>

#include "base/limits.h"
#include "formats/cameras/camera_numbers.h"
#include "formats/cameras/read_colmap.h"
#include "formats/json/json_file.h"
#include "math/portable_math.h"

namespace pertev {
namespace {

using gltf::JsonValue;

/// A frame of transforms.json, whose members overrule those of the document.
class Frame {
public:
    Frame(const JsonValue& root, const JsonValue& frame) : root_(root), frame_(frame) {}

    std::optional<JsonValue> find(const char* key) const {
        const auto own = frame_.find(key);
        return own ? own : root_.find(key);
    }
    std::optional<double> number(const char* key) const {
        const auto value = find(key);
        return value ? std::optional(value->to_double()) : std::nullopt;
    }
    double number_or(const char* key, double otherwise) const { return number(key).value_or(otherwise); }

    /// Returns a side of the picture, or `given` if the file does not state it; 0: none.
    uint32_t side(const char* key, uint32_t given) const {
        const auto value = find(key);
        if (!value) return given;
        const uint64_t side = value->to_unsigned();
        if (side == 0 || side > kMaxImageSide) throw value->error(fmt::format("{}; expected pixels", side));
        return static_cast<uint32_t>(side);
    }

private:
    const JsonValue &root_, &frame_;
};

/// States focal lengths, principal point and size.
void state_view(const Frame& from, const JsonValue& frame, uint32_t width, uint32_t height, CameraOfFile& camera) {
    const uint32_t w = from.side("w", width), h = from.side("h", height);
    if (w == 0 || h == 0) throw frame.error("the picture's size (\"w\" and \"h\") is missing; set `size`");
    const auto focal = [&](const char* key, const char* angle_key, uint32_t side) -> std::optional<double> {
        if (const auto own = from.number(key)) return own;
        const auto angle = from.number(angle_key);
        return angle ? std::optional(0.5 * side / static_cast<double>(tan(static_cast<float>(0.5 * *angle))))
                     : std::nullopt;
    };
    std::optional<double> x = focal("fl_x", "camera_angle_x", w), y = focal("fl_y", "camera_angle_y", h);
    if (!x && !y) throw frame.error("both \"fl_x\" and \"camera_angle_x\" are missing");
    if (!x) x = y;
    if (!y) y = x;
    const double intrinsics[] = {*x, *y, from.number_or("cx", 0.5 * w), from.number_or("cy", 0.5 * h)};
    state(camera, "intrinsics", intrinsics);
    state_size(camera, w, h);
}

void state_lens(const Frame& from, const JsonValue& frame, CameraOfFile& camera) {
    const auto model_of = from.find("camera_model");
    const std::string model = model_of ? std::string(model_of->to_string()) : "OPENCV";
    const auto flag = from.find("is_fisheye");
    const bool is_fisheye = model == "OPENCV_FISHEYE" || (flag && flag->to_bool());
    if (model == "PINHOLE" || model == "SIMPLE_PINHOLE") return;
    if (model != "OPENCV" && !is_fisheye) throw model_of->error(fmt::format("{} is not supported", model));
    const double k1 = from.number_or("k1", 0), k2 = from.number_or("k2", 0), k3 = from.number_or("k3", 0),
                 k4 = from.number_or("k4", 0), p1 = from.number_or("p1", 0), p2 = from.number_or("p2", 0);
    if (!is_fisheye && k4 != 0) throw frame.error("\"k4\" applies only to a fisheye (\"OPENCV_FISHEYE\")");
    if (!is_fisheye && k1 == 0 && k2 == 0 && k3 == 0 && p1 == 0 && p2 == 0) return;
    state(camera, "lens", std::string(is_fisheye ? "fisheye" : "opencv"));
    state(camera, "distortion",
          is_fisheye ? std::vector<double>{k1, k2, k3, k4} : std::vector<double>{k1, k2, p1, p2, k3});
}

std::vector<CameraOfFile> read_transforms(const JsonValue& root, uint32_t width, uint32_t height) {
    std::vector<CameraOfFile> cameras;
    for (const JsonValue& frame : root.at("frames").elements()) {
        const Frame from(root, frame);
        const auto file = frame.find("file_path");
        CameraOfFile camera = {file ? name_of_picture(std::string(file->to_string()))
                                    : fmt::format("{}", cameras.size()),
                               frame.location(),
                               {}};
        const JsonValue matrix = frame.at("transform_matrix");
        std::vector<double> numbers;
        for (const JsonValue& row : matrix.elements()) {
            for (const double number : row.to_doubles<4>()) numbers.push_back(number);
        }
        if (numbers.size() != 12 && numbers.size() != 16) throw matrix.error("expected four rows of four numbers");
        state(camera, "camera_pose", numbers);
        state_view(from, frame, width, height, camera);
        state_lens(from, frame, camera);
        cameras.push_back(std::move(camera));
    }
    return cameras;
}

std::vector<CameraOfFile> read_own(const JsonValue& root) {
    std::vector<CameraOfFile> cameras;
    for (const JsonValue& source : root.at("cameras").elements()) {
        CameraOfFile camera = {source.string_or("name", fmt::format("{}", cameras.size())), source.location(), {}};
        for (const auto& [name, value] : source.members()) {
            if (name != "name") state(camera, name.c_str(), setting_text(value));
        }
        for (const auto& [name, value] : root.members()) {
            if (name != "cameras" && !source.find(name)) state(camera, name.c_str(), setting_text(value));
        }
        cameras.push_back(std::move(camera));
    }
    return cameras;
}

void check_names(const std::vector<CameraOfFile>& cameras) {
    std::set<std::string> names;
    for (const CameraOfFile& camera : cameras) {
        const bool is_word = !camera.name.empty() && camera.name.find_first_of("/\\") == std::string::npos;
        if (is_word && names.insert(camera.name).second) continue;
        throw Error(ErrorCode::BadInput,
                    Remark(camera.location, fmt::format("the name \"{}\" {}", camera.name,
                                                        is_word ? "is also the name of another camera"
                                                                : "cannot be the name of a file")));
    }
}

} // namespace

std::string name_of_picture(const std::string& file) {
    std::string name = std::filesystem::path(file).lexically_normal().replace_extension().string();
    while (name.starts_with("../")) name.erase(0, 3);
    std::ranges::replace(name, '/', '_');
    std::ranges::replace(name, '\\', '_');
    return name;
}

std::vector<CameraOfFile> read_cameras(const std::filesystem::path& path, uint32_t width, uint32_t height) {
    std::vector<CameraOfFile> cameras;
    if (is_colmap(path)) {
        cameras = read_colmap(path);
    } else {
        const JsonFile file(path);
        const JsonValue& root = file.root();
        cameras = root.find("frames") ? read_transforms(root, width, height) : read_own(root);
    }
    if (cameras.empty())
        throw Error(ErrorCode::BadInput, Remark(FileLocation{path.string()}, "the file has no cameras"));
    check_names(cameras);
    return cameras;
}

} // namespace pertev
