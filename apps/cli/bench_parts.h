#pragma once

// Parts that the benchmarks under `pertev bench` share.

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/render_flags.h"
#include "apps/cli/reporter.h"
#include "device/device_timer.h"
#include "device/queue.h"
#include "lab/measurement.h"
#include "render/prepare_scene.h"
#include "session/session.h"

namespace CLI {
class App;
}

namespace pertev {

/// 0 where no time was taken.
inline double millions_a_second(uint64_t count, double seconds) {
    return seconds > 0 ? static_cast<double>(count) / seconds * 1e-6 : 0.0;
}

/// The folder of public scenes that PERTEV_SCENES names (docs/scenes.md); empty where it is not set.
inline std::filesystem::path public_scenes_folder() {
    const char* const folder = std::getenv("PERTEV_SCENES");
    return folder != nullptr ? folder : "";
}

/// Throws Error(BadInput) where there is no such scene; `others` are names that are taken beside it. Asked of all
/// scenes before the first is measured.
void check_bench_scene(const std::string& name, std::string_view others = "");

/// Adds --scene where scenes of the record may be named too (lab/record_scenes.h).
void add_record_scenes(CLI::App& verb, std::vector<std::string>& names);
/// Checks each as check_bench_scene does, and returns them: all of the record where none is named.
std::vector<std::string> check_record_scenes(std::vector<std::string> names);
/// Reads a scene of the record by its name, else the geometry of a built-in scene or a file.
Scene read_record_scene(const std::string& name, Messages& messages);
/// Reads a scene of the record by its name, else a scene with its light as `pertev render` does. Throws Error, with the
/// known names if there is neither a file nor a scene of this name.
Scene read_lab_scene(const SceneOptions& options, Messages& messages);
/// The scene's title in reports: its file's name without folder and extension, in UTF-8 whatever its bytes are.
std::string lab_scene_title(const std::string& scene);

/// Returns the mean over all channels and pixels.
double mean_of(const Image& image);

/// The start of a benchmark of one scene.
struct BenchedScene {
    std::unique_ptr<Queue> queue;
    Scene scene;
    RenderSettings settings;
    Camera camera;
    PreparedScene prepared; // points to `scene`
};

/// The device, then the scene that flags name, seen and lit as they say, with its trees. Says what there is to say on
/// the way, and listens for Ctrl-C from then on. Throws Error: of the line before anything is read.
std::unique_ptr<BenchedScene> read_benched_scene(RenderFlags& flags, SettingVerbs verb, Reporter& reporter);

/// Returns how frames in real time are made, as JSON.
std::string reconstruction_json(const ReconstructionOptions& options);

/// Flags of benchmarks of whole pictures.
struct PictureFlags : PictureOptions {
    std::vector<std::string> scenes;
    SettingFlags settings;
    ReportFlags report;
};

/// Adds all but --scene. `sizes` and `samples` say what they are where none are named, for people.
void add_picture_flags(CLI::App& verb, SettingVerbs verbs, PictureFlags& flags, const std::string& sizes,
                       const std::string& samples);

/// The binary trees that pictures with these settings need; what they are turned into is made by the session.
PrepareOptions trees_for(const RenderSettings& settings, const Queue& queue);

/// Adds --report, the file of the measurement, beside -q and --json.
void add_bench_report_flags(CLI::App& verb, ReportFlags& flags);

/// Results of a benchmark: printed as they come, and written as a measurement (lab/measurement.h) into the file of
/// --report.
class BenchReport {
public:
    BenchReport(Reporter& reporter, const ReportFlags& flags, const Queue& queue, std::string title);

    /// A row of the table of this event. With --json it is an object; for people a line under the table's head, with
    /// `above` over that.
    void add(const char* event, const Fields& fields, const std::string& above = "");
    /// A row that is all there is, for people a line a field.
    void add_alone(const char* event, const Fields& fields);
    /// A row that nobody is told: it stands in the file alone.
    void keep(const char* name, const Fields& fields);
    /// A picture for the page.
    void add_picture(ResultPicture picture) { measurement_.pictures.push_back(std::move(picture)); }
    /// Writes the file, where one is wanted.
    void write() const;

private:
    ResultTable& table_of(const char* name);

    Reporter& reporter_;
    std::string file_;
    Measurement measurement_;
};

/// Median, least and greatest seconds, and how many runs these are of.
Fields time_fields(const RunTimes& times);

/// Turned by `yaw` radians about +y, and moved by `step`, metres, of its own space.
Camera moved(const Camera& camera, float yaw, Vec3 step);

/// The session's picture from its first sample on. Throws Error(Interrupted) where it is asked to end before.
void render_again(Session& session, uint32_t samples);

/// Adds a verb of `bench` that calls `run` with its flags. A flag of `bench` itself before the verb's name, which the
/// verb would not see, is refused.
CLI::App& add_bench_verb(CLI::App& bench, const char* name, const char* help, std::function<void()> run);

/// `bench rays`, a verb of `bench`.
void add_bench_rays_command(CLI::App& bench, int& status);
void add_bench_page_command(CLI::App& bench, int& status);
/// `bench build`, `bench frames`, `bench noise`, `bench render` and `bench sequence`, likewise.
void add_bench_build_command(CLI::App& bench, int& status);
void add_bench_frames_command(CLI::App& bench, int& status);
void add_bench_noise_command(CLI::App& bench, int& status);
void add_bench_render_command(CLI::App& bench, int& status);
void add_bench_sequence_command(CLI::App& bench, int& status);

} // namespace pertev
