#pragma once

// What moves over time, as glTF 2.0 has it (section 3.11): each channel changes one part of one node by key frames. The
// scene itself is at rest; nothing here has been applied to it.

#include <cstdint>
#include <string>
#include <vector>

namespace pertev {

struct Scene;

enum class AnimatedPart : uint8_t { Translation, Rotation, Scale, Weights };
enum class Interpolation : uint8_t { Step, Linear, CubicSpline };

struct AnimationChannel {
    uint32_t node = 0; // index into Scene::nodes
    AnimatedPart part = AnimatedPart::Translation;
    Interpolation interpolation = Interpolation::Linear;
    std::vector<float> times; // seconds, at least 0, each above the one before
    /// A value for each time, one after the other; for CubicSpline three: tangent into the key, value, tangent out of
    /// it. A value is 3 numbers (Translation in metres, Scale), 4 (Rotation: a quaternion x, y, z, w, not 0) or as many
    /// as the node has morph_weights.
    std::vector<float> values;
};

struct Animation {
    std::string name, origin;
    std::vector<AnimationChannel> channels;
};

/// Of each instance, whether a time may come at which it stands elsewhere or has another shape: an animation changes
/// its node or one above it or its morph weights or, where it has a skin, does so to a joint. All false without
/// animations. Every index is in range (validate()).
std::vector<bool> may_move(const Scene& scene);

} // namespace pertev
