#include "formats/read_scene.h"

#include <array>
#include <string>

#include <fmt/format.h>

#include "base/error.h"
#include "formats/read_obj.h"
#include "formats/read_ply.h"
#include "scene/validate.h"

namespace pertev {
namespace {

struct Reader {
    const char* extension;
    Scene (*read)(const std::filesystem::path&, const FileAccess&, const ReadOptions&, Messages&);
};

constexpr std::array kReaders = {
    Reader{".obj", read_obj},
    Reader{".ply", read_ply},
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

} // namespace pertev
