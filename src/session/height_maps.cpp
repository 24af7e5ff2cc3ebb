#include "session/height_maps.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/read_file.h"
#include "formats/files/parse_number.h"
#include "image/decode_image.h"
#include "scene/names.h"

namespace pertev {
namespace {

constexpr float kMaxScale = 0x1p20f; // limit of |scale| of heights

[[noreturn]] void refuse(const HeightMapText& map, const std::string& why) {
    throw Error(ErrorCode::BadInput, "displacement", map.text, why);
}

std::optional<float> number_of(std::string_view text) {
    const std::optional<float> value = parse_whole_float(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Parses and removes the number after the last comma; nothing if that is no number.
std::optional<float> take_last_number(std::string_view& text) {
    const std::size_t comma = text.rfind(',');
    if (comma == std::string_view::npos) return std::nullopt;
    const std::optional<float> value = number_of(text.substr(comma + 1));
    if (value) text = text.substr(0, comma);
    return value;
}

Image first_channel(const std::variant<Rgba8Image, Image>& decoded) {
    Image heights;
    heights.channels = 1;
    if (const auto* bytes = std::get_if<Rgba8Image>(&decoded)) {
        heights.width = bytes->width, heights.height = bytes->height;
        for (std::size_t i = 0; i < bytes->pixels.size(); i += 4) {
            heights.pixels.push_back(static_cast<float>(bytes->pixels[i]) / 255);
        }
        return heights;
    }
    const auto& image = std::get<Image>(decoded);
    heights.width = image.width, heights.height = image.height;
    for (std::size_t i = 0; i < image.pixels.size(); i += image.channels) heights.pixels.push_back(image.pixels[i]);
    return heights;
}

Image read_heights(const HeightMapText& map, Sink& sink) {
    Image heights = first_channel(decode_image(read_file(map.file), map.file, sink));
    const auto is_bad = [](float h) { return !(std::abs(h) <= kMaxScale); };
    if (std::ranges::any_of(heights.pixels, is_bad)) {
        refuse(map, fmt::format("a height is not finite, or beyond {}", kMaxScale));
    }
    return heights;
}

void check_coordinates(const HeightMapText& map, const Scene& scene, uint32_t material) {
    for (const Instance& instance : scene.instances) {
        if (instance.material != material || !scene.meshes[instance.mesh].uv[0].empty()) continue;
        refuse(map, fmt::format("'{}' is on a mesh without texture coordinates, which height maps need",
                                scene.materials[material].name));
    }
}

} // namespace

HeightMapText parse_height_map(std::string_view text) {
    HeightMapText map;
    map.text = text;
    const auto fail = [&] { refuse(map, "expected MATERIAL=FILE,SCALE or MATERIAL=FILE,SCALE,MIDDLE"); };
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos || equals == 0) fail();
    map.material = text.substr(0, equals);
    std::string_view rest = text.substr(equals + 1);
    const std::optional<float> last = take_last_number(rest);
    if (!last) fail();
    const std::optional<float> before = take_last_number(rest);
    map.scale = before.value_or(*last);
    if (before) map.middle = *last;
    map.file = rest;
    if (map.file.empty()) fail();
    if (!(std::abs(map.scale) <= kMaxScale && std::abs(map.middle) <= kMaxScale)) {
        refuse(map, fmt::format("SCALE and MIDDLE must be between {} and {}", -kMaxScale, kMaxScale));
    }
    return map;
}

std::shared_ptr<const HeightMaps> read_height_maps(std::span<const HeightMapText> texts, const Scene& scene,
                                                   Sink& sink) {
    std::map<uint32_t, HeightMap> of_material;
    for (const HeightMapText& map : texts) {
        std::vector<Names> all;
        std::optional<Image> heights;
        for (uint32_t i = 0; i < scene.materials.size(); ++i) {
            all.push_back({scene.materials[i].name});
            if (!matches_name(map.material, scene.materials[i].name)) continue;
            if (!heights)
                heights = read_heights(map, sink); // before the material is checked, so that a missing
                                                   // file is always reported
            check_coordinates(map, scene, i);
            of_material[i] = {i, *heights, map.scale, map.middle, map.text};
        }
        if (!heights) refuse(map, "there is no material of the scene with this name; " + some_names(all));
    }
    if (of_material.empty()) return nullptr;
    HeightMaps maps;
    for (auto& [material, map] : of_material) maps.push_back(std::move(map));
    return std::make_shared<const HeightMaps>(std::move(maps));
}

} // namespace pertev
