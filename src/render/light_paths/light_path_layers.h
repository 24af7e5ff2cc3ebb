#pragma once

// Binds expressions to a scene: resolves their names to objects and lights, and makes the automaton over these. It
// runs on the host; light_path_view.h is the device form.

#include <cstdint>
#include <span>
#include <vector>

#include "render/light_paths/light_path_automaton.h"
#include "scene/scene.h"

namespace pertev {

/// The layers of a render and everything that decides their content. They are valid at every time of the scene's
/// animations.
struct LightPathLayers {
    std::vector<LightPathExpression> expressions; // [layers]
    LightPathAutomaton automaton;
    std::vector<uint16_t> surface_tags;    // [instances], and one of the scene's medium, if it has one
    std::vector<uint16_t> instance_lights; // [instances], below LightPathAutomaton::light_count
    std::vector<uint16_t> scene_lights;    // [Scene::lights], in the same numbering
    uint16_t environment_light = 0;        // in the same numbering

    uint32_t count() const { return static_cast<uint32_t>(expressions.size()); }
};

/// Checks names of layers. Throws Error(BadInput) if two layers have the same name.
void check_layers(std::span<const LightPathExpression> expressions);

/// Makes the layers of expressions for a scene. Names are those of scene/names.h. Throws Error(BadInput) with a caret
/// for a name that nothing has, and as check_layers and make_automaton.
LightPathLayers bind_to_scene(std::vector<LightPathExpression> expressions, const Scene& scene);

} // namespace pertev
