#include "formats/read_scene.h"

#include <array>
#include <string>

#include <fmt/format.h>

#include "base/error.h"
#include "formats/builtin_scenes.h"
#include "formats/read_gltf.h"
#include "formats/read_obj.h"
#include "formats/read_ply.h"
#include "scene/validate.h"

namespace pertev {
namespace {

struct Reader {
    const char* extension;
    Scene (*read)(const std::filesystem::path&, const FileAccess&, const ReadOptions&, Messages&);
};

const std::array kReaders = {
    Reader{".obj", read_obj},
    Reader{".ply", read_ply},
    Reader{".gltf", read_gltf},
    Reader{".glb", read_gltf},
};

const Reader& reader_for(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    std::string known;
    for (const Reader& reader : kReaders) {
        if (extension == reader.extension) return reader;
        known += std::string(known.empty() ? "" : " ") + reader.extension;
    }
    throw Error(ErrorCode::BadInput,
                fmt::format("{}: the kind of scene is told by the file's extension, one of {}", path.string(), known));
}

} // namespace

Scene read_scene(const std::filesystem::path& path, const ReadOptions& options, Messages& messages) {
    const Reader& reader = reader_for(path);
    const FileAccess access(path, options.allowed_paths);
    Scene scene = reader.read(path, access, options, messages);
    validate(scene, path.string(), messages);
    return scene;
}

Scene read_builtin_scene(const std::string& name, Messages& messages) {
    const auto bytes = builtin_scene(name);
    if (!bytes) {
        std::string known;
        for (const std::string_view other : builtin_scene_names()) known += " " + std::string(other);
        throw Error(ErrorCode::BadInput, fmt::format("{}: no built-in scene has this name; there are:{}", name, known));
    }
    Scene scene = read_gltf(name, {bytes->begin(), bytes->end()}, FileAccess(name, {}), {}, messages);
    validate(scene, name, messages);
    return scene;
}

} // namespace pertev
