#include "session/writing/files_of_picture.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/json_text.h"
#include "base/read_file.h"
#include "session/height_maps.h"
#include "session/opening/set_profiles.h"

namespace fs = std::filesystem;

namespace pertev {
namespace {

constexpr std::size_t kMostNamedFiles = 1024; // about 60 KB of a header
constexpr std::size_t kHashDigits = 16;       // an accident of 2^-64 is no other file

void add_file(const fs::path& path, const fs::path& name, std::vector<FileOfPicture>& files) {
    std::string hash;
    try {
        hash = hash_of_file(path).substr(0, kHashDigits);
    } catch (const Error&) { // it counts as missing
    }
    if (!hash.empty()) files.push_back({utf8_text(name.generic_string()), hash});
}

void add_file_of_setting(const fs::path& path, std::vector<FileOfPicture>& files) {
    add_file(path, path.filename(), files);
}

/// Returns the path of `file` relative to `folder`, or its last component if it is not below that.
fs::path name_below(const fs::path& folder, const fs::path& file) {
    const fs::path below = file.lexically_relative(folder);
    return below.empty() || *below.begin() == ".." ? file.filename() : below;
}

/// Replaces all files from the last that may have a name on by one entry.
void unite_last(std::vector<FileOfPicture>& files) {
    if (files.size() <= kMostNamedFiles) return;
    const auto rest = std::span(files).subspan(kMostNamedFiles);
    Hasher hasher;
    for (const FileOfPicture& file : rest) {
        const std::string text = file.name + '\n' + file.hash + '\n';
        hasher.add(std::as_bytes(std::span(text)));
    }
    FileOfPicture all = {fmt::format("one of {} more files", rest.size()),
                         hasher.result().hex().substr(0, kHashDigits)};
    files.resize(kMostNamedFiles);
    files.push_back(std::move(all));
}

} // namespace

std::vector<FileOfPicture> files_of_scene(const PictureOptions& options, std::span<const fs::path> found) {
    std::vector<FileOfPicture> files;
    std::error_code ec;
    const fs::path parent = fs::path(options.scene.scene).parent_path();
    const fs::path folder = fs::canonical(parent.empty() ? fs::path(".") : parent, ec);
    for (const fs::path& file : found) add_file(file, name_below(folder, file), files);
    unite_last(files);
    add_file_of_setting(options.scene.environment, files); // a colour is no file
    for (const std::string& text : options.scene.profiles) add_file_of_setting(file_of_profile(text), files);
    add_file_of_setting(options.camera_path, files);
    return files;
}

std::vector<FileOfPicture> files_of_settings(const PictureOptions& options) {
    std::vector<FileOfPicture> files;
    for (const std::string& text : options.displacement) add_file_of_setting(parse_height_map(text).file, files);
    add_file_of_setting(options.scene.camera.camera_from, files);
    const std::size_t others = files.size();
    add_file_of_setting(options.lut, files);
    if (files.size() > others) files.back().is_lut = true;
    return files;
}

void give_own_names(std::vector<FileOfPicture>& files) {
    std::set<std::string> known;
    for (FileOfPicture& file : files) {
        std::string name = file.name;
        for (int number = 2; !known.insert(name).second; ++number) name = fmt::format("{} ({})", file.name, number);
        file.name = std::move(name);
    }
}

} // namespace pertev
