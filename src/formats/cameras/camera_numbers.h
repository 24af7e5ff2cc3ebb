#pragma once

// States the parts of a camera of a file as settings.

#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/cameras/read_cameras.h"

namespace pertev {

inline void state(CameraOfFile& camera, const char* setting, std::span<const double> numbers) {
    camera.settings.push_back({setting, fmt::format("{}", fmt::join(numbers, ","))});
}
inline void state(CameraOfFile& camera, const char* setting, std::string text) {
    camera.settings.push_back({setting, std::move(text)});
}
inline void state_size(CameraOfFile& camera, uint64_t width, uint64_t height) {
    state(camera, "intrinsics_size", fmt::format("{}x{}", width, height));
}

/// The name of a picture's file without its ending, in one word: "left/0001.png" is "left_0001".
std::string name_of_picture(const std::string& file);

} // namespace pertev
