// Settings that apply to one or a few integrators.

#include <limits>

#include "base/limits.h"
#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "integrators/raster/raster_settings.h"
#include "integrators/reyes/reyes_settings.h"
#include "settings/setting_table.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

#define FIELD PERTEV_SETTING_FIELD

constexpr double kMaxRadius = std::numeric_limits<float>::max();

} // namespace

std::vector<Setting> integrator_settings() {
    std::vector<Setting> rows = {
        row("ambient", "Raster", "R,G,B", FIELD(render.ambient),
            "A uniform radiance from all directions that diffuse surfaces reflect.",
            Otherwise{"cast 0, the others the environment's mean"}, Recorded::WhereUsed),
        row("shading", "Raster", "NAME", FIELD(render.display.edit().shading),
            "The points at which light is evaluated: once per triangle, at its vertices, or in every pixel.",
            Recorded::WhereUsed),
        row("wireframe", "Raster", "", FIELD(render.display.edit().is_wireframe),
            "The picture shows only the triangles' edges.", Excludes{"shading"}, Recorded::WhereUsed),
        row("shading_rate", "Reyes", "PIXELS", FIELD(render.shading_rate),
            "The longest edge of a micropolygon in the picture.", Range{kMinShadingRate, kMaxShadingRate},
            Unit{"pixels"}, Recorded::WhereUsed),
        row("displacement", "Reyes", "MATERIAL=FILE,SCALE[,MIDDLE]", FIELD(displacement),
            "A height map that displaces surfaces of this material along their normals by SCALE (height - MIDDLE) in "
            "the mesh's own unit; MIDDLE defaults to 0. It may be given again.",
            HoldsFile::Named, Recorded::AsUsed),

        row("photons", "Photons", "N", FIELD(render.photon_map.edit().photons),
            "The number of photons from the lights per sample; as many again are aimed at mirrors and glass.",
            Range{1, kMaxPhotons}, Recorded::WhereUsed),
        row("gather", "Photons", "NAME", FIELD(render.photon_map.edit().gather),
            "The estimate of indirect light: by final gathering, or directly from the global photon map.",
            Recorded::WhereUsed),
        row("radius", "Photons", "METRES", FIELD(render.photon_map.edit().radius),
            "The search radius of the first sample; it shrinks from sample to sample.",
            Range{kMinPhotonRadius, kMaxRadius}, Unit{"m"}, Otherwise{"a hundredth of the scene"}, Recorded::WhereUsed),
        row("caustic_radius", "Photons", "METRES", FIELD(render.photon_map.edit().caustic_radius),
            "The search radius of the caustic map in the first sample.", Range{kMinPhotonRadius, kMaxRadius}, Unit{"m"},
            Otherwise{"a quarter of the radius"}, Recorded::WhereUsed),
        row("nearest", "Photons", "N", FIELD(render.photon_map.edit().nearest),
            "The number of nearest photons within the radius that an estimate uses.", Range{2, kMaxNearestPhotons},
            Otherwise{"all within the radius"}, Recorded::WhereUsed),

        row("accuracy", "Records", "A", FIELD(render.irradiance_cache.edit().accuracy),
            "The distance at which a record is used, relative to the mean distance of the surfaces around it; less is "
            "more exact.",
            Range{kMinAccuracy, kMaxAccuracy}, Recorded::WhereUsed),
        row("hemisphere_rays", "Records", "N", FIELD(render.irradiance_cache.edit().hemisphere_rays),
            "The maximum number of rays that sample a record's hemisphere.",
            Range{kFewestHemisphereRays, kMaxHemisphereRays}, Recorded::WhereUsed),
        row("show_records", "Records", "", FIELD(render.irradiance_cache.edit().show_records),
            "The picture shows the records' positions.", Mark::AfterRecords, Recorded::WhereUsed),

        row("patch_size", "Radiosity", "METRES", FIELD(radiosity.solving.patch_size), "The longest edge of a patch.",
            Above{0, kMaxCoordinate}, Unit{"m"}, Otherwise{"a 16th of the scene's longest side"}, Excludes{"solution"}),
        row("subdivisions", "Radiosity", "N", FIELD(radiosity.solving.subdivisions),
            "The number of times that a patch may be subdivided where light changes over it.",
            Range{0, kMaxSubdivisions}, Excludes{"solution"}),
        row("contrast", "Radiosity", "X", FIELD(radiosity.solving.contrast),
            "The relative change of light at which a patch is subdivided.", Above{0},
            Excludes{"solution subdivisions=0"}),
        row("form_factors", "Radiosity", "NAME", FIELD(radiosity.solving.form_factors), "The method for form factors.",
            Excludes{"solution hemicube:solver=hierarchical"}),
        row("patch_rays", "Radiosity", "N", FIELD(radiosity.solving.rays),
            "The number of rays for a patch's form factors.", Range{kMinPatchRays, kMaxPatchRays},
            Excludes{"solution"}),
        row("hemicube", "Radiosity", "PIXELS", FIELD(radiosity.solving.hemicube),
            "The number of pixels along the edge of a hemicube's top.", Range{kMinHemicube, kMaxHemicube},
            Unit{"pixels"}, Needs{"form_factors=hemicube"}, Excludes{"solution"}),
        row("solver", "Radiosity", "NAME", FIELD(radiosity.solving.solver),
            "The solver of the patches' radiosity; southwell is progressive refinement.", Excludes{"solution"}),
        row("tolerance", "Radiosity", "X", FIELD(radiosity.solving.tolerance),
            "The share of light left unsolved at which the solver stops.", Above{0, 1},
            Excludes{"solution solver=matrix"}),
        row("steps", "Radiosity", "N", FIELD(radiosity.solving.steps),
            "The maximum number of patches that shoot; unshot light is shown as ambient light.", Range{1, UINT32_MAX},
            Otherwise{"any number"}, Needs{"solver=southwell"}, Excludes{"solution"}),
        row("link_error", "Radiosity", "X", FIELD(radiosity.solving.link_error),
            "The largest error of a link, relative to the mean light.", Above{0}, Needs{"solver=hierarchical"},
            Excludes{"solution"}),
        row("solution", "Radiosity", "FILE", FIELD(radiosity.solution),
            "A solution that was solved and written before, to be rendered.", Otherwise{"the scene is solved first"},
            Mark::Name, Mark::OpensScene, HoldsFile::Whole),
        row("flat_patches", "Radiosity", "", FIELD(radiosity.flat_patches),
            "Patches have constant radiosity, without interpolation.", Recorded::AsUsed),
    };
    for (Setting& row : rows) {
        const bool is_solved = row.group == SettingGroup::Radiosity && !row.is_name && !is_switch(row);
        row.verbs = kLooking | (is_solved ? uint32_t(kSolve) : 0);
    }
    return rows;
}

std::vector<Setting> frame_settings() {
    std::vector<Setting> rows = {
        row("frame_denoiser", "Frames", "NAME", FIELD(reconstruction.settings.denoiser),
            "The filter of frames: svgf, or oidn in fast quality of each frame's sample by itself, without history.",
            Excludes{"no_reconstruction"}),
        row("no_reconstruction", "Frames", "", FIELD(reconstruction.none), "Frames are shown without reconstruction."),
        row(
            "no_firefly_clamping", "Frames", "",
            [](PictureOptions& o) -> SettingField { return InverseSwitch{&o.reconstruction.settings.clamp_fireflies}; },
            "Samples far brighter than their neighbours are not clamped.", OldName{"no_firefly_limit"}),
        row(
            "no_history_clamping", "Frames", "",
            [](PictureOptions& o) -> SettingField { return InverseSwitch{&o.reconstruction.settings.clamp_history}; },
            "Long-term means are not clamped to recent frames where both disagree.", OldName{"no_history_limit"}),
        row(
            "no_temporal_gradients", "Frames", "",
            [](PictureOptions& o) -> SettingField {
                return InverseSwitch{&o.reconstruction.settings.temporal_gradients};
            },
            "Accumulated frames do not adapt to changing light in moving scenes.", OldName{"no_follow_light"}),
        row(
            "no_anti_alias", "Frames", "",
            [](PictureOptions& o) -> SettingField { return InverseSwitch{&o.reconstruction.settings.anti_alias}; },
            "Temporal anti-aliasing is off."),
        row("history", "Frames", "N", FIELD(reconstruction.settings.history),
            "The maximum number of accumulated frames; 0: each by itself.", Range{0, 1024}),
        row("passes", "Frames", "N", FIELD(reconstruction.settings.passes),
            "The number of passes of the wavelet filter.", Range{0, 8}),
        row("restir", "Frames", "NAME", FIELD(reconstruction.sharing.light),
            "Resampling of light between pixels: di for direct light at the first surface, gi for indirect light, too. "
            "It helps with many emitters.",
            Panel{"ReSTIR", PanelGroup::Frames}),
        row("restir_history", "Frames", "N", FIELD(reconstruction.sharing.history),
            "The most samples that a reservoir of earlier frames counts as. Fewer follow moving light sooner, with "
            "more noise.",
            Range{0, 1024}, Panel{"ReSTIR max history, frames", PanelGroup::Frames}),
        row("resolution_scale", "Frames", "X", FIELD(reconstruction.settings.resolution_scale),
            "The resolution of light, relative to each side of the picture; less is faster. Edges and textures keep "
            "theirs.",
            Range{0.1, 1}, Panel{"Light resolution, per side", PanelGroup::Frames, 0.05}),
        row("moving_depth", "Frames", "N", FIELD(render.frame_depth),
            "The maximum number of scatterings in frames, if below max_depth. Less is faster, but may be darker.",
            Range{0, kMaxPathDepth - 1}, Otherwise{"max_depth; in the viewer 4, unless max_depth is given"},
            Panel{"Max depth in motion", PanelGroup::Frames}),
    };
    for (Setting& row : rows) {
        row.verbs = kRender | kView | kBenchFrames | kBenchSequence;
        row.needs = std::string_view(row.name) == "history" ? "real_time denoise=svgf" : "real_time";
    }
    rows.insert(
        rows.begin(),
        row("real_time", "Frames", "", FIELD(real_time),
            "Frames are those of the viewer in motion: one sample per pixel, reconstructed with earlier frames.",
            Of{integrators_that(makes_frames)}, Needs{"frames turntable"},
            Excludes{"denoise!=none transparent shutter lpe false_color=illuminance"}));
    return rows;
}

} // namespace pertev
