#pragma once

// A scene as Python keeps it, of which it renders pictures.

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "python/batch.h"
#include "python/opened_scene.h"
#include "python/result.h"

namespace pertev {

/// Values of settings by their names, as texts (settings/setting.h).
using SettingTexts = std::map<std::string, std::vector<std::string>>;

/// The settings of a call.
struct CallSettings {
    std::string file; // a file of settings; empty: none
    SettingTexts texts;
    bool is_still = false; // a single picture, which may be a part and may have a checkpoint
    bool operator==(const CallSettings&) const = default;
};

/// Several threads may use one, and take turns.
class PythonScene {
public:
    /// `settings` hold for all pictures that do not overrule them.
    PythonScene(EditedScene source, SettingTexts settings)
        : source_(std::move(source)), settings_(std::move(settings)) {}

    const std::string& name() const { return source_.name; }
    const SettingTexts& settings() const { return settings_; }
    bool is_of_arrays() const { return source_.arrays != nullptr; }
    /// Returns the options of a call. Throws Error(BadInput).
    PictureOptions options_of(const CallSettings& settings, Sink& sink) const;

    /// Opens the scene if it is not open. Throws as prepare_render.
    void open(Sink& sink);
    /// Renders a picture, writes it to `outputs`, and fills the arrays `out`. Throws Error.
    PythonResult render(const CallSettings& settings, const std::vector<std::string>& outputs,
                        std::span<const OutArray> out, Sink& sink);

    /// Renders a picture by each camera into `batch`, whose arrays are made if it has none. Throws Error.
    void render_batch(const CallSettings& settings, const CamerasArgument& cameras, PythonBatch& batch, Sink& sink);
    /// Returns how many pictures of a batch are rendered at once with the settings.
    uint32_t batch_size(const CallSettings& settings, const CamerasArgument& cameras, Sink& sink);

    // Parameters (scene_parameters.h). All but edits() open the scene if it is not open. Null: there is none of this
    // path.
    std::vector<std::string> paths(Sink& sink);
    struct Value {
        std::vector<std::size_t> shape;
        std::vector<double> values;
    };
    std::optional<Value> value(const std::string& path, Sink& sink);
    /// Changes a parameter of what is rendered from now on. Throws Error(BadInput) for values that it cannot have.
    bool set_value(const std::string& path, const Value& value, Sink& sink);

    /// Calls `work` with the scene as it was last rendered, with all changes since; opens it if it is not open.
    template <class Work>
    void with_opened(Sink& sink, const Work& work) {
        const std::unique_lock turn = wait_for_turn(sink);
        if (opened_.setup() == nullptr || edits_ != source_.edit_count) {
            PictureOptions options = options_of({}, sink);
            opened_.prepare(options, source_, sink);
        }
        work(opened_.setup()->scene());
    }
    /// Returns the scene with the settings that hold for all pictures, and with the camera of such a picture if it has
    /// none.
    Scene copy(Sink& sink);

    /// Returns what was changed, by path.
    std::map<std::string, Value> edits(Sink& sink);

    /// Calls `work` with the source while no other thread changes it.
    template <class Work>
    auto with_source(Sink& sink, const Work& work) {
        const std::unique_lock turn = wait_for_turn(sink);
        return work(static_cast<const EditedScene&>(source_));
    }

private:
    /// Waits until no other thread uses the scene. Throws Error(Interrupted) if the sink stops.
    std::unique_lock<std::timed_mutex> wait_for_turn(Sink& sink);
    void open_in_turn(Sink& sink);
    PythonResult render_into(Session& session, std::span<const OutArray> out, Sink& sink);
    void prepare_cameras(const CallSettings& settings, const CamerasArgument& cameras, Sink& sink);
    const PictureRecord& prepare(const CallSettings& settings, const std::vector<std::string>& outputs, Sink& sink);

    EditedScene source_;
    SettingTexts settings_;
    std::timed_mutex turn_;
    OpenedScene opened_;
    FilmReader reader_;
    // The last call that wrote no file, whose repetition takes everything as it is.
    std::optional<CallSettings> last_;
    std::shared_ptr<const PictureRecord> record_;
    PictureOptions options_;
    uint64_t edits_ = 0;
};

} // namespace pertev
