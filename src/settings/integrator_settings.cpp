// Settings that apply to one or a few integrators.

#include <initializer_list>
#include <limits>

#include "base/limits.h"
#include "settings/setting_table.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

#define FIELD PERTEV_SETTING_FIELD

constexpr uint32_t bits_of(std::initializer_list<IntegratorKind> kinds) {
    uint32_t bits = 0;
    for (const IntegratorKind kind : kinds) bits |= 1u << static_cast<uint32_t>(kind);
    return bits;
}

constexpr uint32_t kRaster = bits_of({IntegratorKind::Raster}), kReyes = bits_of({IntegratorKind::Reyes}),
                   kPhotons = bits_of({IntegratorKind::PhotonMap}),
                   kRecords = bits_of({IntegratorKind::IrradianceCache}),
                   kRadiosity = bits_of({IntegratorKind::Radiosity});
constexpr double kMostFloat = std::numeric_limits<float>::max();

} // namespace

std::vector<Setting> integrator_settings() {
    std::vector<Setting> rows = {
        row("ambient", "Raster", "R,G,B", FIELD(render.ambient),
            "Diffuse surfaces reflect this radiance from all around.",
            Otherwise{"cast 0, the others the environment's mean"},
            Of{bits_of({IntegratorKind::Cast, IntegratorKind::Whitted, IntegratorKind::Raster, IntegratorKind::Reyes})},
            Recorded::WhereUsed),
        row("shading", "Raster", "NAME", FIELD(render.look.shading),
            "Light is evaluated once a triangle, at its corners, or in every pixel.", Of{kRaster}, Recorded::WhereUsed),
        row("wireframe", "Raster", "", FIELD(render.look.is_wireframe), "The picture shows the triangles' edges alone.",
            Of{kRaster}, Excludes{"shading"}, Recorded::WhereUsed),
        row("shading_rate", "Reyes", "PIXELS", FIELD(render.shading_rate),
            "No edge of a micropolygon is longer than this in the picture.", Range{kMinShadingRate, kMaxShadingRate},
            Unit{"pixels"}, Of{kReyes}, Recorded::WhereUsed),
        row("displacement", "Reyes", "MATERIAL=FILE,SCALE[,MIDDLE]", FIELD(displacement),
            "The heights in a picture move surfaces of this material along their normals by SCALE (height - MIDDLE), "
            "in the mesh's own unit; MIDDLE is 0 without. It may be given again.",
            Of{kReyes}),

        row("photons", "Photons", "N", FIELD(render.photon_map.photons),
            "This many photons leave the lights for each sample, and as many again are aimed at mirrors and glass.",
            Range{1, kMaxPhotons}, Of{kPhotons}, Recorded::WhereUsed),
        row("gather", "Photons", "NAME", FIELD(render.photon_map.gather),
            "Light of other surfaces is found by a ray onwards, or directly from the map.", Of{kPhotons},
            Recorded::WhereUsed),
        row("radius", "Photons", "METRES", FIELD(render.photon_map.radius),
            "An estimate of the first sample takes in photons within this radius, which shrinks from sample to sample.",
            Range{kMinPhotonRadius, kMostFloat}, Unit{"m"}, Otherwise{"a hundredth of the scene"}, Of{kPhotons},
            Recorded::WhereUsed),
        row("caustic_radius", "Photons", "METRES", FIELD(render.photon_map.caustic_radius),
            "The same radius for photons of the caustic map.", Range{kMinPhotonRadius, kMostFloat}, Unit{"m"},
            Otherwise{"a quarter of the radius"}, Of{kPhotons}, Recorded::WhereUsed),
        row("nearest", "Photons", "N", FIELD(render.photon_map.nearest),
            "An estimate takes in the N nearest photons within the radius.", Range{2, kMaxNearestPhotons},
            Otherwise{"all within it"}, Of{kPhotons}, Recorded::WhereUsed),

        row("accuracy", "Records", "A", FIELD(render.irradiance_cache.accuracy),
            "A record is used within this share of the mean distance to the surfaces around it; less is more exact.",
            Range{kMinAccuracy, kMaxAccuracy}, Of{kRecords}, Recorded::WhereUsed),
        row("hemisphere_rays", "Records", "N", FIELD(render.irradiance_cache.hemisphere_rays),
            "At most this many rays sample the hemisphere of a record.",
            Range{kFewestHemisphereRays, kMaxHemisphereRays}, Of{kRecords}, Recorded::WhereUsed),
        row("show_records", "Records", "", FIELD(render.irradiance_cache.show_records),
            "The picture shows where records are.", Of{kRecords}, Recorded::WhereUsed),

        row("patch_size", "Radiosity", "METRES", FIELD(radiosity.solving.patch_size),
            "No edge of a patch is longer than this.", Above{0, kMaxCoordinate}, Unit{"m"},
            Otherwise{"a 16th of the scene's longest side"}, Excludes{"solution"}),
        row("subdivisions", "Radiosity", "N", FIELD(radiosity.solving.subdivisions),
            "A patch is divided at most this often where light changes over it.", Range{0, kMaxSubdivisions},
            Excludes{"solution"}),
        row("contrast", "Radiosity", "X", FIELD(radiosity.solving.contrast),
            "A patch is divided where light differs over it by this share.", Above{0},
            Excludes{"solution subdivisions=0"}),
        row("form_factors", "Radiosity", "NAME", FIELD(radiosity.solving.form_factors),
            "Form factors are found by rays, or by hemicubes, which the solver hierarchical does not have.",
            Excludes{"solution"}),
        row("patch_rays", "Radiosity", "N", FIELD(radiosity.solving.rays),
            "This many rays find the form factors of a patch.", Range{kMinPatchRays, kMaxPatchRays},
            Excludes{"solution"}),
        row("hemicube", "Radiosity", "PIXELS", FIELD(radiosity.solving.hemicube),
            "The edge of a hemicube's top has this many pixels.", Range{kMinHemicube, kMaxHemicube}, Unit{"pixels"},
            Needs{"form_factors=hemicube"}, Excludes{"solution"}),
        row("solver", "Radiosity", "NAME", FIELD(radiosity.solving.solver),
            "This solver finds the patches' radiosity; southwell is progressive refinement.", Excludes{"solution"}),
        row("tolerance", "Radiosity", "X", FIELD(radiosity.solving.tolerance),
            "The solver ends when no more than this share of the light is left.", Above{0, 1},
            Excludes{"solution solver=matrix"}),
        row("steps", "Radiosity", "N", FIELD(radiosity.solving.steps),
            "At most this many patches shoot; what is left is shown as ambient light.", Range{1, UINT32_MAX},
            Otherwise{"any number"}, Needs{"solver=southwell"}, Excludes{"solution"}),
        row("link_error", "Radiosity", "X", FIELD(radiosity.solving.link_error),
            "A link may be wrong by this share of the mean light.", Above{0}, Needs{"solver=hierarchical"},
            Excludes{"solution"}),
        row("solution", "Radiosity", "FILE", FIELD(radiosity.solution),
            "The picture shows this file, which pertev solve radiosity wrote.", Otherwise{"the scene is solved first"},
            Mark::Name, Mark::OpensScene),
        row("flat_patches", "Radiosity", "", FIELD(radiosity.flat_patches),
            "Each patch is evenly lit, as it was solved."),
    };
    for (Setting& row : rows) {
        const bool is_of_radiosity = row.integrators == 0, is_shown = row.is_name || is_switch(row);
        row.verbs = kLooking | (is_of_radiosity && !is_shown ? uint32_t(kSolve) : 0);
        if (is_of_radiosity) row.integrators = kRadiosity;
    }
    return rows;
}

std::vector<Setting> frame_settings() {
    std::vector<Setting> rows = {
        row("no_reconstruction", "Frames", "", FIELD(reconstruction.none), "Frames show their samples as they are."),
        row(
            "no_firefly_clamping", "Frames", "",
            [](PictureOptions& o) -> SettingField { return InverseSwitch{&o.reconstruction.settings.clamp_fireflies}; },
            "Samples far brighter than their neighbours are not clamped.", OldName{"no_firefly_limit"}),
        row(
            "no_history_clamping", "Frames", "",
            [](PictureOptions& o) -> SettingField { return InverseSwitch{&o.reconstruction.settings.clamp_history}; },
            "Long means are not clamped to those of recent frames where these disagree.", OldName{"no_history_limit"}),
        row(
            "no_temporal_gradients", "Frames", "",
            [](PictureOptions& o) -> SettingField { return InverseSwitch{&o.reconstruction.settings.follow_light}; },
            "Where the scene moves, means over frames do not follow changes of light.", OldName{"no_follow_light"}),
        row(
            "no_anti_alias", "Frames", "",
            [](PictureOptions& o) -> SettingField { return InverseSwitch{&o.reconstruction.settings.anti_alias}; },
            "Edges are not anti-aliased by a mean over the pictures shown before."),
        row("history", "Frames", "N", FIELD(reconstruction.settings.history),
            "A mean over frames takes in at most this many.", Range{1, 1024}),
        row("passes", "Frames", "N", FIELD(reconstruction.settings.passes), "The wavelet filter has this many passes.",
            Range{0, 8}),
        row("restir", "Frames", "NAME", FIELD(reconstruction.sharing.light),
            "Pixels share light: di what lights send to the first surface, gi what its surroundings send there, too. "
            "It helps where there are many lamps, and takes time."),
        row("restir_history", "Frames", "N", FIELD(reconstruction.sharing.history),
            "Reservoirs of earlier frames count as at most this many samples. Fewer follow moving light and shadows "
            "sooner, with more noise.",
            Range{0, 1024}),
        row("resolution_scale", "Frames", "X", FIELD(reconstruction.settings.resolution_scale),
            "Light is found at a lower resolution, by this factor of each side, which is faster. Edges and textures "
            "stay.",
            Range{0.1, 1}),
    };
    for (Setting& row : rows) {
        row.verbs = kRender | kView | kBenchFrames | kBenchSequence;
        row.needs = "real_time";
    }
    rows.insert(rows.begin(),
                row("real_time", "Frames", "", FIELD(real_time),
                    "Frames are made as pertev view shows them while it moves: of one sample a pixel each, "
                    "reconstructed with the frames before. The settings below are of such frames alone.",
                    Needs{"frames turntable"},
                    Excludes{"denoise=svgf transparent shutter lpe false_color=illuminance aov=motion"}));
    return rows;
}

} // namespace pertev
