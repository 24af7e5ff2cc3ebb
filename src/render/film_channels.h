#pragma once

// Channels of a film's pixel: R, G, B, hits (the number of samples whose camera ray hit something), then the
// requested auxiliary groups. kAovTable alone defines names, order and numbers of channels.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/host_device.h"

namespace pertev {

/// Groups of auxiliary channels; lower bits come first.
enum AovBits : uint32_t {
    kAovAlbedo = 1,    // reflectance of the first surface
    kAovNormal = 2,    // shading normal of the first surface, world space
    kAovDepth = 4,     // distance along the camera's axis, metres
    kAovPosition = 8,  // in the file's coordinates, in metres; relative to SceneView::position_shift in a far scene
    kAovIds = 16,      // ids of sample 0, which are not sums; see FilmView::ids
    kAovMotion = 32,   // motion vectors, which are not in the film: denoise/motion_vectors.h
    kAovDistance = 64, // along the camera ray, metres
};

/// Auxiliary layers are evaluated at the samples, whose values the film sums, or at the centres of pixels
/// (render/centre_layers.h).
enum class LayersAt : uint8_t { Samples, Centre };

inline constexpr uint32_t kFilmColorChannels = 4;
inline constexpr uint32_t kFilmHits = 3; // index of the channel that counts hits

struct AovGroup {
    AovBits bit;
    const char* name;        // name as text
    const char* layer;       // layer name in files
    const char* channels[3]; // channel names in files; null if there are fewer
    bool is_summed;          // the channels are sums in the film
    bool over_hits;          // mean over the samples that hit something, not over all
};

inline constexpr AovGroup kAovTable[] = {
    {kAovAlbedo, "albedo", "albedo", {"R", "G", "B"}, true, false},
    {kAovNormal, "normal", "normal", {"X", "Y", "Z"}, true, true},
    {kAovDepth, "depth", "depth", {"Z"}, true, true},
    {kAovPosition, "position", "position", {"X", "Y", "Z"}, true, true},
    {kAovIds, "ids", "id", {"instance", "primitive", "material"}, false, false},
    {kAovMotion, "motion", "motion", {"u", "v"}, false, false},
    {kAovDistance, "distance", "distance", {"Z"}, true, true},
};

namespace film_channels {

constexpr uint32_t kGroups = sizeof(kAovTable) / sizeof(kAovTable[0]);

/// Numbers of sums of all groups, packed in four bits each, because device code cannot read the table.
constexpr uint32_t pack_widths() {
    uint32_t widths = 0;
    for (uint32_t i = 0; i < kGroups; ++i) {
        for (const char* channel : kAovTable[i].channels) {
            widths += kAovTable[i].is_summed && channel != nullptr ? 1u << (4 * i) : 0;
        }
    }
    return widths;
}
inline constexpr uint32_t kWidths = pack_widths();

constexpr bool is_in_order_of_bits() {
    for (uint32_t i = 0; i < kGroups; ++i) {
        if (kAovTable[i].bit != 1u << i) return false;
    }
    return true;
}
static_assert(is_in_order_of_bits());

/// Number of sums of a pixel before those of group `index`.
HD constexpr uint32_t sums_before(uint32_t aovs, uint32_t index) {
    uint32_t sums = kFilmColorChannels;
    for (uint32_t i = 0; i < index; ++i) sums += (aovs >> i & 1u) * (kWidths >> (4 * i) & 15u);
    return sums;
}

} // namespace film_channels

/// First channel of group `aov` in a film with the groups `aovs`.
HD constexpr uint32_t channel_offset(uint32_t aovs, AovBits aov) {
    uint32_t index = 0;
    while ((1u << index) < aov) ++index;
    return film_channels::sums_before(aovs, index);
}

/// Total number of sums of a pixel.
HD constexpr uint32_t film_channel_count(uint32_t aovs) {
    return film_channels::sums_before(aovs, film_channels::kGroups);
}

/// Returns the group of one bit.
const AovGroup& aov_group(AovBits aov);
std::vector<std::string> channel_names(const AovGroup& group);

/// Finds a group by its name.
std::optional<AovBits> aov_named(std::string_view name);
/// Names of those groups in the order of their bits.
std::vector<std::string> aov_names(uint32_t aovs = ~0u);

} // namespace pertev
