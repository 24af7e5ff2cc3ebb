// Settings of pictures by any integrator: what is rendered, how, and how it is shown.

#include "base/limits.h"
#include "image/image_format.h"
#include "render/film_channels.h"
#include "settings/setting_table.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

#define FIELD PERTEV_SETTING_FIELD

/// Returns the field of the integrator's name, which sets two fields.
SettingField integrator_field(PictureOptions& options) {
    return NamedField{
        &options.render, [](const void* f) { return integrator_name(*static_cast<const RenderSettings*>(f)); },
        [](void* f, std::string_view name) { return set_integrator(*static_cast<RenderSettings*>(f), name); },
        [] { return integrator_names(); }};
}

/// Returns the names of all layers besides those of light.
std::vector<std::string> layer_names() {
    std::vector<std::string> names = aov_names();
    for (std::string& name : sample_layer_names()) names.push_back(std::move(name));
    return names;
}

} // namespace

std::vector<Setting> picture_settings() {
    constexpr uint32_t kShown = kRender | kView,
                       kMachines = kLooking | kMeasure | kLab | kBenchPictures | kBenchBuild | kBenchRays;
    constexpr uint32_t kExr = bit_of(ImageFormat::Exr), kPng = bit_of(ImageFormat::Png),
                       kToned = kPng | bit_of(ImageFormat::Jpeg);
    constexpr uint32_t kTracing = kShown | kBenchPictures | kBenchRays;
    return {
        row("size", "Picture", "WIDTHxHEIGHT", FIELD(size), "The width and height of the picture in pixels.",
            Otherwise{"1280x720, or the shape of the scene's camera"}, On{kLooking | kLab | kBenchPictures},
            Mark::Common, Changes::Picture),
        row("crop", "Picture", "X,Y,W,H", FIELD(crop),
            "The part that is rendered, with the whole picture's bytes: left column, upper row, width and height.",
            Counts{{4}}, Unit{"pixels"}, Otherwise{"all"}, Excludes{"rows denoise!=none real_time"}, Recorded::AsUsed,
            Mark::AfterRecords, Changes::Picture),
        row("tone_map", "Picture", "NAME", FIELD(tone_map), "The tone mapping of PNG and JPEG output.",
            Otherwise{name_of(ToneMap::Agx).data()}, On{kShown | kMerge}, In{kToned}, Mark::Common, Recorded::AsUsed,
            Panel{"Tone map", PanelGroup::Picture}, Changes::Display),
        row("lut", "Picture", "FILE", FIELD(lut),
            "A look-up table (.cube: 3D, curves, or both) for PNG and JPEG output.", On{kRender | kMerge}, In{kToned},
            Mark::Name, HoldsFile::Whole, Recorded::AsUsed, Changes::Display),
        row("lut_input", "Picture", "NAME", FIELD(lut_input),
            "The table follows the tone map (display), or replaces it (light).", On{kRender | kMerge}, Needs{"lut"},
            Recorded::Changed, Changes::Display),
        row("exposure", "Picture", "STOPS|auto", FIELD(exposure),
            "The exposure of PNG and JPEG output in stops. auto meters a small preview.", Unit{"stops"},
            Otherwise{"auto"}, On{kShown | kMerge}, In{kToned}, Excludes{"f_number"}, Mark::Common, Changes::Display),
        row("f_number", "Picture", "N", FIELD(f_number),
            "The f-number of a physical exposure of PNG and JPEG output (aperture sets the depth of field).",
            Above{0, 1e4}, On{kShown}, In{kToned}, Needs{"shutter_time"}, Changes::Display),
        row("shutter_time", "Picture", "SECONDS", FIELD(shutter_s), "The shutter time of a physical exposure.",
            Above{0, 1e6}, Unit{"s"}, On{kShown}, Needs{"f_number"}, Changes::Display),
        row("iso", "Picture", "S", FIELD(iso), "The film speed of a physical exposure.", Above{0, 1e8},
            Otherwise{"100"}, On{kShown}, Needs{"f_number"}, Changes::Display),
        row("exr_colors", "Picture", "NAME", FIELD(exr_colors),
            "The number format of colours in EXR output; other layers keep 32 bits.", On{kRender | kMerge}, In{kExr},
            Mark::NotKept, Changes::Picture),
        row("png_bits", "Picture", "8|16", FIELD(png_bits), "The bits of each channel of PNG output.",
            Choices{{"8", "16"}}, On{kRender | kMerge}, In{kPng}, Mark::NotKept, Changes::Picture),
        row("output_format", "Picture", "NAME", FIELD(output_format),
            "The format of output to the standard output (-).", Choices{{"exr", "hdr", "jpg", "png"}},
            On{kRender | kMerge}, Mark::NotKept, Changes::Picture),
        row("transparent", "Picture", "", FIELD(render.transparent),
            "The background is transparent; alpha is the covered part of a pixel.", In{kExr | kPng},
            Excludes{"ground=on"}, Mark::OpensScene, Changes::Picture),
        row("aov", "Picture", "NAME,...", FIELD(aovs), "Additional layers of EXR output.", Choices{layer_names()},
            In{kExr}, Mark::Common, Mark::AfterRecords, Changes::Picture),
        row("layers_at", "Picture", "WHERE", FIELD(render.layers_at),
            "Where layers of aov are evaluated: at the samples, whose values are blended, or at the centres of pixels.",
            In{kExr}, Needs{"aov"}, Excludes{"centre:aov=uv centre:aov=crypto_object centre:aov=crypto_material"},
            Mark::AfterRecords, Recorded::Changed, Changes::Picture),
        row("false_color", "Picture", "NAME", FIELD(false_color),
            "The quantity that PNG and JPEG show in false colours: luminance in cd/m2, or illuminance of visible "
            "surfaces in lx, of which EXR and HDR hold irradiance in W/m2.",
            Choices{{"luminance", "illuminance"}}, Of{integrators_that(has_light_path_layers), "illuminance"},
            Excludes{"exposure tone_map f_number lut transparent illuminance:denoise!=none"}, Mark::AfterRecords,
            Recorded::AsUsed, Changes::Picture),
        row("false_color_range", "Picture", "A,B", FIELD(false_color_range), "The ends of the false-color scale.",
            Otherwise{"the picture's own range"}, Needs{"false_color"}, Mark::AfterRecords, Changes::Picture),
        row("lpe", "Picture", "NAME=EXPRESSION", FIELD(lpe),
            "An EXR layer with the light of paths that match an expression from the light to the eye: LD+E, caustics "
            "LS+DE, or L<'lamp'>.*E. It may be given again (docs/transport.md).",
            Of{integrators_that(has_light_path_layers)}, Excludes{"denoise!=none"}, In{kExr}, Recorded::AsUsed,
            Changes::Picture),
        row("light_group", "Picture", "NAME=LIGHTS", FIELD(light_groups),
            "An EXR layer of lights by name, as in key=window,lamp*, sky=environment or rest=^window,lamp*. It may be "
            "given "
            "again.",
            Of{integrators_that(has_light_path_layers)}, Excludes{"denoise!=none"}, In{kExr}, Recorded::AsUsed,
            Changes::Picture),

        row("spp", "Quality", "N", FIELD(render.samples),
            "The number of samples per pixel; four times as many halve the noise.", Range{1, kMaxSamplesPerPixel},
            On{kShown | kMeasure | kBenchNoise | kBenchCameras | kBenchPictures}, Mark::Common,
            Panel{"Samples per pixel", PanelGroup::Light}, Mark::AfterRecords, Changes::Picture),
        row("integrator", "Quality", "NAME", integrator_field, "The light transport algorithm (docs/transport.md).",
            More{"path finds all light, direct and indirect a part each. hybrid is path with rasterised primary "
                 "visibility. cast, whitted and distributed are ray trees without most indirect light. raster and "
                 "reyes (micropolygons) trace no rays. light traces particles and misses what mirrors and glass show. "
                 "bidirectional connects camera and light subpaths. photon_map finds caustics early. irradiance_cache "
                 "interpolates, with a small bias. radiosity solves diffuse light once."},
            On{kLooking}, Recorded::Always, Mark::Common, Panel{"Integrator", PanelGroup::Light}, Changes::Picture),
        row("max_depth", "Quality", "N", FIELD(render.path.max_depth),
            "The maximum number of scatterings between light and camera: 0 is emission, 1 adds direct light.",
            Range{0, kMaxPathDepth - 1}, On{kLooking | kMeasure | kLab}, Recorded::Always, Mark::Common,
            Panel{"Max depth", PanelGroup::Light}, Changes::Picture),
        row("seed", "Quality", "N", FIELD(render.path.seed), "The seed of the random number generator.",
            Range{0, UINT32_MAX}, On{kScenes | kLab | kBenchRender}, Recorded::Always, Changes::Picture),
        row("sampler", "Quality", "NAME", FIELD(render.path.sampler), "The sample sequence.", On{kShown},
            Recorded::Always, Changes::Picture),
        row("filter", "Quality", "NAME", FIELD(render.filter), "The pixel reconstruction filter.", On{kLooking},
            Recorded::Always, Changes::Picture),
        row("filter_radius", "Quality", "PIXELS", FIELD(render.filter_radius), "The radius of the pixel filter.",
            Above{0, 64}, Unit{"pixels"}, Otherwise{"the filter's own"}, On{kLooking}, Recorded::AsUsed,
            Changes::Picture),
        row("clamp", "Quality", "X", FIELD(render.path.clamp),
            "The largest contribution of one path that scatters twice or more. Clamping is biased.", Above{0},
            Otherwise{"off"}, On{kShown}, Recorded::Always, Changes::Picture),
        row("mip_maps", "Quality", "NAME", FIELD(render.path.mip_maps),
            "The pictures whose textures are filtered by mip-maps: real-time frames, all (on) or none.",
            Of{integrators_that(makes_frames)}, On{kLooking}, Recorded::Changed, Changes::Picture),
        row("light_choice", "Quality", "NAME", FIELD(render.path.light_choice),
            "The choice of a light at each point: by a tree, by power, or by the tree for more than 256 lights (auto). "
            "Particle emission always selects by power.",
            Of{integrators_that(selects_lights)}, On{kLooking | kBenchRender}, Recorded::Changed, Changes::Picture),
        row("light_sampling", "Quality", "NAME", FIELD(render.path.strategy),
            "How paths find light: by sampling a light at each vertex (nee), by rays that hit one (bsdf; no point, "
            "spot and directional lights), or by both with MIS weights.",
            Of{integrators_that(makes_frames)}, Excludes{"!mis:restir!=off"}, On{kLooking | kBenchRender},
            Recorded::Changed, Changes::Picture),
        row("time_limit", "Quality", "SECONDS", FIELD(render.time_limit_s),
            "The time after which the render stops, at the end of a sample. irradiance_cache may stop while it makes "
            "records.",
            Above{0}, Unit{"s"}, Otherwise{"none"}, Excludes{"frames turntable cameras stereo"}, Mark::NotKept,
            Mark::Common, Changes::Picture),
        row("denoise", "Quality", "NAME", FIELD(render.denoise),
            "The denoiser of pictures with few samples, which is biased. EXR output keeps the picture before "
            "denoising as the layer noisy. Bytes of oidn (Open Image Denoise) differ between devices.",
            On{kRender | kBenchSequence | kMerge}, Of{integrators_that(makes_frames), "!none"},
            Excludes{"!none:max_depth=0 !none:aov=variance !none:aov=distance"}, Recorded::Changed, Mark::Common,
            Changes::Picture),

        row("rows", "Parts", "A:B", FIELD(rows),
            "The rows of pixels from number A, where the top one is 0, to before B.",
            Excludes{"integrator=light integrator=bidirectional time_limit frames turntable cameras stereo"},
            Mark::NotKept, Changes::Picture),
        row("samples", "Parts", "A:B", FIELD(samples),
            "The samples of each pixel from number A, where the first is 0, to before B.",
            Excludes{"spp part time_limit frames turntable cameras stereo"}, Mark::NotKept, Changes::Picture),
        row("part", "Parts", "I/N", FIELD(part),
            "Part I of N parts of the samples, whose film files (.pvf) are merged, or of the frames.",
            Excludes{"time_limit"}, Mark::NotKept, Changes::Picture),
        row("part_base", "Parts", "B", FIELD(part_base), "The number of the first part.", Range{0, 1u << 31},
            Needs{"part"}, Mark::NotKept, Changes::Picture),
        row("checkpoint", "Parts", "FILE", FIELD(checkpoint),
            "A film file (.pvf) of the samples so far, from which the render goes on; or the history of frames, for "
            "continue.",
            Mark::NotKept, Changes::Picture),
        row("checkpoint_every", "Parts", "SECONDS", FIELD(checkpoint_every_s),
            "The time between two writings of the checkpoint.", Above{0}, Unit{"s"}, Needs{"checkpoint"}, Mark::NotKept,
            Changes::Picture),

        row("records", "Parts", "FILE", FIELD(radiosity.records),
            "A file by which parts share irradiance records or the radiosity solution: read if it is there, else "
            "written.",
            Excludes{"solution frames turntable cameras stereo"}, Mark::NotKept, Changes::Picture),

        row("build", "Tracing", "WHICH", FIELD(tracer.build),
            "The quality of the acceleration structure: fast builds fastest, best traces fastest. "
            "No setting of this group changes the picture.",
            Otherwise{"balanced"}, Choices{names_of<TreeBuild>()}, On{kTracing}, Mark::NotKept),
        row("structure", "Tracing", "[KIND=]NAME", FIELD(tracer.structures),
            "The acceleration structure, which overrules build.", More{"KIND is camera, bounce or shadow."},
            Choices{names_of<StructureKind>()}, On{kTracing}, Mark::ByRay, Mark::NotKept,
            Panel{"Structure", PanelGroup::Rays}),
        row("traversal", "Tracing", "[KIND=]NAME", FIELD(tracer.traversals), "The traversal algorithm.",
            Choices{names_of<TraversalKind>()}, On{kTracing}, Mark::ByRay, Mark::NotKept, OldName{"walk"},
            Panel{"Traversal", PanelGroup::Rays}),
        row("rta", "Tracing", "[KIND=]WHICH", FIELD(tracer.rta),
            "Redundant traversal avoidance: rays skip nodes behind the nearest hit.", Choices{{"on", "nodes", "off"}},
            On{kTracing}, Mark::ByRay, Mark::NotKept, Panel{"Redundant traversal avoidance", PanelGroup::Rays}),
        row("order", "Tracing", "[KIND=]WHICH", FIELD(tracer.order), "Traversal of nearer children first.",
            Choices{{"on", "off"}}, On{kTracing}, Mark::ByRay, Mark::NotKept),
        row("distribution", "Tracing", "[KIND=]NAME", FIELD(tracer.distributions),
            "The assignment of rays to GPU threads.", Choices{names_of<Distribution>()}, On{kTracing}, Mark::ByRay,
            Mark::NotKept),

        row("device", "Machine", "NAME", FIELD(machine.device),
            "The device that renders: auto, cpu, cuda, cuda:N, or a GPU's UUID. The picture is the same on all.",
            More{"cuda:all, or several of these with commas (cuda:0,2), render together."}, On{kMachines},
            Mark::NotKept, Mark::Common),
        row("threads", "Machine", "N", FIELD(machine.threads), "The number of CPU threads.", Range{1, 4096},
            Otherwise{"all"}, On{kMachines | kSolve}, Mark::NotKept),
        row("no_bvh_cache", "Machine", "", FIELD(no_cache),
            "The acceleration structure is built, even if it is in the cache.", On{kShown | kMeasure | kSolve},
            Mark::NotKept, Changes::Picture),
        row("max_memory", "Machine", "MIB", FIELD(radiosity.max_memory),
            "The most memory: of the device for a picture, of the machine for solving radiosity. Larger tasks are "
            "refused.",
            Above{0}, Unit{"MiB"}, Otherwise{"all there is"}, On{kLooking | kSolve}, Mark::NotKept, Changes::Picture),
        row("strict", "Machine", "", FIELD(strict),
            "The verb fails before its work if a part of the scene is left out or a settings file has an unknown "
            "entry, and after writing if a sample is not finite.",
            On{kScenes | kLab | kConvert}, Mark::NotKept, Mark::Common),
    };
}

} // namespace pertev
