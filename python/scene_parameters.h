#pragma once

// Numbers of a scene that a caller may change between pictures, by paths such as "materials/gold/roughness". An object
// without a name of its own has its number there, and the environment has neither: "environment/scale". Everything is
// in the coordinates of the file.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "scene/scene.h"
#include "scene/scene_update.h"

namespace pertev {

enum class ParameterOwner : uint8_t { Material, Instance, Light, Camera, Environment };

struct SceneParameter {
    ParameterOwner owner = ParameterOwner::Material;
    uint32_t index = 0;    // number of the owner
    std::string_view name; // a constant
};

/// The names of a scene's objects in paths. They stay valid for copies of the scene.
class SceneParameters {
public:
    explicit SceneParameters(const Scene& scene);

    /// Returns the paths of all parameters of the scene from which it was made.
    std::vector<std::string> paths(const Scene& scene) const;
    std::optional<SceneParameter> find(const Scene& scene, std::string_view path) const;
    /// Returns the parameter of an object by its number.
    static std::optional<SceneParameter> find(const Scene& scene, ParameterOwner owner, uint32_t index,
                                              std::string_view name);

private:
    struct Owners {
        std::vector<std::string> names;
        std::unordered_map<std::string, uint32_t> indices;
    };
    Owners owners_[5]; // by ParameterOwner
};

/// Returns the lengths of the axes: none of a number, 3 of a colour or vector, 4 and 4 of a transform.
std::vector<std::size_t> shape_of(const SceneParameter& parameter);
/// Returns the values, of matrices row by row.
std::vector<double> read_parameter(const Scene& scene, const SceneParameter& parameter);
/// Sets values that have passed check_parameter and returns what has changed.
SceneUpdate write_parameter(Scene& scene, const SceneParameter& parameter, std::span<const double> values);
/// Throws Error(BadInput), with `path` as the setting, for values that are no number, out of range or no transform, and
/// if an animation changes the parameter. There are as many values as shape_of() says.
void check_parameter(const Scene& scene, const SceneParameter& parameter, std::span<const double> values,
                     const std::string& path);

} // namespace pertev
