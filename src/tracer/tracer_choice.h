#pragma once

// The tracer that rendering uses for each kind of ray. The choice does not change any picture.

#include <cstdint>

#include "tracer/combination.h"

namespace pertev {

enum class RayKind : uint8_t { Camera, Bounce, Shadow };
/// Names of ray kinds as text.
inline constexpr ValueName<RayKind> kRayKinds[] = {
    {RayKind::Camera, "camera"}, {RayKind::Bounce, "bounce"}, {RayKind::Shadow, "shadow"}};
constexpr const auto& names_of_all(RayKind) { return kRayKinds; }

struct TracerChoice {
    Combination camera, bounce, shadow;

    Combination& operator[](RayKind kind) {
        return kind == RayKind::Camera ? camera : kind == RayKind::Bounce ? bounce : shadow;
    }
    const Combination& operator[](RayKind kind) const { return const_cast<TracerChoice&>(*this)[kind]; }
    bool operator==(const TracerChoice&) const = default;
};

/// Uses one combination for all kinds of ray.
TracerChoice same_for_all(const Combination& combination);
/// Build effort: how long the tree may take to build for the traversal speed that it gives (docs/performance.md).
enum class TreeBuild : uint8_t {
    Fast,     // shortest build, and can be refitted: for content that changes in every frame
    Balanced, // pays off within the first picture
    Best,     // pays off over many pictures
};
/// Names of build efforts as text, from the fastest build to the best tree.
inline constexpr ValueName<TreeBuild> kTreeBuilds[] = {
    {TreeBuild::Fast, "fast"}, {TreeBuild::Balanced, "balanced"}, {TreeBuild::Best, "best"}};
constexpr const auto& names_of_all(TreeBuild) { return kTreeBuilds; }
inline constexpr TreeBuild kDefaultBuild = TreeBuild::Balanced;

/// The structure that a build effort stands for, defined only here.
StructureKind structure_of(TreeBuild build);

/// The combinations that are fastest for most scenes (docs/performance.md).
TracerChoice default_tracers(bool on_cuda, TreeBuild build = kDefaultBuild);

/// Builder of the trees that a scene is prepared with: the one that most rays use, or the default tracers' builder if
/// the choice has no binary tree.
BvhBuilder builder_of(const TracerChoice& choice);

/// Returns whether a ray loop on the host may traverse the chosen structure directly (device_scene/find_hits.h): one
/// structure for all kinds, eight boxes at a time, every switch on.
bool can_traverse_on_host(const TracerChoice& choice, bool on_cuda);

/// Throws Error(BadInput) if a chosen tracer is invalid on this kind of device, was not compiled, or uses tests that
/// leak.
void check_choice(const TracerChoice& choice, bool on_cuda);

} // namespace pertev
