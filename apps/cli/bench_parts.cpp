#include "apps/cli/bench_parts.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "base/error.h"
#include "formats/builtin_scenes.h"
#include "formats/read_scene.h"
#include "lab/record_scenes.h"

namespace pertev {

void check_bench_scene(const std::string& name, std::string_view others) {
    if (!is_scene_name(name)) {
        throw Error(ErrorCode::BadInput, fmt::format("--scene {}: neither {}{}", name, others, scene_kinds()));
    }
    std::error_code no_such_name; // of a name too long for a file, too
    if (!builtin_scene(name) && !std::filesystem::exists(name, no_such_name)) {
        throw Error(ErrorCode::BadInput, fmt::format("--scene {}: no such file", name));
    }
}

void check_record_scene(const std::string& name) {
    const RecordScene* const record = find_record_scene(name);
    if (record == nullptr) return check_bench_scene(name, "sponza, bunny or forest nor ");
    if (record->file != nullptr) record_file(*record, public_scenes_folder());
}

void refuse_flags_before(const CLI::App& verb) {
    for (const CLI::Option* flag : verb.get_parent()->get_options()) {
        if (flag->count() == 0) continue;
        throw Error(ErrorCode::BadInput, fmt::format("{}: stands before {}; flags of `bench {}` stand behind that name",
                                                     flag->get_name(), verb.get_name(), verb.get_name()));
    }
}

} // namespace pertev
