#pragma once

// Options of readers besides the file's name.

#include <filesystem>
#include <string>
#include <vector>

#include "formats/files/file_space.h"

namespace pertev {

struct ReadOptions {
    std::vector<std::filesystem::path> allowed_paths; // setting `allow_path`
    bool geometry_only = false;                       // skips textures and materials: every surface is grey
    bool vertex_colors = false;                       // keeps them even so; such a file refers to no other
    bool two_sided_lights = false;                    // surfaces emit from both faces, whatever the file says
    FileSpace space;                                  // for formats that do not define theirs; others are unaffected
    std::string animation;                            // the animation that plays: a name, an index from 0, or "all";
                                                      // empty: the first
    uint32_t max_texture_size = 0; // pixels of the longer side of textures; larger ones are scaled down; 0: any
    std::string variant;    // the set of materials: a name or an index from 0 in the file; empty: the file's default
    std::string file_scene; // the scene to show: a name or an index from 0 in the file; empty: the file's default
    std::vector<std::string> defines; // values of a Mitsuba file's parameters: NAME=VALUE
};

} // namespace pertev
