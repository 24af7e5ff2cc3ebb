#pragma once

// A scene of arrays: Python's dictionaries of meshes, materials, instances, lights and cameras, each by its name. All
// arrays are copied. Needs the interpreter's lock.

#include <string>

#include <nanobind/nanobind.h>

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev {

/// `parts` has the keys meshes, materials, instances, lights, cameras and environment, each a dictionary, a value, or
/// None. The scene has passed validate(), where `name` stands for its file. Throws Error(BadInput) with a path such as
/// "meshes/floor/faces" as the setting.
Scene scene_of_arrays(const std::string& name, const nanobind::dict& parts, Sink& sink);

} // namespace pertev
