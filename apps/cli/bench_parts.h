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
#include "session/camera_batch.h"
#include "session/session.h"

namespace CLI {
class App;
}

namespace pertev {

/// The rate in millions per second; 0 if no time was taken.
inline double millions_a_second(uint64_t count, double seconds) {
    return seconds > 0 ? static_cast<double>(count) / seconds * 1e-6 : 0.0;
}

/// The folder of public scenes that PERTEV_SCENES names (docs/scenes.md); empty if it is not set.
inline std::filesystem::path public_scenes_folder() {
    const char* const folder = std::getenv("PERTEV_SCENES");
    return folder != nullptr ? folder : "";
}

/// Throws Error(BadInput) if there is no such scene; `others` names further valid names. Call it for all scenes before
/// the first one is measured.
void check_bench_scene(const std::string& name, std::string_view others = "");

/// Flags of benchmarks over scenes of the record (lab/record_scenes.h).
struct RecordFlags : PictureOptions {
    std::vector<std::string> scenes;
    uint32_t runs = 0; // 0: the benchmark's own
    SettingFlags settings;
    ReportFlags report;
};

/// Adds --scene, --runs, --report and the settings of `verbs`.
void add_record_flags(CLI::App& verb, RecordFlags& flags, SettingVerbs verbs, const char* runs);
/// Checks each name like check_bench_scene and returns them; without names returns all scenes of the record.
std::vector<std::string> check_record_scenes(std::vector<std::string> names);
/// Reads a scene of the record by its name, else the geometry of a built-in scene or a file.
Scene read_record_scene(const std::string& name, Sink& sink);
/// Reads a scene of the record by its name, else a scene with its light as `pertev render` does. Throws Error, with the
/// known names if there is neither a file nor a scene of this name.
Scene read_lab_scene(const SceneOptions& options, Sink& sink);
/// The scene's title in reports: its file's name without folder and extension, converted to valid UTF-8.
std::string lab_scene_title(const std::string& scene);

/// The start of a benchmark of one scene.
struct BenchedScene {
    std::shared_ptr<Queue> queue; // the first of `queues`
    Scene scene;
    RenderSettings settings;
    Camera camera;
    PreparedScene prepared; // points to `scene`
    std::vector<std::shared_ptr<Queue>> queues;
};

/// Takes the device, or those that make frames together, and reads the scene of the flags with its camera, light and
/// trees. Reports messages, and handles Ctrl-C from then on. Throws Error; for wrong flags before anything is read.
std::unique_ptr<BenchedScene> read_benched_scene(RenderFlags& flags, SettingVerbs verb, Reporter& reporter);

/// Flags of benchmarks of whole pictures.
struct PictureFlags : PictureOptions {
    std::vector<std::string> scenes;
    SettingFlags settings;
    ReportFlags report;
};

/// Adds all flags but --scene. `sizes` and `samples` describe the defaults in the help.
void add_picture_flags(CLI::App& verb, SettingVerbs verbs, PictureFlags& flags, const std::string& sizes,
                       const std::string& samples);

/// Options for the binary trees that pictures with these settings need. The session converts the trees.
PrepareOptions trees_for(const RenderSettings& settings, const Queue& queue);

/// Adds the flags --report, -q and --json.
void add_bench_report_flags(CLI::App& verb, ReportFlags& flags);

/// Prints the results of a benchmark as they come, and writes them as a measurement (lab/measurement.h) to the file of
/// --report.
class BenchReport {
public:
    BenchReport(Reporter& reporter, const ReportFlags& flags, const Queue& queue, std::string title);

    /// Adds a row to the table of this event and prints it: with --json as an object, otherwise as a line below the
    /// table's head, which `above` precedes.
    void add(const char* event, const Fields& fields, const std::string& above = "");
    /// Adds the only row of a table and prints it, without --json as a line per field.
    void add_alone(const char* event, const Fields& fields);
    /// Adds a row that is written to the file and not printed.
    void keep(const char* name, const Fields& fields);
    /// Adds a picture to the page.
    void add_picture(ResultPicture picture) { measurement_.pictures.push_back(std::move(picture)); }
    /// Writes the file of --report, if there is one.
    void write() const;

private:
    ResultTable& table_of(const char* name);

    Reporter& reporter_;
    std::string file_;
    Measurement measurement_;
};

/// Fields for the median, least and greatest seconds and the number of runs.
Fields time_fields(const RunTimes& times);

/// The camera turned by `yaw` radians about +y, then moved by `step` (metres, in its own space).
Camera moved(const Camera& camera, float yaw, Vec3 step);

/// Returns cameras near `camera`: rotated by up to 30 degrees, so that their views are similar, and moved by up to a
/// fiftieth of the scene's size. Fractions of multiples of irrational numbers are spread evenly.
CameraBatch cameras_about(const Camera& camera, uint32_t count, float scene_size);

/// Renders the session's picture from its first sample on. Throws Error(Interrupted) after Ctrl-C.
void render_again(Session& session, uint32_t samples);

/// Adds a verb of `bench` that calls `run`. Refuses a flag of `bench` itself before the verb's name, which the verb
/// would ignore.
CLI::App& add_bench_verb(CLI::App& bench, const char* name, const char* help, std::function<void()> run);

// Each adds one verb of `bench`.
void add_bench_rays_command(CLI::App& bench, int& status);
void add_bench_page_command(CLI::App& bench, int& status);
void add_bench_build_command(CLI::App& bench, int& status);
void add_bench_frames_command(CLI::App& bench, int& status);
void add_bench_noise_command(CLI::App& bench, int& status);
void add_bench_render_command(CLI::App& bench, int& status);
void add_bench_sequence_command(CLI::App& bench, int& status);
void add_bench_cameras_command(CLI::App& bench, int& status);
void add_bench_devices_command(CLI::App& bench, int& status);

} // namespace pertev
