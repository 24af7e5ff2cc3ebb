#pragma once

// The files, besides the scene's own, on whose bytes a picture depends, by names that say nothing of the machine.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "settings/picture_options.h"

namespace pertev {

struct FileOfPicture {
    std::string name; // in UTF-8; unique among those of a picture after give_own_names()
    std::string hash; // 16 hexadecimal digits
    bool is_lut = false;

    bool operator==(const FileOfPicture&) const = default;
};

/// Describes the files that are read with the scene: `found` (Scene::files), whose names are relative to the folder of
/// `options.scene.scene`, and those of the settings `environment`, `ies` and `camera_path`. A file outside that folder,
/// or of a setting, has the name without a path. Files that cannot be read are left out, because their readers have
/// reported them. Of more than 1024 found files, one entry has the hash of all that follow.
std::vector<FileOfPicture> files_of_scene(const PictureOptions& options, std::span<const std::filesystem::path> found);

/// Describes the files of the settings `displacement`, `lut` and `camera_from`, which each picture reads again.
std::vector<FileOfPicture> files_of_settings(const PictureOptions& options);

/// Numbers equal names in their order: "a.png", "a.png (2)".
void give_own_names(std::vector<FileOfPicture>& files);

} // namespace pertev
