#pragma once

// A radiosity solution: the irradiance of every patch of a scene's surfaces. It does not depend on a camera, so one
// file serves any number of pictures of the scene.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/hash.h"
#include "base/sink.h"
#include "radiosity/radiosity_view.h"
#include "radiosity/solved_light.h"
#include "scene/scene.h"

namespace pertev {

/// Degree to which a solution is complete.
enum class SolvedPart : uint32_t {
    All,
    SomeDirectLight, // direct light of some patches; no reflected light
    DirectLight,     // direct light; no reflected light
    SomeBounces,     // some reflected light is missing; no patch is divided for its light
    SomeDivided,     // all light; patches are not divided as far as requested
};

struct SolvedExtent {
    SolvedPart part = SolvedPart::All;
    /// Missing part in [0, 1], 0 for All and SomeDivided: the share of patches without direct light, or of the light
    /// that surfaces have not yet reflected, or that the last step changed.
    float left = 0;

    bool operator==(const SolvedExtent&) const = default;
};

/// Describes a solution, for example "direct light alone, nothing that surfaces pass on"; empty for a complete one.
std::string describe(const SolvedExtent& extent);

struct RadiositySolution {
    Hash128 geometry;                 // geometry_hash of its scene
    std::optional<SolvedLight> light; // light of its scene; none if the file does not state it
    std::string made;                 // settings that made it, a JSON object
    std::vector<PatchCode> roots;     // [faces]
    std::vector<PatchQuad> quads;
    std::vector<PatchLight> patches;
    Rgb ambient;         // copied to RadiosityView
    SolvedExtent extent; // All, unless it was interrupted

    std::size_t bytes() const {
        return roots.size() * sizeof(PatchCode) + quads.size() * sizeof(PatchQuad) +
               patches.size() * sizeof(PatchLight);
    }
    RadiosityView view() const { return {{roots.data(), quads.data()}, patches.data(), ambient}; }
    /// Hash of all bytes of the solution.
    Hash128 hash() const;
};

/// Hash of the vertices, triangles, materials' numbers and transform of every instance.
Hash128 geometry_hash(const Scene& scene);

/// Returns the bytes of a solution's file.
std::vector<std::byte> bytes_of(const RadiositySolution& solution);

/// Writes a solution atomically. Throws Error(FileWrite).
void write_solution(const std::filesystem::path& path, const RadiositySolution& solution);

/// Returns whether the file begins like a solution.
bool is_solution(const std::filesystem::path& path);

/// Reads a solution of any scene. Throws Error(BadInput) with the reason if the file does not exist, or is no
/// solution, damaged or truncated. Whatever the file contains, lookups in the result are safe.
RadiositySolution read_any_solution(const std::filesystem::path& path);

/// Returns the solution of `scene` whose file has these bytes; `path` names it in errors, which are those of
/// read_solution.
RadiositySolution solution_of(std::span<const std::byte> bytes, const std::filesystem::path& path, const Scene& scene);

/// Reads a solution of `scene`. Throws Error(BadInput) too if it belongs to another scene, or to this one under other
/// light. A file that does not state its light gives a warning, and so does an incomplete solution.
RadiositySolution read_solution(const std::filesystem::path& path, const Scene& scene, Sink& sink);

} // namespace pertev
