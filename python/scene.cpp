#include "python/scene.h"

#include <chrono>

#include "base/error.h"
#include "image/picture_hash.h"
#include "session/pictures/choose_display.h"
#include "session/pictures/render_samples.h"
#include "session/writing/check_outputs.h"
#include "session/writing/write_picture.h"
#include "settings/setting_table.h"
#include "settings/settings_file.h"

namespace pertev {
namespace {

/// Checks the files' names, and that something shows what the caller has set: files, or arrays, which show what an EXR
/// does.
void check_files(PictureOptions options, const std::vector<std::string>& outputs, Sink& sink) {
    constexpr uint32_t kInArrays = bit_of(ImageFormat::Exr);
    std::erase_if(options.given, [](const auto& given) {
        const Setting* setting = find_setting(given.first);
        return setting != nullptr && (setting->formats & kInArrays) != 0;
    });
    check_outputs(options, outputs, sink);
}

} // namespace

std::unique_lock<std::timed_mutex> PythonScene::take_turn(Sink& sink) {
    std::unique_lock turn(turn_, std::defer_lock);
    while (!turn.try_lock_for(std::chrono::milliseconds(20))) sink.check();
    return turn;
}

PictureOptions PythonScene::options_of(const std::string& settings_file, const SettingTexts& settings,
                                       Sink& sink) const {
    PictureOptions options;
    options.scene.scene = name_;
    SettingTexts all = settings;
    all.insert(settings_.begin(), settings_.end());
    combine_settings(
        settings_file, kRender,
        [&](PictureOptions& others) {
            for (const auto& [name, texts] : all) {
                const Setting* setting = find_setting(name);
                if (setting == nullptr) throw Error(ErrorCode::BadInput, name, "", "no setting");
                set_value(others, *setting, texts);
            }
        },
        options, sink);
    if (frame_range(options)) {
        throw Error(ErrorCode::BadInput, "frames", options.frames, "a call renders one picture; `time` chooses it");
    }
    return options;
}

void PythonScene::prepare(PictureOptions& options, Sink& sink) {
    const PictureOptions asked = options; // without what the scene's file suggests
    if (setup_ && adapt_setup(*setup_, used_, options, kRender, sink)) {
        if (session_) {
            session_->set_settings(setup_->settings);
            session_->set_camera(setup_->camera->at(setup_->scene(), std::nullopt));
            session_->cut();
        }
    } else {
        session_.reset();
        setup_.reset();
        setup_ = prepare_render(options, kRender, sink);
        setup_->hash = scene_hash(name_); // the file may change while the scene is open
    }
    used_ = asked;
}

void PythonScene::open(Sink& sink) {
    const std::unique_lock turn = take_turn(sink);
    PictureOptions options = options_of("", {}, sink);
    prepare(options, sink);
}

PythonResult PythonScene::render(const std::string& settings_file, const SettingTexts& settings,
                                 const std::vector<std::string>& outputs, Sink& sink) {
    const std::unique_lock turn = take_turn(sink);
    PictureOptions options = options_of(settings_file, settings, sink);
    if (!outputs.empty()) check_files(options, outputs, sink);
    prepare(options, sink);
    report_motion(options, *setup_->moving, sink);
    Messages known = setup_->reading;
    known.add_all(sink.messages());
    PictureRecord record = picture_record(options, *setup_, known);
    if (!session_) session_.emplace(*setup_->queue, setup_->prepared(), record.camera.camera, setup_->settings);
    if (writes_tone_mapped(outputs)) record.display = choose_display(options, *session_, sink);
    // An interrupted picture is thrown away, and its files stay as they were.
    PythonResult made = {.result = render_samples(*session_, sink), .metadata = {}, .hash = ""};
    sink.check();
    made.hash = picture_hash(made.result.picture).hex();
    made.metadata = picture_metadata(record, made.result, made.hash);
    WrittenPicture written;
    if (!outputs.empty()) {
        RenderResult result = made.result; // files take the layers out of it
        written = write_picture(outputs, record, result);
    }
    refuse_faults(written, made.result.invalid_samples, options.strict);
    return made;
}

} // namespace pertev
