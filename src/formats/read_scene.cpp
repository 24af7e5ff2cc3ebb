#include "formats/read_scene.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file_extension.h"
#include "formats/builtin_scenes.h"
#include "formats/files/file_choices.h"
#include "formats/gltf/read_gltf.h"
#include "formats/mitsuba/read_mitsuba.h"
#include "formats/obj/read_obj.h"
#include "formats/pbrt/read_pbrt.h"
#include "formats/ply/read_ply.h"
#include "formats/stl/read_stl.h"
#include "scene/invisible_materials.h"
#include "scene/validate/validate.h"

namespace pertev {
namespace {

struct FormatReader {
    std::string_view extension;
    Scene (*read)(const std::filesystem::path&, const FileAccess&, const ReadOptions&, Sink&);
    bool defines_sides; // its files can say whether a surface emits from both faces
    bool defines_space; // their coordinates are metres, y up
};

const std::array kReaders = {
    FormatReader{".obj", read_obj, false, false},    FormatReader{".ply", read_ply, false, false},
    FormatReader{".stl", read_stl, false, false},    FormatReader{".gltf", read_gltf, true, true},
    FormatReader{".glb", read_gltf, true, true},     FormatReader{".pbrt", read_pbrt, true, true},
    FormatReader{".pbrt.gz", read_pbrt, true, true}, FormatReader{".xml", read_mitsuba, true, true},
    FormatReader{".ply.gz", read_ply, false, false},
};

/// Returns the reader for a file's extension, in front of .gz if it is gzip'd; null if there is none.
const FormatReader* find_reader(const std::filesystem::path& path) {
    std::string extension = lower_case_extension(path);
    if (extension == ".gz") extension = lower_case_extension(path.stem()) + extension;
    const auto found = std::ranges::find(kReaders, extension, &FormatReader::extension);
    return found == kReaders.end() ? nullptr : &*found;
}

Scene read_file_or_builtin(const std::filesystem::path& path, const FileAccess& access, const ReadOptions& options,
                           Sink& sink) {
    if (const auto bytes = builtin_scene(path.string())) {
        if (const auto materials = builtin_materials(path.string())) {
            return read_obj(path, ObjTexts{*bytes, *materials}, access, options, sink);
        }
        return read_gltf(path, {bytes->begin(), bytes->end()}, access, options, sink);
    }
    if (const FormatReader* reader = find_reader(path)) return reader->read(path, access, options, sink);
    throw Error(ErrorCode::BadInput, FileLocation{path.string()}, fmt::format("neither {}", scene_kinds()));
}

} // namespace

Scene read_scene(const std::filesystem::path& path, const ReadOptions& options, Sink& sink) {
    const FileAccess access(path, options.allowed_paths);
    Scene scene = read_file_or_builtin(path, access, options, sink);
    scene.files = access.found();
    // Formats that have neither, and files that have none.
    if (scene.clips.empty() && !options.animation.empty()) choose_clips(path.string(), {}, options.animation);
    if (scene.file_scenes.empty() && !options.file_scene.empty()) {
        choose_file_scene(path.string(), {}, options.file_scene);
    }
    if (scene.variants.empty() && !options.variant.empty()) choose_material_variant(path.string(), {}, options.variant);
    const FormatReader* const reader = find_reader(path);
    if (!options.defines.empty() && (reader == nullptr || reader->extension != ".xml"))
        sink.warn(Remark("define", options.defines.front(), "only Mitsuba's files have values to be defined"));
    if (!defines_space(path)) convert_to_metres(options.space, scene);
    validate(scene, path.string(), sink);
    warn_of_invisible_materials(scene, path.string(), sink);
    if (options.two_sided_lights) {
        for (Material& material : scene.materials) material.two_sided_emission = true;
    }
    return scene;
}

bool defines_emitter_sides(const std::filesystem::path& path) {
    const FormatReader* reader = find_reader(path);
    return reader == nullptr || reader->defines_sides;
}

bool defines_space(const std::filesystem::path& path) {
    if (builtin_scene(path.string())) return true;
    const FormatReader* reader = find_reader(path);
    return reader == nullptr || reader->defines_space;
}

bool is_scene_name(const std::filesystem::path& path) {
    return builtin_scene(path.string()).has_value() || find_reader(path) != nullptr;
}

std::string scene_kinds() {
    std::vector<std::string_view> extensions;
    for (const FormatReader& reader : kReaders) extensions.emplace_back(reader.extension);
    return fmt::format("a scene file ({}) nor a built-in scene ({})", fmt::join(extensions, " "),
                       fmt::join(builtin_scene_names(), " "));
}

} // namespace pertev
