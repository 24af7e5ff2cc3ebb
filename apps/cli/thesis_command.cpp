#include "apps/cli/thesis_command.h"

#include <array>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <set>
#include <span>

#include <fmt/format.h>

#include "apps/cli/interrupt.h"
#include "apps/cli/lab_files.h"
#include "apps/cli/lab_scene.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "image/auto_exposure.h"
#include "image/tone_map_image.h"
#include "image/write_png.h"
#include "lab/thesis.h"
#include "lab/write_tables.h"
#include "lab/write_thesis_pictures.h"
#include "session/session.h"
#include "session/survey/default_light.h"

namespace pertev {
namespace {

constexpr std::size_t kThesisScenes = 2;
constexpr uint32_t kPictureSamples = 32, kPictureSamplesCuda = 512;

std::string sibenik() {
    const char* root = std::getenv("PERTEV_SCENES");
    const std::filesystem::path path = std::filesystem::path(root != nullptr ? root : "") / "sibenik/sibenik.obj";
    if (root == nullptr || !std::filesystem::exists(path)) {
        throw Error(ErrorCode::BadInput, "lab --thesis: name sibenik.obj as SCENE, or set PERTEV_SCENES to the folder "
                                         "that holds sibenik/sibenik.obj (docs/scenes.md)");
    }
    return path.string();
}

struct MeasuredScene {
    std::string name;
    Scene scene;
    bool default_light = false; // it brought none of its own
    Camera camera;
};

/// Light is for pictures alone.
MeasuredScene load(SceneOptions options, const std::string& scene, const LabSettings& settings, bool has_pictures,
                   Messages& messages) {
    options.scene = scene;
    MeasuredScene thesis = {lab_scene_title(scene), read_lab_scene(options, messages), false, {}};
    if (has_pictures) thesis.default_light = add_default_light(thesis.scene, messages) != DefaultLight::None;
    thesis.camera = choose_camera(options, thesis.scene, aspect_of(settings.width, settings.height), messages);
    return thesis;
}

RenderResult render(Session& session, PathLight light) {
    RenderSettings settings = session.settings();
    settings.path.light = light;
    session.set_settings(settings);
    session.render(settings.samples, [](const RenderProgress&) { return !interrupted(); });
    return session.result();
}

/// Local and global illumination, at one exposure: they are compared.
void add_pictures(Queue& queue, const MeasuredScene& scene, const LabSettings& settings, Messages& messages,
                  ThesisReport& thesis) {
    const PreparedScene prepared = prepare_scene(scene.scene, {}, messages);
    RenderSettings picture;
    picture.width = settings.width, picture.height = settings.height;
    picture.samples = queue.is_cuda() ? kPictureSamplesCuda : kPictureSamples;
    picture.path.max_depth = static_cast<uint32_t>(settings.depth);
    Session session(queue, prepared, scene.camera, picture);
    const RenderResult local = render(session, PathLight::Direct);
    const RenderResult global = render(session, PathLight::Path);
    const float stops = scene.default_light ? auto_exposure_stops(global.picture, ToneMap::Srgb) : 0;
    const auto caption = [&](const char* light, const RenderResult& result) {
        return fmt::format("{}, {}, {} samples a pixel{}", scene.name, light, result.samples,
                           interrupted() ? " (interrupted)" : "");
    };
    thesis.local.push_back({caption("local", local), tone_map_image(local.picture, ToneMap::Srgb, stops)});
    thesis.global.push_back({caption("global", global), tone_map_image(global.picture, ToneMap::Srgb, stops)});
}

/// Those of chapters 2 to 4, as far as nothing interrupts.
void add_pictures_by_chapter(Queue& queue, const LabSettings& settings, Reporter& reporter, ThesisReport& thesis) {
    RenderSettings picture;
    picture.width = settings.width, picture.height = settings.height;
    picture.samples = queue.is_cuda() ? kPictureSamplesCuda : kPictureSamples;
    ThesisPictures pictures(queue, picture);
    const std::vector<std::string> names = thesis_picture_names();
    const std::function<bool(const LabProgress&)> show = show_lab_progress(reporter, {});
    const Stopwatch watch;
    try {
        for (std::size_t i = 0; i < names.size() && !interrupted(); ++i) {
            thesis.pictures.push_back(pictures.make(names[i], [&](const char* doing, double share) {
                const double all = (static_cast<double>(i) + share) / static_cast<double>(names.size());
                return show({all, fmt::format("{}: {}", names[i], doing), share, watch.seconds(), nullptr, nullptr});
            }));
        }
    } catch (const Error& error) {
        if (error.code() != ErrorCode::Interrupted) throw;
    }
    reporter.end_progress();
}

/// Files of an earlier run that this one does not have are removed.
void write_files(const std::filesystem::path& folder, const ThesisReport& thesis) {
    std::set<std::string> stale;
    const auto text_file = [&](const std::string& name, const std::string& text) {
        if (text.empty()) {
            stale.insert(name);
        } else {
            write_text(folder / name, text);
        }
    };
    const auto picture_file = [&](const std::string& name, const std::vector<Picture>& pictures, std::size_t i) {
        if (i < pictures.size()) {
            write_png(folder / name, pictures[i].image);
        } else {
            stale.insert(name);
        }
    };
    text_file("thesis.html", html_of(thesis));
    for (const ThesisFigure& figure : figures_of(thesis)) {
        text_file(fmt::format("figure-{}.svg", figure.number), figure.svg);
    }
    for (const std::string& file : thesis_picture_files()) stale.insert(file);
    for (const ThesisPicture& picture : thesis.pictures) {
        stale.erase(picture.file());
        if (picture.svg.empty()) {
            write_png(folder / picture.file(), picture.image);
        } else {
            write_text(folder / picture.file(), picture.svg);
        }
    }
    text_file("thesis-pictures.csv", thesis.pictures.empty() ? "" : csv_of(std::span(thesis.pictures)));
    text_file("thesis-pictures.json", thesis.pictures.empty() ? "" : json_of(std::span(thesis.pictures)) + '\n');
    for (std::size_t i = 0; i < kThesisScenes; ++i) {
        picture_file(fmt::format("figure-6.{}-local.png", 7 + i), thesis.local, i);
        picture_file(fmt::format("figure-6.{}-global.png", 7 + i), thesis.global, i);
        // Numbered: names of scenes may be equal, or too long for a file's.
        const bool is_there = i < thesis.scenes.size();
        text_file(fmt::format("thesis-{}.csv", i + 1), is_there ? csv_of(thesis.scenes[i]) : "");
        text_file(fmt::format("thesis-{}.json", i + 1), is_there ? json_of(thesis.scenes[i]) + '\n' : "");
    }
    remove_files(folder, stale);
}

} // namespace

int run_thesis(Queue& queue, const SceneOptions& options, LabSettings settings, const std::string& output,
               Reporter& reporter) {
    for (const ThesisVariant& v : thesis_variants(queue.is_cuda())) settings.only.push_back(v.combination);
    settings.primary = settings.diffuse = true;
    settings.shadow = settings.heat_maps = false;
    // Both are read before the first is measured. The camera's flags are the second's.
    const std::array<MeasuredScene, kThesisScenes> scenes = {
        load({}, "cornell-box", settings, !output.empty(), reporter.messages()),
        load(options, options.scene.empty() ? sibenik() : options.scene, settings, !output.empty(),
             reporter.messages())};
    if (!output.empty()) check_lab_folder(output);
    reporter.say_messages();
    ThesisReport thesis;
    listen_for_interrupt();
    for (const MeasuredScene& scene : scenes) {
        settings.scene = scene.name;
        reporter.say(fmt::format("{}: {}x{}, depths {} to {}", scene.name, settings.width, settings.height,
                                 settings.first_depth, settings.depth));
        LabReport report = run_lab(queue, scene.scene, scene.camera, settings, show_lab_progress(reporter, {}));
        reporter.end_progress();
        reporter.event(json_of(report));
        if (has_findings(report)) {
            thesis.scenes.push_back(std::move(report));
            if (!output.empty()) {
                reporter.set_work(fmt::format("{}: rendering pictures", scene.name));
                if (!interrupted()) add_pictures(queue, scene, settings, reporter.messages(), thesis);
                write_files(output, thesis);
            }
        }
        if (interrupted()) break;
    }
    if (!interrupted() && !output.empty()) {
        add_pictures_by_chapter(queue, settings, reporter, thesis);
        write_files(output, thesis);
    }
    const bool cut_short = interrupted();
    reporter.event(fmt::format(R"({{"event":"thesis","scenes":{},"pictures":{},"interrupted":{}}})",
                               thesis.scenes.size(), json_of(std::span(thesis.pictures)), cut_short));
    if (thesis.scenes.empty()) { // only an interrupt comes so early
        reporter.say("interrupted before anything was measured; nothing is written");
        return exit_status(ErrorCode::Interrupted);
    }
    reporter.answer(text_of(thesis));
    if (!output.empty()) {
        reporter.say(fmt::format("written: {}", (std::filesystem::path(output) / "thesis.html").string()));
    }
    for (const LabReport& report : thesis.scenes) fail_if_wrong(report);
    return cut_short ? exit_status(ErrorCode::Interrupted) : 0;
}

} // namespace pertev
