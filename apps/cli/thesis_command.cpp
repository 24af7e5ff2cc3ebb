#include "apps/cli/thesis_command.h"

#include <filesystem>
#include <functional>
#include <optional>

#include <fmt/format.h>

#include "apps/cli/bench_parts.h"
#include "apps/cli/flag_phrases.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/lab_files.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "image/auto_exposure.h"
#include "image/tone_map_image.h"
#include "image/write_png.h"
#include "lab/describe_camera.h"
#include "lab/lab_tables.h"
#include "lab/thesis.h"
#include "session/opening/choose_camera.h"
#include "session/session.h"
#include "session/survey/default_light.h"

namespace pertev {
namespace {

constexpr uint32_t kPictureSamples = 32, kPictureSamplesCuda = 512;

/// Returns the file, if PERTEV_SCENES has it.
std::optional<std::string> find_sibenik() {
    const std::filesystem::path root = public_scenes_folder(), path = root / "sibenik/sibenik.obj";
    std::error_code none;
    return !root.empty() && std::filesystem::exists(path, none) ? std::optional(path.string()) : std::nullopt;
}
constexpr const char* kLacksSibenik =
    "tables 6.4 and 6.5, figure 6.8, and Sibenik in table 6.6 and figures 6.9 to 6.11: sibenik.obj was not found; "
    "name it as SCENE, or set PERTEV_SCENES to the folder with sibenik/sibenik.obj (docs/scenes.md)";

struct MeasuredScene {
    std::string name;
    Scene scene;
    bool default_light = false; // the file has no light
    Camera camera;
};

/// Reads a scene. Light is added only if pictures are made.
MeasuredScene load(SceneOptions options, const std::string& scene, const LabSettings& settings, bool has_pictures,
                   Sink& sink) {
    options.scene = scene;
    MeasuredScene thesis = {lab_scene_title(scene), read_lab_scene(options, sink), false, {}};
    if (has_pictures)
        thesis.default_light = add_default_light(thesis.scene, SceneUse::Benchmark, sink) != DefaultLight::None;
    thesis.camera = choose_camera(options.camera, thesis.scene, aspect_of(settings.width, settings.height), sink);
    return thesis;
}

RenderResult render(Session& session, PathLight light) {
    RenderSettings settings = session.settings();
    settings.path.light = light;
    session.set_settings(settings);
    session.render(settings.samples, InterruptSink());
    return session.result();
}

/// Adds pictures of local and global illumination at one exposure, so that they can be compared.
void add_pictures(Queue& queue, const MeasuredScene& scene, const LabSettings& settings, Sink& sink, int figure,
                  ThesisReport& thesis) {
    const PreparedScene prepared = prepare_scene(scene.scene, {}, sink);
    RenderSettings picture;
    picture.width = settings.width, picture.height = settings.height;
    picture.samples = queue.is_cuda() ? kPictureSamplesCuda : kPictureSamples;
    picture.path.max_depth = static_cast<uint32_t>(settings.depth);
    Session session(queue, prepared, scene.camera, picture);
    const RenderResult local = render(session, PathLight::Direct);
    const RenderResult global = render(session, PathLight::Path);
    const float stops = scene.default_light ? auto_exposure_stops(global.picture, ToneMap::Srgb) : 0;
    for (const auto& [light, result] : {std::pair("local", &local), std::pair("global", &global)}) {
        thesis.local_and_global.push_back(
            {.group = fmt::format("Figure 6.{}: local and global illumination", figure),
             .title = light,
             .caption = fmt::format("{}, {}, {} samples per pixel{}", scene.name, light, result->samples,
                                    interrupted() ? " (interrupted)" : ""),
             .image = tone_map_image(result->picture, ToneMap::Srgb, stops),
             .file = fmt::format("figure-6.{}-{}.png", figure, light)});
    }
}

/// Makes the parts of the report one by one. An error in one is noted in the report and does not prevent the others.
class Attempts {
public:
    explicit Attempts(ThesisReport& thesis) : thesis_(thesis) {}

    template <class Make>
    void attempt(const std::string& what, const Make& make) {
        try {
            make();
        } catch (const Error& error) {
            if (error.code() == ErrorCode::Interrupted) return;
            thesis_.lacking.push_back(fmt::format("{}: {}", what, phrase(error.remark())));
            if (!first_ || error.code() == ErrorCode::DeviceFault) first_ = error;
        }
    }

    /// Returns false after Ctrl-C or if the device is lost.
    bool may_go_on() const { return !interrupted() && !(first_ && first_->code() == ErrorCode::DeviceFault); }
    void throw_first() const {
        if (first_) throw Error(*first_);
    }

private:
    ThesisReport& thesis_;
    std::optional<Error> first_;
};

void write_file(const std::filesystem::path& folder, const ThesisPicture& picture) {
    if (picture.svg.empty()) {
        write_png(folder / picture.file(), picture.image);
    } else {
        write_text(folder / picture.file(), picture.svg);
    }
}

/// Adds the pictures of chapters 2 to 4. Each is written once it is made.
void add_pictures_by_chapter(Queue& queue, const LabSettings& settings, const std::filesystem::path& folder,
                             Reporter& reporter, Attempts& attempts, ThesisReport& thesis) {
    RenderSettings picture;
    picture.width = settings.width, picture.height = settings.height;
    picture.samples = queue.is_cuda() ? kPictureSamplesCuda : kPictureSamples;
    ThesisPictures pictures(queue, picture);
    const std::vector<std::string> names = thesis_picture_names();
    const Stopwatch watch;
    for (std::size_t i = 0; i < names.size() && attempts.may_go_on(); ++i) {
        attempts.attempt(names[i], [&] {
            ProgressSink part(
                [&](const Progress& now) {
                    const double all = (static_cast<double>(i) + now.share) / static_cast<double>(names.size());
                    return reporter.goes_on({.doing = fmt::format("{}: {}", names[i], now.doing),
                                             .share = all,
                                             .seconds = watch.seconds(),
                                             .share_of_step = now.share});
                },
                reporter);
            ThesisPicture made = pictures.make(names[i], part);
            if (!made.command.empty()) made.command = "pertev render " + phrase(made.command);
            write_file(folder, made);
            thesis.pictures.push_back(std::move(made));
        });
    }
    reporter.end_progress();
}

/// Writes everything but the pictures by chapter, which are written already.
void write_files(const std::filesystem::path& folder, const ThesisReport& thesis, const Measurement& head) {
    for (std::size_t i = 0; i < thesis.scenes.size(); ++i) {
        // Numbered, because names of scenes may be equal, or too long for a file.
        write_text(folder / fmt::format("thesis-{}.csv", i + 1),
                   csv_of(measurement_of(thesis.scenes[i], head), "runs"));
    }
    for (const ResultPicture& picture : thesis.local_and_global) write_png(folder / picture.file, picture.image);
    write_measurement(folder, "thesis", measurement_of(thesis, head), "frames");
}

} // namespace

int run_thesis(Queue& queue, const SceneOptions& options, LabSettings settings, const std::string& output,
               Reporter& reporter) {
    for (const ThesisVariant& v : thesis_variants(queue.is_cuda())) settings.only.push_back(v.combination);
    settings.primary = settings.diffuse = true;
    settings.shadow = settings.heat_maps = false;
    const bool has_pictures = !output.empty();
    const Measurement head = start_measurement(queue, "");
    ThesisReport thesis;
    Attempts attempts(thesis);
    // All are read before the first is measured. The camera's flags are the second's.
    std::vector<MeasuredScene> scenes = {load({}, "cornell-box", settings, has_pictures, reporter)};
    if (const auto second = options.scene.empty() ? find_sibenik() : std::optional(options.scene)) {
        scenes.push_back(load(options, *second, settings, has_pictures, reporter));
    } else {
        thesis.lacking.emplace_back(kLacksSibenik);
        reporter.warn(fmt::format("left out: {}", kLacksSibenik));
    }
    if (has_pictures) check_lab_folder(output);
    reporter.report_messages();
    listen_for_interrupt();
    for (const MeasuredScene& scene : scenes) {
        if (!attempts.may_go_on()) break;
        settings.scene = scene.name;
        settings.camera = phrase(describe_camera(scene.camera, scene.scene.origin_in_file));
        reporter.print(fmt::format("{}: {}x{}, depths {} to {}", scene.name, settings.width, settings.height,
                                   settings.first_depth, settings.depth));
        attempts.attempt(scene.name, [&] {
            LabReport report = run_lab(queue, scene.scene, scene.camera, settings, reporter);
            reporter.end_progress();
            reporter.event(json_of(measurement_of(report, head), "lab"));
            if (has_findings(report)) thesis.scenes.push_back(std::move(report));
        });
        reporter.end_progress();
        if (thesis.scenes.empty()) attempts.throw_first();
        if (thesis.scenes.empty() || !has_pictures) continue;
        reporter.set_work(fmt::format("{}: rendering pictures", scene.name));
        if (attempts.may_go_on()) {
            const int figure = &scene == scenes.data() ? 7 : 8;
            attempts.attempt("pictures of " + scene.name,
                             [&] { add_pictures(queue, scene, settings, reporter, figure, thesis); });
        }
        write_files(output, thesis, head);
    }
    if (has_pictures && attempts.may_go_on()) {
        add_pictures_by_chapter(queue, settings, output, reporter, attempts, thesis);
        write_files(output, thesis, head);
    }
    const bool cut_short = interrupted();
    Measurement made = measurement_of(thesis, head);
    made.interrupted = cut_short;
    reporter.event(json_of(made, "thesis"));
    if (thesis.scenes.empty()) { // only an interrupt comes so early
        reporter.print("interrupted before the first measurement; nothing is written");
        return exit_status(ErrorCode::Interrupted);
    }
    reporter.answer(text_of(thesis));
    if (has_pictures) {
        reporter.print(fmt::format("written: {}", (std::filesystem::path(output) / "thesis.html").string()));
    }
    for (const LabReport& report : thesis.scenes) fail_if_wrong(report);
    attempts.throw_first();
    return cut_short ? exit_status(ErrorCode::Interrupted) : 0;
}

} // namespace pertev
