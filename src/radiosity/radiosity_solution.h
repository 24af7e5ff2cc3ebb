#pragma once

// A radiosity solution: the irradiance of every patch of a scene's surfaces. It does not depend on a camera, so that
// one file serves any number of pictures of the scene.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/hash.h"
#include "base/messages.h"
#include "radiosity/radiosity_view.h"
#include "radiosity/solved_light.h"
#include "scene/scene.h"

namespace pertev {

/// How far a solution has come.
enum class SolvedPart : uint32_t {
    All,
    SomeDirectLight, // that is found for some patches; nothing that surfaces pass on
    DirectLight,     // nothing that surfaces pass on
    SomeBounces,     // light is still to be passed on; no patch is divided for its light
    SomeDivided,     // all light; patches are not divided as far as was asked for
};

struct SolvedExtent {
    SolvedPart part = SolvedPart::All;
    /// [0, 1], 0 of All and SomeDivided. Share of the patches without direct light; of the light that surfaces still
    /// have to pass on, or that the last step changed.
    float left = 0;

    bool operator==(const SolvedExtent&) const = default;
};

/// What a solution holds: "direct light alone, nothing that surfaces pass on"; empty for all.
std::string describe(const SolvedExtent& extent);

struct RadiositySolution {
    Hash128 geometry;                 // geometry_hash of its scene
    std::optional<SolvedLight> light; // of its scene; none: of a file that does not say
    std::string made;                 // by which settings, a JSON object
    std::vector<PatchCode> roots;     // [faces]
    std::vector<PatchQuad> quads;
    std::vector<PatchLight> patches;
    Rgb ambient;         // RadiosityView's
    SolvedExtent extent; // All, unless it was ended

    std::size_t bytes() const {
        return roots.size() * sizeof(PatchCode) + quads.size() * sizeof(PatchQuad) +
               patches.size() * sizeof(PatchLight);
    }
    RadiosityView view() const { return {{roots.data(), quads.data()}, patches.data(), ambient}; }
    /// Of all its bytes.
    Hash128 hash() const;
};

/// Changes with the vertices, triangles and materials' numbers of every instance and with where it stands.
Hash128 geometry_hash(const Scene& scene);

/// Throws Error(FileWrite).
void write_solution(const std::filesystem::path& path, const RadiositySolution& solution);

/// Whether the file begins as a solution's does.
bool is_solution(const std::filesystem::path& path);

/// Of any scene. Throws Error(BadInput) that says why where there is no such file, where it is none, damaged or cut
/// short: whatever it holds, what is returned is safe to look things up in.
RadiositySolution read_any_solution(const std::filesystem::path& path);

/// The same; throws Error(BadInput) too where it is of another scene or of this one under other light. Of a file that
/// does not say what light it was solved for that is a warning; of one that was ended before it was whole too.
RadiositySolution read_solution(const std::filesystem::path& path, const Scene& scene, Messages& messages);

} // namespace pertev
