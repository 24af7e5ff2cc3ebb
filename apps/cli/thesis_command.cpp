#include "apps/cli/thesis_command.h"

#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

#include "apps/cli/interrupt.h"
#include "apps/cli/lab_files.h"
#include "base/error.h"
#include "image/auto_exposure.h"
#include "image/tone_map_image.h"
#include "integrators/render_picture.h"
#include "lab/thesis.h"
#include "lab/write_tables.h"

namespace pertev {
namespace {

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

Image render(Queue& queue, const PreparedScene& prepared, const Camera& camera, const LabSettings& lab,
             PathLight light) {
    RenderSettings settings;
    settings.width = lab.width, settings.height = lab.height;
    settings.samples = queue.is_cuda() ? kPictureSamplesCuda : kPictureSamples;
    settings.path.max_depth = static_cast<uint32_t>(lab.depth);
    settings.path.light = light;
    return render_picture(queue, prepared, camera, settings, [](const RenderProgress&) { return !interrupted(); })
        .picture;
}

} // namespace

int run_thesis(Queue& queue, const SceneOptions& options, LabSettings settings, const std::string& output,
               Reporter& reporter) {
    for (const ThesisVariant& v : thesis_variants(queue.is_cuda())) settings.only.push_back(v.combination);
    settings.primary = settings.diffuse = true;
    settings.shadow = false;
    ThesisReport thesis;
    for (const std::string& name : {std::string("cornell-box"), options.scene.empty() ? sibenik() : options.scene}) {
        SceneOptions scene_options = options; // the camera's flags are the second scene's
        if (name == "cornell-box") scene_options = {};
        scene_options.scene = name;
        const LoadedScene loaded = load_scene(scene_options, reporter.messages());
        const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
        const Camera camera = choose_camera(scene_options, loaded.scene, aspect, reporter.messages());
        reporter.say_messages();
        const std::string title = std::filesystem::path(name).stem().string();
        reporter.say(fmt::format("{}: {}x{}, depths {} to {}", title, settings.width, settings.height,
                                 settings.first_depth, settings.depth));
        thesis.scenes.push_back(run_lab(queue, loaded.scene, camera, settings, show_lab_progress(reporter)));
        thesis.scenes.back().scene = title;
        reporter.end_progress();
        reporter.event(json_of(thesis.scenes.back()));
        if (interrupted()) break;
        if (output.empty()) continue;
        const PreparedScene prepared = prepare_scene(loaded.scene, {}, reporter.messages());
        const Image local = render(queue, prepared, camera, settings, PathLight::Direct);
        const Image global = render(queue, prepared, camera, settings, PathLight::Path);
        const float stops = loaded.default_light ? auto_exposure_stops(global) : 0; // one for both: they are compared
        thesis.local.push_back({title + ", local", tone_map_image(local, ToneMap::Srgb, stops)});
        thesis.global.push_back({title + ", global", tone_map_image(global, ToneMap::Srgb, stops)});
    }
    reporter.answer(text_of(thesis));
    if (!output.empty()) {
        const std::filesystem::path folder = output;
        write_text(folder / "thesis.html", html_of(thesis));
        for (const LabReport& report : thesis.scenes) {
            write_text(folder / fmt::format("thesis-{}.csv", report.scene), csv_of(report));
        }
        reporter.say(fmt::format("written: {}", (folder / "thesis.html").string()));
    }
    return interrupted() ? exit_status(ErrorCode::Interrupted) : 0;
}

} // namespace pertev
