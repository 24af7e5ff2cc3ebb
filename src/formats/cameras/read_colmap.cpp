#include "formats/cameras/read_colmap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>

#include "base/read_file.h"
#include "formats/cameras/camera_numbers.h"
#include "formats/files/parse_number.h"

namespace pertev {
namespace {

namespace fs = std::filesystem;

/// A model: COLMAP's number, its parameters in its order, and the lens. f is both focal lengths.
struct Model {
    const char* name;
    std::vector<const char*> parameters;
    const char* lens; // null: straight
};
const Model kModels[] = {
    {"SIMPLE_PINHOLE", {"f", "cx", "cy"}, nullptr},
    {"PINHOLE", {"fx", "fy", "cx", "cy"}, nullptr},
    {"SIMPLE_RADIAL", {"f", "cx", "cy", "k1"}, "opencv"},
    {"RADIAL", {"f", "cx", "cy", "k1", "k2"}, "opencv"},
    {"OPENCV", {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"}, "opencv"},
    {"OPENCV_FISHEYE", {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"}, "fisheye"},
    {"FULL_OPENCV", {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}, "opencv"},
    {"FOV", {}, nullptr},
    {"SIMPLE_RADIAL_FISHEYE", {"f", "cx", "cy", "k1"}, "fisheye"},
    {"RADIAL_FISHEYE", {"f", "cx", "cy", "k1", "k2"}, "fisheye"},
};

struct Calibration {
    const Model* model;
    uint64_t width, height;
    std::vector<double> parameters;
};
using Calibrations = std::map<uint64_t, Calibration>;

Error fault(const FileLocation& where, std::string why) { return {ErrorCode::BadInput, Remark(where, std::move(why))}; }

/// States size, intrinsics and lens of a calibration.
void state_calibration(const Calibration& from, CameraOfFile& camera) {
    const auto number = [&](const char* name) {
        for (std::size_t i = 0; i < from.parameters.size(); ++i) {
            if (std::string_view(from.model->parameters[i]) == name) return from.parameters[i];
        }
        return 0.0;
    };
    const double f = number("f");
    const double intrinsics[] = {f != 0 ? f : number("fx"), f != 0 ? f : number("fy"), number("cx"), number("cy")};
    state(camera, "intrinsics", intrinsics);
    state_size(camera, from.width, from.height);
    if (from.model->lens == nullptr) return;
    state(camera, "lens", std::string(from.model->lens));
    const bool is_fisheye = std::string_view(from.model->lens) == "fisheye";
    std::vector<double> k = {number("k1"), number("k2"), number("p1"), number("p2")};
    if (is_fisheye) k = {number("k1"), number("k2"), number("k3"), number("k4")};
    if (from.parameters.size() == 12) k.insert(k.end(), {number("k3"), number("k4"), number("k5"), number("k6")});
    state(camera, "distortion", k);
}

/// The camera of an image: a rotation w, x, y, z and a translation from world to camera.
CameraOfFile camera_of(const std::array<double, 7>& pose, const std::string& picture, uint64_t id,
                       const Calibrations& calibrations, const FileLocation& where) {
    const double length = std::sqrt(pose[0] * pose[0] + pose[1] * pose[1] + pose[2] * pose[2] + pose[3] * pose[3]);
    if (!(length > 0)) throw fault(where, "the rotation is 0; expected a unit quaternion");
    const double w = pose[0] / length, x = pose[1] / length, y = pose[2] / length, z = pose[3] / length;
    const double to_camera[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                                    {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                                    {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    std::array<double, 12> matrix; // its inverse
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 3; ++column) matrix[4 * row + column] = to_camera[column][row];
        matrix[4 * row + 3] =
            -(to_camera[0][row] * pose[4] + to_camera[1][row] * pose[5] + to_camera[2][row] * pose[6]);
    }
    const auto calibration = calibrations.find(id);
    if (calibration == calibrations.end()) throw fault(where, fmt::format("there is no camera {}", id));
    CameraOfFile camera = {name_of_picture(picture), where, {}};
    state(camera, "camera_pose", matrix);
    state(camera, "convention", std::string("opencv"));
    state_calibration(calibration->second, camera);
    return camera;
}

const Model& checked(const Model& model, const FileLocation& where) {
    if (model.parameters.empty())
        throw fault(where,
                    fmt::format("the camera model {} is not supported; undistort the images with COLMAP", model.name));
    return model;
}

/// Lines that are no comments, with their numbers; `text` outlives it.
class Lines {
public:
    Lines(std::string file, std::string_view text) : file_(std::move(file)), rest_(text) {}

    /// Reads the next line into `line`, also an empty one.
    bool next(std::string_view& line) {
        while (!rest_.empty()) {
            const std::size_t end = std::min(rest_.find('\n'), rest_.size());
            line = rest_.substr(0, end);
            rest_.remove_prefix(std::min(end + 1, rest_.size()));
            ++number_;
            if (line.ends_with('\r')) line.remove_suffix(1);
            if (!line.starts_with('#')) return true;
        }
        return false;
    }
    FileLocation where() const { return {.file = file_, .line = number_}; }
    std::string_view word(std::string_view& line, const char* what) const {
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
        const std::string_view word = line.substr(0, end);
        if (word.empty()) throw fault(where(), fmt::format("expected {}", what));
        line.remove_prefix(end);
        return word;
    }
    double number(std::string_view& line, const char* what) const {
        const auto value = parse_whole_float<double>(word(line, what));
        if (!value || !std::isfinite(*value)) throw fault(where(), fmt::format("expected {}, a number", what));
        return *value;
    }
    uint64_t whole(std::string_view& line, const char* what) const {
        const auto value = parse_whole_number(word(line, what));
        if (!value) throw fault(where(), fmt::format("expected {}, a whole number", what));
        return *value;
    }

private:
    std::string file_;
    std::string_view rest_;
    uint32_t number_ = 0;
};

bool is_blank(std::string_view line) { return line.find_first_not_of(" \t") == std::string_view::npos; }

std::string text_of(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Calibrations read_text_cameras(const fs::path& path) {
    const std::string text = text_of(read_file(path));
    Lines lines(path.string(), text);
    Calibrations all;
    for (std::string_view line; lines.next(line);) {
        if (is_blank(line)) continue;
        const uint64_t id = lines.whole(line, "a camera's number");
        const std::string_view name = lines.word(line, "a camera model");
        const Model* const model =
            std::ranges::find(kModels, name, [](const Model& m) { return std::string_view(m.name); });
        if (model == std::end(kModels)) throw fault(lines.where(), fmt::format("unknown camera model {}", name));
        Calibration read = {&checked(*model, lines.where()), 0, 0, {}};
        read.width = lines.whole(line, "a width");
        read.height = lines.whole(line, "a height");
        for (const char* parameter : model->parameters) read.parameters.push_back(lines.number(line, parameter));
        if (!is_blank(line))
            throw fault(lines.where(), fmt::format("{} has {} parameters", name, model->parameters.size()));
        all.insert_or_assign(id, read);
    }
    return all;
}

std::vector<CameraOfFile> read_text_images(const fs::path& path, const Calibrations& calibrations) {
    const std::string text = text_of(read_file(path));
    Lines lines(path.string(), text);
    std::vector<CameraOfFile> all;
    for (std::string_view line; lines.next(line);) {
        if (is_blank(line)) continue;
        lines.whole(line, "an image's number");
        std::array<double, 7> pose;
        for (double& number : pose) number = lines.number(line, "a rotation and a translation");
        const uint64_t id = lines.whole(line, "a camera's number");
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size())); // names may have spaces
        if (line.empty()) throw fault(lines.where(), "expected the name of a picture");
        all.push_back(camera_of(pose, std::string(line), id, calibrations, lines.where()));
        std::string_view points;
        lines.next(points); // its points have a line of their own, which may be empty
    }
    return all;
}

/// Reads values from a binary file.
class Bytes {
public:
    explicit Bytes(const fs::path& path) : where_{.file = path.string()}, bytes_(read_file(path)) {}

    template <class Value>
    Value take() {
        Value value;
        std::memcpy(&value, skip(sizeof value), sizeof value);
        return value;
    }
    /// Skips bytes and returns where they are.
    const std::byte* skip(uint64_t count) {
        if (count > bytes_.size() - at_) throw fault(where_, "the file ends too early");
        const std::byte* const first = bytes_.data() + at_;
        at_ += count;
        return first;
    }
    std::string name() {
        std::string text;
        while (const char c = take<char>()) text += c;
        return text;
    }
    const FileLocation& where() const { return where_; }

private:
    FileLocation where_;
    std::vector<std::byte> bytes_;
    std::size_t at_ = 0;
};

Calibrations read_binary_cameras(const fs::path& path) {
    Bytes bytes(path);
    Calibrations all;
    for (auto count = bytes.take<uint64_t>(); count > 0; --count) {
        const auto id = bytes.take<uint32_t>();
        const auto number = bytes.take<uint32_t>();
        if (number >= std::size(kModels)) throw fault(bytes.where(), fmt::format("unknown camera model {}", number));
        Calibration read = {&checked(kModels[number], bytes.where()), 0, 0, {}};
        read.width = bytes.take<uint64_t>();
        read.height = bytes.take<uint64_t>();
        for (std::size_t i = 0; i < read.model->parameters.size(); ++i) read.parameters.push_back(bytes.take<double>());
        all.insert_or_assign(id, read);
    }
    return all;
}

std::vector<CameraOfFile> read_binary_images(const fs::path& path, const Calibrations& calibrations) {
    Bytes bytes(path);
    std::vector<CameraOfFile> all;
    for (auto count = bytes.take<uint64_t>(); count > 0; --count) {
        bytes.take<uint32_t>();
        std::array<double, 7> pose;
        for (double& number : pose) number = bytes.take<double>();
        const auto id = bytes.take<uint32_t>();
        const std::string name = bytes.name();
        all.push_back(camera_of(pose, name, id, calibrations, bytes.where()));
        const auto points = bytes.take<uint64_t>();
        constexpr uint64_t kPointBytes = 24;
        bytes.skip(points > UINT64_MAX / kPointBytes ? UINT64_MAX : points * kPointBytes);
    }
    return all;
}

/// Returns the folder with the files of cameras, which is `path` or that of its first model.
fs::path folder_of_model(const fs::path& path) {
    for (const fs::path& folder : {path, path / "sparse" / "0"}) {
        std::error_code ignored;
        if (fs::exists(folder / "images.txt", ignored) || fs::exists(folder / "images.bin", ignored)) return folder;
    }
    throw fault({.file = path.string()}, "neither the folder nor its sparse/0 has an images.txt or images.bin");
}

} // namespace

bool is_colmap(const fs::path& path) {
    const std::string name = path.filename().string();
    std::error_code ignored;
    return fs::is_directory(path, ignored) || name == "images.txt" || name == "cameras.txt" || name == "images.bin" ||
           name == "cameras.bin";
}

std::vector<CameraOfFile> read_colmap(const fs::path& path) {
    std::error_code ignored;
    const bool is_folder = fs::is_directory(path, ignored);
    const fs::path folder = is_folder ? folder_of_model(path) : path.parent_path();
    const bool is_text = path.extension() == ".txt" || (is_folder && fs::exists(folder / "images.txt", ignored));
    std::vector<CameraOfFile> cameras =
        is_text ? read_text_images(folder / "images.txt", read_text_cameras(folder / "cameras.txt"))
                : read_binary_images(folder / "images.bin", read_binary_cameras(folder / "cameras.bin"));
    std::ranges::sort(cameras, {}, &CameraOfFile::name); // COLMAP's order is that of its search
    return cameras;
}

} // namespace pertev
