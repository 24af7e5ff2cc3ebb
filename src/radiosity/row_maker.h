#pragma once

// The two ways to find a row of form factors. A row is a function of the scene, the patch, its number and the settings
// alone, whichever thread makes it.

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

/// What a row is made of: `sources` are the patches that it names. Once `watch` is over, rows are cut short.
struct RowScene {
    const SolvedScene& scene;
    const PatchTree& sources;
    WorkWatch* watch = nullptr;

    bool is_over() const { return watch != nullptr && watch->is_over(); }
};

/// For one thread: it keeps its memory from row to row.
class RowMaker {
public:
    virtual ~RowMaker() = default;
    /// The row of `patch`, which may be one of the sources or a part of one. `number` is what its random numbers are
    /// drawn by.
    virtual void make(const Patch& patch, uint32_t number, FormFactorRow& row) = 0;
};

/// What rows by hemicubes share.
struct HemicubeScene {
    struct PlacedCorners {
        Vec3 at[3]; // metres
        uint32_t instance, primitive;
    };
    HemicubeScene(const SceneView& scene, uint32_t resolution);

    std::vector<PlacedCorners> triangles; // all that are there
    HemicubePixels pixels;
};

std::unique_ptr<RowMaker> make_ray_rows(const RowScene& scene, const RadiositySettings& settings);
/// `hemicube` outlives it.
std::unique_ptr<RowMaker> make_hemicube_rows(const RowScene& scene, const RadiositySettings& settings,
                                             const HemicubeScene& hemicube);

/// Of a thread's hemicube, beside the row.
std::size_t most_hemicube_bytes(uint32_t resolution);

/// Makes them by what the settings say.
class RowMakers {
public:
    /// All outlive it.
    RowMakers(const SolvedScene& scene, const PatchTree& sources, const RadiositySettings& settings,
              WorkWatch* watch = nullptr);
    std::unique_ptr<RowMaker> for_thread() const;

private:
    RowScene scene_;
    RadiositySettings settings_;
    std::optional<HemicubeScene> hemicube_;
};

} // namespace pertev
