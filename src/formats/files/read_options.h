#pragma once

// What readers are told beside the file's name.

#include <filesystem>
#include <string>
#include <vector>

#include "formats/files/file_space.h"

namespace pertev {

struct ReadOptions {
    std::vector<std::filesystem::path> allowed_paths; // `allow_path`
    bool geometry_only = false;                       // skip textures and materials: every surface grey
    bool two_sided_lights = false;                    // surfaces emit from both faces, whatever the file says
    FileSpace space;                                  // of files that do not tell theirs; others are as they say
    std::string animation;                            // plays: a name, a number from 0, or "all"; empty: the first
    std::string file_scene; // is shown: a name or a number from 0 of the file's scenes; empty: the file's own choice
};

} // namespace pertev
