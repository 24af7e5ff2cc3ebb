#include "lab/transport_presets.h"

#include <algorithm>
#include <iterator>

namespace pertev {
namespace {

constexpr TransportPreset kTransportPresets[] = {
    {"cornell", "cornell-box", "ordinary light: a lamp that every surface sees", "path", false, {}, {}, 0},
    {"caustic",
     "caustic",
     "light of a small lamp that clear glass gathers on a floor",
     "bidirectional",
     true,
     {0.5f, 1.6f, 2.6f},
     {0, 0.5f, 0},
     50},
    {"blind",
     "blind",
     "a lamp behind slats, which the camera's paths hardly ever meet",
     "bidirectional",
     true,
     {0, 1.5f, 1.9f},
     {0, 1.2f, 0},
     75},
    {"door",
     "door",
     "a room lit through a door that is ajar, from the room next to it",
     "path",
     true,
     {0, 1.5f, 1.9f},
     {0, 1.2f, 0},
     75},
    {"cove",
     "cove",
     "a diffuse room lit by way of its ceiling, from lamps behind a ledge: soft light that can be interpolated",
     "bidirectional",
     true,
     {0, 1.7f, 1.9f},
     {0, 0.7f, -1},
     55},
    {"many-lights",
     "many-lights",
     "ten thousand small lights, of which each place sees a few well",
     "path",
     false,
     {},
     {},
     0},
};

} // namespace

std::span<const TransportPreset> transport_presets() { return kTransportPresets; }

const TransportPreset* find_transport_preset(std::string_view name) {
    const auto* const at = std::ranges::find(kTransportPresets, name, &TransportPreset::name);
    return at == std::end(kTransportPresets) ? nullptr : at;
}

CameraChoice camera_choice(const TransportPreset& preset) {
    CameraChoice choice;
    if (!preset.has_camera) return choice;
    choice.eye = to_double(preset.eye), choice.target = to_double(preset.target), choice.fov_deg = preset.fov_deg;
    return choice;
}

} // namespace pertev
