#pragma once

// Choice among a file's animations, its scenes, and its variants of materials. A choice is a name or, if nothing has
// that name, an index from 0 in the order of the file; for animations also "all". A name that two items have selects
// neither, so that no choice depends on their order; they are chosen by index.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace pertev {

/// Returns for each animation of `file` whether it plays; an empty `choice` selects the first. Throws Error(BadInput)
/// with a list of all for a choice that matches none or several.
std::vector<bool> choose_clips(const std::string& file, std::span<const std::string> names, const std::string& choice);

/// The index of the scene to show. Throws as choose_clips.
uint32_t choose_file_scene(const std::string& file, std::span<const std::string> names, const std::string& choice);

/// The index of the variant of materials to show. Throws as choose_clips.
uint32_t choose_material_variant(const std::string& file, std::span<const std::string> names,
                                 const std::string& choice);

/// The choice that makes exactly these clips play; empty if there are none, or only one and it plays.
std::string clip_choice(std::span<const Clip> clips);
/// The choice that selects this scene of its file; empty if the file has no other.
std::string file_scene_choice(const Scene& scene);
/// The choice that selects this variant of materials; empty if the default one is shown.
std::string material_variant_choice(const Scene& scene);

/// Lists a file's animations, or scenes, each by a choice that selects it and by its name: "Walk", "1 (Walk)" if
/// another has that name, "2" without a name.
std::vector<std::string> list_clips(std::span<const Clip> clips);
std::vector<std::string> list_file_scenes(const Scene& scene);
std::vector<std::string> list_material_variants(const Scene& scene);

} // namespace pertev
