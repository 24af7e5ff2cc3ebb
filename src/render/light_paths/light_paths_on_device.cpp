#include "render/light_paths/light_paths_on_device.h"

namespace pertev {

LightPathsOnDevice::LightPathsOnDevice(Queue& queue, const LightPathLayers& layers)
    : columns_(queue, layers.automaton.columns, "light paths"), next_(queue, layers.automaton.next, "light paths"),
      surface_tags_(queue, layers.surface_tags, "light paths"),
      instance_lights_(queue, layers.instance_lights, "light paths"),
      scene_lights_(queue, layers.scene_lights, "light paths"), layers_(queue, layers.automaton.layers, "light paths") {
    view_.columns = columns_.data();
    view_.next = next_.data();
    view_.layers = layers_.data();
    view_.surface_tags = surface_tags_.data();
    view_.instance_lights = instance_lights_.data();
    view_.scene_lights = scene_lights_.data();
    view_.column_count = layers.automaton.column_count;
    view_.light_count = layers.automaton.light_count;
    view_.words = layers.automaton.words;
    view_.start = layers.automaton.start;
    view_.environment_light = layers.environment_light;
    queue.wait(); // the host copies may be freed now
}

LightPathView LightPathsOnDevice::view(uint32_t aovs) const {
    LightPathView view = view_;
    view.first_channel = film_channel_count(aovs);
    return view;
}

} // namespace pertev
