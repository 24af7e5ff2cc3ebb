#include "apps/cli/lab_scene.h"

#include <filesystem>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "apps/cli/bench_parts.h"
#include "base/error.h"
#include "base/json_text.h"
#include "formats/builtin_scenes.h"
#include "lab/record_scenes.h"

namespace pertev {

Scene read_lab_scene(const SceneOptions& options, Messages& messages) {
    const std::string& name = options.scene;
    if (const RecordScene* record = find_named(the_record().scenes, name)) {
        if (!options.file_scene.empty()) {
            throw Error(ErrorCode::BadInput,
                        fmt::format("--file-scene: {} has no scenes of its own to choose from", name));
        }
        return make_record_scene(*record, public_scenes_folder(), messages);
    }
    std::error_code no_such_name; // a name may be too long for a file
    if (!builtin_scene(name) && !std::filesystem::exists(name, no_such_name)) {
        std::vector<std::string_view> known = builtin_scene_names();
        for (const RecordScene& record : the_record().scenes) known.emplace_back(record.name);
        throw Error(ErrorCode::BadInput, fmt::format("{}: neither a file nor a scene of this name; there are {}", name,
                                                     fmt::join(known, ", ")));
    }
    return read_any_scene(options, messages);
}

std::string lab_scene_title(const std::string& scene) {
    return utf8_text(std::filesystem::path(scene).stem().string());
}

} // namespace pertev
