#pragma once

// Converts Wavefront .mtl files (parse_mtl.h) to our materials. MTL describes how a Phong shader of 1990 blends
// colours. The rules are tried in this order:
//   PBR keys (Pr, Pm, map_Pr, map_Pm)           MetallicRoughness with them
//   illum 6 or 7; illum 4 or 9 with Kd near black; d < 1 with Ni > 1 and Tf
//                                               smooth Dielectric of index Ni or 1.5, tinted by sqrt(Tf) at each
//                                               surface
//   Ks above 0.1 with Kd near black, or illum 3, 5 or 8 with Ks above Kd
//                                               metal of colour Ks; a mirror for illum 3, 5, 8, else rough by Ns
//   Ks above 0.02 and not (0.5, 0.5, 0.5), which exporters write by default, Ns above 1 and illum not 1
//                                               MetallicRoughness, metallic 0, Ni such that F0 = Ks / max(1, Kd + Ks)
//   otherwise                                   Diffuse of Kd; without Kd, grey as without a material
// Pc, Pcr and Ps put a coat and a sheen on any of them; aniso, turned by anisor, stretches reflections. Ns to GGX:
// alpha = sqrt(2 / (Ns + 2)) (Walter et al., EGSR 2007, section 5.2). d < 1 alone, and map_d, are alpha.

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/sink.h"
#include "formats/files/load_textures.h"
#include "scene/scene.h"

namespace pertev {

/// A material with properties that depend on its decoded images.
struct MtlMaterial {
    Material material;
    bool has_alpha_map = false;        // map_d is in alpha_texture, or is the alpha of map_Kd if it is the same image
    char alpha_channel = 'm';          // -imfchan of map_d
    bool normal_may_be_height = false; // from map_bump, which some exporters use for normal maps
    float bump_multiplier = 1;         // -bm of map_bump, for heights
    char bump_channel = 'm';           // -imfchan of map_bump
};

/// Materials of the file at `path` by name, the first of equal names; `loader` gets their textures. Throws
/// Error(BadInput) if the file cannot be read or, with the line, if a number is invalid.
std::map<std::string, MtlMaterial> read_mtl(const std::filesystem::path& path, TextureLoader& loader, Sink& sink);
/// Reads materials from memory; `path` starts every message.
std::map<std::string, MtlMaterial> read_mtl(std::span<const std::byte> bytes, const std::filesystem::path& path,
                                            TextureLoader& loader, Sink& sink);

/// Finishes `material.material` after its images have been decoded (and its textures renumbered by the loader): reads
/// the alpha mode and channel off the images.
void finish_mtl_material(MtlMaterial& material, const std::vector<TextureImage>& images);

} // namespace pertev
