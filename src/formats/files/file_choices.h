#pragma once

// What a file has several of, and a person chooses from: the animation that plays, the scene that is shown. A choice is
// a name or, where nothing is called so, a number from 0 in the order of the file; of animations also "all". A name
// that two have stands for neither, so that no choice depends on which comes first: they are chosen by their numbers.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace pertev {

/// Of each animation of `file`, whether it plays; `choice` empty: the first does. Throws Error(BadInput) with a list of
/// all for a choice that stands for none of them, or for several.
std::vector<bool> choose_clips(const std::string& file, std::span<const std::string> names, const std::string& choice);

/// The number of the scene that is shown. Throws as choose_clips.
uint32_t choose_file_scene(const std::string& file, std::span<const std::string> names, const std::string& choice);

/// The choice that makes these clips play; empty where there are none, or one that plays.
std::string clip_choice(std::span<const Clip> clips);
/// The choice that shows this scene of its file; empty where the file has no other.
std::string file_scene_choice(const Scene& scene);

/// Each of a file's animations, or scenes, by a choice that stands for it and by its name: "Walk", "1 (Walk)" where
/// another has that name, too, "2" without a name.
std::vector<std::string> list_clips(std::span<const Clip> clips);
std::vector<std::string> list_file_scenes(const Scene& scene);

} // namespace pertev
