#pragma once

// Layers of light-path expressions in device code: the tables of the automaton, and the state of a path in it.
//
// A surface may scatter by diffuse and glossy lobes at once. Light of a shadow ray is split between the two by their
// shares. A path that continues cannot be split, so each of its colours is assigned to one of them at random, with
// its share as probability. Thus a layer's mean is right, every contribution of a path is in one class to the last
// bit, and layers that partition all paths add up to the picture sample by sample. One random number serves the three
// colours.

#include <cstdint>

#include "device_scene/accept_hit.h"
#include "device_scene/scene_view.h"
#include "math/rgb.h"
#include "render/film_view.h"
#include "render/light_paths/light_path_automaton.h"

namespace pertev {

/// State of the automaton for each colour of a path.
struct LightPathState {
    uint32_t red_green = 0, blue = 0; // 16 bits each

    HD uint32_t of(int colour) const {
        return colour == 2 ? blue : colour == 1 ? red_green >> 16 : red_green & 0xffffu;
    }
    HD bool is_nothing() const { return (red_green | blue) == LightPathAutomaton::kNothing; }
};
HD inline LightPathState light_path_state(uint32_t red, uint32_t green, uint32_t blue) {
    return {red | green << 16, blue};
}

struct LightPathView {
    const uint16_t* columns = nullptr; // tables of LightPathAutomaton; null if there are no layers
    const uint16_t* next = nullptr;
    const uint32_t* layers = nullptr;
    const uint16_t* surface_tags = nullptr; // tables of LightPathLayers
    const uint16_t* instance_lights = nullptr;
    const uint16_t* scene_lights = nullptr;
    uint32_t column_count = 0, light_count = 0;
    uint32_t start = 0, environment_light = 0;
    uint32_t words = 0;         // LightPathAutomaton::words, per set of layers
    uint32_t first_channel = 0; // first channel of layer 0 in the film

    HD bool is_there() const { return columns != nullptr; }
    HD LightPathState begin() const { return light_path_state(start, start, start); }
    /// First column of an instance's scatterings; scattering_column() is added to it.
    HD uint32_t first_column(uint32_t instance) const { return surface_tags[instance] * kScatteringColumns; }
    HD uint32_t after(uint32_t state, uint32_t column) const { return next[state * column_count + columns[column]]; }
    HD LightPathState after(LightPathState state, uint32_t column) const {
        return light_path_state(after(state.of(0), column), after(state.of(1), column), after(state.of(2), column));
    }

    /// Light number of a hit: a triangle, (kNoLight, a punctual light), or neither for the environment.
    HD uint32_t light_of(const LightSetView& lights, TriangleId target) const {
        if (target.instance != kNoLight) return instance_lights[target.instance];
        return target.primitive != kNoLight ? scene_lights[lights.punctual[target.primitive].number]
                                            : environment_light;
    }

    /// Adds `radiance`, found by a path in `state`, to the layers of `light`, which is a result of light_of().
    HD void add(const FilmView& film, uint32_t pixel, LightPathState state, uint32_t light, Rgb radiance) const {
        if (!(is_valid_sample(radiance.r) && is_valid_sample(radiance.g) && is_valid_sample(radiance.b))) return;
#if PERTEV_ON_DEVICE
#pragma unroll 1 // unrolled code would take registers that shading needs
#endif
        for (int colour = 0; colour < 3; ++colour) {
            const float value = colour == 0 ? radiance.r : colour == 1 ? radiance.g : radiance.b;
            if (!(value != 0)) continue;
            const uint32_t* const set = layers + (state.of(colour) * light_count + light) * words;
            uint32_t channel = first_channel + static_cast<uint32_t>(colour); // channel of the word's first layer
            for (uint32_t word = 0; word < words; ++word, channel += 3 * 32) {
                uint32_t bits = set[word];
                for (uint32_t c = channel; bits != 0; c += 3, bits >>= 1) {
                    if ((bits & 1u) != 0) add_channel(film, pixel, c, value);
                }
            }
        }
    }
};

/// State of a path after a scattering at a surface whose columns begin at `column`: by a specular lobe, or by diffuse
/// lobes with the probability `diffuse` of each colour and glossy ones otherwise. `u` in (0, 1).
HD inline LightPathState after_scattering(const LightPathView& view, LightPathState state, uint32_t column,
                                          bool is_specular, bool is_transmission, Rgb diffuse, float u) {
    const auto column_of = [&](LobeClass lobe_class) {
        return column + scattering_column(lobe_class, is_transmission);
    };
    if (is_specular) return view.after(state, column_of(LobeClass::Specular));
    const auto column_by = [&](float share) { return column_of(u < share ? LobeClass::Diffuse : LobeClass::Glossy); };
    return light_path_state(view.after(state.of(0), column_by(diffuse.r)),
                            view.after(state.of(1), column_by(diffuse.g)),
                            view.after(state.of(2), column_by(diffuse.b)));
}

} // namespace pertev
