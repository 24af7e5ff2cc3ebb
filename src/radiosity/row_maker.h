#pragma once

// The two methods to compute a row of form factors. A row depends only on the scene, the patch, its number and the
// settings, whichever thread computes it.

#include <memory>
#include <optional>
#include <vector>

#include "radiosity/form_factor_row.h"
#include "radiosity/hemicube.h"
#include "radiosity/patches.h"
#include "radiosity/radiosity_settings.h"
#include "radiosity/solved_scene.h"
#include "radiosity/work_watch.h"

namespace pertev {

/// Inputs of a row: `sources` are the patches to which it refers. Once `watch` is over, rows are incomplete.
struct RowScene {
    const SolvedScene& scene;
    const PatchTree& sources;
    WorkWatch* watch = nullptr;

    bool is_over() const { return watch != nullptr && watch->is_over(); }
};

/// Computes rows in one thread and reuses its memory.
class RowMaker {
public:
    virtual ~RowMaker() = default;
    /// Computes the row of `patch`, which may be one of the sources or a part of one. `number` is the key of its
    /// random numbers.
    virtual void make(const Patch& patch, uint32_t number, FormFactorRow& row) = 0;
};

/// Data that hemicube rows share.
struct HemicubeScene {
    struct PlacedCorners {
        Vec3 at[3]; // metres
        uint32_t instance, primitive;
    };
    HemicubeScene(const SceneView& scene, uint32_t resolution);

    std::vector<PlacedCorners> triangles; // all triangles of the scene
    HemicubePixels pixels;
};

std::unique_ptr<RowMaker> make_ray_rows(const RowScene& scene, const RadiositySettings& settings);
/// Makes a row maker by hemicubes; `hemicube` outlives it.
std::unique_ptr<RowMaker> make_hemicube_rows(const RowScene& scene, const RadiositySettings& settings,
                                             const HemicubeScene& hemicube);

/// Maximum bytes of a thread's hemicube, besides the row.
std::size_t max_hemicube_bytes(uint32_t resolution);

/// Makes row makers according to the settings.
class RowMakers {
public:
    /// Takes references to all arguments, which outlive it.
    RowMakers(const SolvedScene& scene, const PatchTree& sources, const RadiositySettings& settings,
              WorkWatch* watch = nullptr);
    std::unique_ptr<RowMaker> for_thread() const;

private:
    RowScene scene_;
    RadiositySettings settings_;
    std::optional<HemicubeScene> hemicube_;
};

} // namespace pertev
