#pragma once

// Expressions put to a scene: which of its objects and lights their names mean, and the automaton over these. On the
// host; light_path_view.h is what devices read.

#include <cstdint>
#include <span>
#include <vector>

#include "render/light_paths/light_path_automaton.h"
#include "scene/scene.h"

namespace pertev {

/// Layers of a render, and all that says what goes into them. It counts for the scene at every time of its animations.
struct LightPathLayers {
    std::vector<LightPathExpression> expressions; // [layers]
    LightPathAutomaton automaton;
    std::vector<uint16_t> surface_tags;    // [instances]
    std::vector<uint16_t> instance_lights; // [instances]: of LightPathAutomaton::light_count
    std::vector<uint16_t> scene_lights;    // [Scene::lights], likewise
    uint16_t environment_light = 0;        // likewise

    uint32_t count() const { return static_cast<uint32_t>(expressions.size()); }
};

/// Throws Error(BadInput) for two layers of one name.
void check_layers(std::span<const LightPathExpression> expressions);

/// Names are those of scene/names.h. Throws Error(BadInput), with a caret, for a name
/// that nothing has; and what check_layers and make_automaton do.
LightPathLayers put_to_scene(std::vector<LightPathExpression> expressions, const Scene& scene);

} // namespace pertev
