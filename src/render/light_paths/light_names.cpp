#include "render/light_paths/light_names.h"

namespace pertev {

std::vector<Names> names_of_lights(const Scene& scene) {
    std::vector<Names> lights;
    for (const Instance& instance : scene.instances) {
        const Material& material = scene.materials[instance.material];
        const bool emits = material.is_emissive() || material.is_unlit();
        lights.push_back(emits ? names_of(scene, instance) : Names{});
    }
    for (const Light& light : scene.lights) lights.push_back(names_of(scene, light));
    lights.push_back(scene.environment ? Names{kEnvironmentName} : Names{});
    return lights;
}

} // namespace pertev
