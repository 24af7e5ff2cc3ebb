#pragma once

// Which tracer pictures take for each kind of ray. The choice changes no picture.

#include <cstdint>

#include "tracer/combination.h"

namespace pertev {

enum class RayKind : uint8_t { Camera, Bounce, Shadow };
/// These are the names that people type.
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

/// The one for all kinds of ray.
TracerChoice same_for_all(const Combination& combination);
/// How long the tree of pictures may take to build, for what it then gives (docs/performance.md).
enum class TreeBuild : uint8_t {
    Fast,     // soonest there, and refitted when meshes are deformed: for what is another in every frame
    Balanced, // what the first picture already pays for
    Best,     // what many pictures pay for
};
/// These are the names that people type; each is better than the one before.
inline constexpr ValueName<TreeBuild> kTreeBuilds[] = {
    {TreeBuild::Fast, "fast"}, {TreeBuild::Balanced, "balanced"}, {TreeBuild::Best, "best"}};
constexpr const auto& names_of_all(TreeBuild) { return kTreeBuilds; }
inline constexpr TreeBuild kDefaultBuild = TreeBuild::Balanced;

/// Which structure that is: the one place that says so.
StructureKind structure_of(TreeBuild build);

/// What is fastest for most scenes, by docs/performance.md.
TracerChoice default_tracers(bool on_cuda, TreeBuild build = kDefaultBuild);

/// The builder of the trees that a scene is prepared with: that of most rays, or of default tracers where these walk no
/// binary tree.
BvhBuilder builder_of(const TracerChoice& choice);

/// Whether a loop on the host may walk what is chosen by itself (device_scene/find_hits.h): one structure, eight boxes
/// at a time, every switch on.
bool can_walk_on_host(const TracerChoice& choice, bool on_cuda);

/// Throws Error(BadInput) that says why where a tracer that was chosen makes no sense there, was not compiled, or has
/// tests that leak.
void check_choice(const TracerChoice& choice, bool on_cuda);

} // namespace pertev
