// Settings of pictures by any integrator: what is rendered, how, and how it is shown.

#include "base/limits.h"
#include "render/film_channels.h"
#include "settings/setting_table.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

#define FIELD PERTEV_SETTING_FIELD

/// The integrator's name sets two fields.
SettingField integrator_field(PictureOptions& options) {
    return NamedField{
        &options.render, [](const void* f) { return integrator_name(*static_cast<const RenderSettings*>(f)); },
        [](void* f, std::string_view name) { return set_integrator(*static_cast<RenderSettings*>(f), name); },
        integrator_names};
}

} // namespace

std::vector<Setting> picture_settings() {
    constexpr uint32_t kShown = kRender | kView,
                       kMachines = kLooking | kMeasure | kLab | kBench | kBenchBuild | kBenchRays;
    constexpr uint32_t kTracing = kShown | kBench | kBenchRays;
    return {
        row("size", "Picture", "WIDTHxHEIGHT", FIELD(size), "The picture has so many pixels.",
            Otherwise{"1280x720, or the shape that the scene's camera asks for"}, On{kLooking}, Mark::Common),
        row("tone_map", "Picture", "NAME", FIELD(tone_map),
            "How light becomes the colours of a screen, in PNG and JPEG.", Otherwise{"agx"}, On{kShown}, Mark::Common),
        row("exposure", "Picture", "STOPS|auto", FIELD(exposure),
            "PNG and JPEG are brighter by so many stops. auto looks at a small picture of its own.", Unit{"stops"},
            Otherwise{"auto"}, On{kShown}, Excludes{"f_number"}, Mark::Common),
        row("f_number", "Picture", "N", FIELD(f_number),
            "PNG and JPEG are exposed as by a lens of this f-number (the aperture gives depth of field).",
            Above{0, 1e4}, On{kShown}, Needs{"shutter_time"}),
        row("shutter_time", "Picture", "SECONDS", FIELD(shutter_s),
            "The shutter of a physical exposure is open for so long.", Above{0, 1e6}, Unit{"s"}, On{kShown},
            Needs{"f_number"}),
        row("iso", "Picture", "S", FIELD(iso), "The film of a physical exposure has this speed.", Above{0, 1e8},
            Otherwise{"100"}, On{kShown}, Needs{"f_number"}),
        row("transparent", "Picture", "", FIELD(render.transparent),
            "The background is left out; alpha says how much of a pixel is covered.", Mark::OpensScene),
        row("aov", "Picture", "NAME,...", FIELD(aovs), "An EXR has these layers beside the picture.",
            Choices{aov_names()}, Mark::Common),
        row("false_color", "Picture", "NAME", FIELD(false_color),
            "PNG and JPEG show numbers and their scale: luminance in cd/m2, or illuminance of what the camera sees in "
            "lx, of which EXR and HDR then hold the irradiance, W/m2.",
            Choices{{"luminance", "illuminance"}}, Excludes{"exposure tone_map f_number transparent"}),
        row("false_color_range", "Picture", "A,B", FIELD(false_color_range), "The ends of that scale.",
            Otherwise{"as fits the picture"}, Needs{"false_color"}),
        row("lpe", "Picture", "NAME=EXPRESSION", FIELD(lpe),
            "A layer of an EXR has the light of some paths alone, from the light to the eye: LD+E, or caustics LS+DE, "
            "or L<'lamp'>.*E. It may be given again (docs/transport.md)."),

        row("spp", "Quality", "N", FIELD(render.samples),
            "Each pixel is the mean of so many samples; four times as many halve the noise.",
            Range{1, kMaxSamplesPerPixel}, On{kShown | kMeasure | kBenchNoise}, Mark::Common),
        row("integrator", "Quality", "NAME", integrator_field, "Which light is found, and how (docs/transport.md).",
            More{"path finds all light; direct finds that of lamps and sky alone, indirect what other surfaces send "
                 "on. hybrid is path, by rasterisation first. cast, whitted and distributed are trees of rays, without "
                 "most of what surfaces send on. raster has no rays at all, nor has reyes, which is made of "
                 "micropolygons. light sends particles from the lights, without what mirrors and glass show. "
                 "bidirectional finds all light, from both ends. photon_map finds all light in the end, and caustics "
                 "soon, by photons. irradiance_cache finds all light, what surfaces send on nearly so, without its "
                 "noise. radiosity divides diffuse surfaces into patches and solves their light once."},
            On{kLooking}, Recorded::Always, Mark::Common),
        row("max_depth", "Quality", "N", FIELD(render.path.max_depth),
            "Light is scattered so often at most on its way to the camera: 0 emission, 1 direct light.",
            Range{0, kMaxPathDepth - 1}, On{kLooking | kMeasure}, Recorded::Always, Mark::Common),
        row("seed", "Quality", "N", FIELD(render.path.seed), "Another seed gives other random numbers.",
            Range{0, UINT32_MAX}, On{kScenes}, Recorded::Always),
        row("sampler", "Quality", "NAME", FIELD(render.path.sampler), "How samples are drawn.", On{kShown},
            Recorded::Always),
        row("filter", "Quality", "NAME", FIELD(render.filter),
            "The filter that samples are weighted by within and around a pixel.", On{kLooking}, Recorded::Always),
        row("filter_radius", "Quality", "PIXELS", FIELD(render.filter_radius), "The filter's radius.", Above{0, 64},
            Unit{"pixels"}, Otherwise{"the filter's own"}, On{kLooking}),
        row("clamp", "Quality", "X", FIELD(render.path.clamp),
            "One contribution of light that is scattered twice or more is this much at most. It is biased.", Above{0},
            Otherwise{"off"}, On{kShown},
            Of{1u << uint32_t(IntegratorKind::Path) | 1u << uint32_t(IntegratorKind::Hybrid)}, Recorded::Always),
        row("time_limit", "Quality", "SECONDS", FIELD(render.time_limit_s),
            "The render stops after this time, at a whole sample. irradiance_cache makes records first, and perhaps "
            "stops before there is a sample.",
            Above{0}, Unit{"s"}, Otherwise{"none"}, Excludes{"frames turntable"}, Mark::NotKept, Mark::Common),
        row("denoise", "Quality", "NAME", FIELD(render.denoise),
            "svgf reconstructs the picture of few samples. It is biased; EXR has the undenoised picture, too, as the "
            "layer noisy.",
            Recorded::Changed, Mark::Common),

        row("build", "Tracing", "WHICH", FIELD(tracer.build),
            "How much time the tree that rays go through is worth: fast is built soonest, best is traversed soonest. "
            "No setting of this group changes the picture.",
            Otherwise{"balanced"}, Choices{names_of<TreeBuild>()}, On{kTracing}, Mark::NotKept),
        row("structure", "Tracing", "[KIND=]NAME", FIELD(tracer.structures),
            "The scene is sorted for rays so, as pertev lab names it, whatever build says. It may be given for one "
            "kind of ray: camera=, bounce= or shadow=NAME.",
            On{kTracing}, Mark::NotKept),
        row("traversal", "Tracing", "[KIND=]NAME", FIELD(tracer.traversals),
            "Rays traverse it by this algorithm, as pertev lab names it.", On{kTracing}, Mark::NotKept,
            OldName{"walk"}),
        row("rta", "Tracing", "[KIND=]WHICH", FIELD(tracer.rta), "Redundant traversal avoidance: on, nodes or off.",
            On{kTracing}, Mark::NotKept),
        row("order", "Tracing", "[KIND=]WHICH", FIELD(tracer.order), "Nearer children are traversed first: on or off.",
            On{kTracing}, Mark::NotKept),
        row("distribution", "Tracing", "[KIND=]NAME", FIELD(tracer.distributions),
            "How rays come to a GPU's threads: one-a-thread, persistent or dynamic-fetch.", On{kTracing},
            Mark::NotKept),

        row("device", "Machine", "NAME", FIELD(machine.device),
            "auto, cpu, cuda or cuda:N renders. The picture is the same.", On{kMachines}, Mark::NotKept, Mark::Common),
        row("threads", "Machine", "N", FIELD(machine.threads), "The CPU works with so many threads.", Range{1, 4096},
            Otherwise{"all"}, On{kMachines | kSolve}, Mark::NotKept),
        row("no_bvh_cache", "Machine", "", FIELD(no_cache), "The tree is built even if it was built before.",
            On{kShown | kMeasure | kSolve}, Mark::NotKept),
        row("max_memory", "Machine", "MIB", FIELD(radiosity.max_memory),
            "What takes more is refused: radiosity of this machine's memory, pertev render of the device's, too.",
            Above{0}, Unit{"MiB"}, Otherwise{"all there is"}, On{kLooking | kSolve}, Mark::NotKept),
        row("strict", "Machine", "", FIELD(strict),
            "The verb fails where anything of the scene is left out. It fails before rendering, where a file of "
            "settings has something that is none, too, and, after writing, where a sample is not finite.",
            On{kScenes | kLab}, Mark::NotKept, Mark::Common),
    };
}

} // namespace pertev
