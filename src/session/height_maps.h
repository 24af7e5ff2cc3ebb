#pragma once

// Height maps that the user assigns to materials, as displacement for `integrator=reyes`.

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "base/sink.h"
#include "integrators/kinds/make_integrator.h"
#include "integrators/reyes/reyes_settings.h"
#include "scene/scene.h"

namespace pertev {

struct HeightMapText {
    std::string material; // * and ? are wildcards (scene/names.h)
    std::string file;
    float scale = 1, middle = 0; // copied to HeightMap
    std::string text;            // text of the request
};

/// Parses MATERIAL=FILE,SCALE or MATERIAL=FILE,SCALE,MIDDLE. Throws Error(BadInput).
HeightMapText parse_height_map(std::string_view text);

/// Reads the files: the first channel of PNG, JPEG, HDR or EXR, as stored; integers map to [0, 1]. The last map for a
/// material counts. Returns null if `texts` is empty. Throws Error(BadInput) for a material that the scene does not
/// have or whose meshes have no texture coordinates, and as decode_image does.
std::shared_ptr<const HeightMaps> read_height_maps(std::span<const HeightMapText> texts, const Scene& scene,
                                                   Sink& sink = nobody());

} // namespace pertev
