#pragma once

// A scene of arrays: Python's dictionaries of meshes, materials, instances, lights and cameras, each by its name. All
// arrays are copied. Needs the interpreter's lock.

#include <nanobind/nanobind.h>

#include "scene/scene.h"

namespace pertev {

/// `parts` has the keys meshes, materials, instances, lights, cameras and environment, each a dictionary, a value, or
/// None. The scene is yet to pass validate(). Throws Error(BadInput) with a path such as "meshes/floor/faces" as the
/// setting.
Scene scene_of_arrays(const nanobind::dict& parts);

} // namespace pertev
