#include "python/scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "image/picture_hash.h"
#include "python/unlocked.h"
#include "session/film_file/film_file.h"
#include "session/opening/strictness.h"
#include "session/pictures/choose_display.h"
#include "session/pictures/render_samples.h"
#include "session/pictures/render_with_checkpoint.h"
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

void set_all(PictureOptions& options, const SettingTexts& settings) {
    for (const auto& [name, texts] : settings) {
        const Setting* setting = find_setting(name);
        if (setting == nullptr) throw Error(ErrorCode::BadInput, name, "", "no setting");
        set_value(options, *setting, texts);
    }
}

} // namespace

std::unique_lock<std::timed_mutex> PythonScene::wait_for_turn(Sink& sink) { return wait_for(turn_, sink); }

PictureOptions PythonScene::options_of(const CallSettings& settings, Sink& sink) const {
    PictureOptions options;
    options.scene.scene = name();
    set_all(options, settings_); // the call's file overrules them
    combine_settings(
        settings.file, kRender, [&](PictureOptions& others) { set_all(others, settings.texts); }, options, sink);
    for (const char* name : {"samples", "part", "checkpoint"}) {
        if (!settings.is_still && options.is_given(name))
            throw Error(ErrorCode::BadInput, name, "", "only a call for a single picture has parts and checkpoints");
    }
    return options;
}

void PythonScene::open_in_turn(Sink& sink) {
    if (opened_.setup() != nullptr) return;
    PictureOptions options = options_of({}, sink);
    opened_.prepare(options, source_, sink);
}

void PythonScene::open(Sink& sink) {
    const std::unique_lock turn = wait_for_turn(sink);
    open_in_turn(sink);
}

Scene PythonScene::copy(Sink& sink) {
    const std::unique_lock turn = wait_for_turn(sink);
    last_.reset();
    PictureOptions options = options_of({}, sink);
    opened_.prepare(options, source_, sink);
    Scene scene = opened_.setup()->scene();
    if (scene.cameras.empty()) scene.cameras.push_back(opened_.record(options, source_, sink).camera.camera);
    return scene;
}

/// Makes record_ and options_ those of a call.
const PictureRecord& PythonScene::prepare(const CallSettings& settings, const std::vector<std::string>& outputs,
                                          Sink& sink) {
    const bool repeats = last_ && outputs.empty() && *last_ == settings && settings.file.empty();
    if (repeats && edits_ == source_.edit_count) return *record_;
    last_.reset();
    options_ = options_of(settings, sink);
    if (frame_range(options_)) {
        throw Error(ErrorCode::BadInput, "frames", options_.frames, "a call renders one picture; `time` chooses it");
    }
    if (!outputs.empty() || !options_.checkpoint.empty()) check_files(options_, outputs, sink);
    opened_.prepare(options_, source_, sink);
    record_ = std::make_shared<const PictureRecord>(opened_.record(options_, source_, sink));
    if (outputs.empty()) last_ = settings;
    edits_ = source_.edit_count;
    return *record_;
}

/// Renders a picture whose arrays are those of the caller. Colour that is not among them is made as always.
PythonResult PythonScene::render_into(Session& session, std::span<const OutArray> out, Sink& sink) {
    const RenderSettings& settings = session.settings();
    RenderResult result = {add_samples(session, sink), {}, {}, {}, {}, {}};
    reader_.read(session, opened_.setup()->queue, out);
    result.picture = {settings.width, settings.height, settings.transparent ? 4u : 3u, {}};
    const OutArray* color = find_array(out, "color");
    if (color == nullptr) result.picture = session.picture();
    PythonResult made(std::move(result), record_);
    if (color != nullptr) { // the caller may change it
        const auto* const values = reinterpret_cast<const float*>(color->memory);
        const std::size_t count = std::size_t(settings.width) * settings.height * made.result.picture.channels;
        made.hash = picture_hash(settings.width, settings.height, {values, count}).hex();
    }
    return made;
}

PythonResult PythonScene::render(const CallSettings& settings, const std::vector<std::string>& outputs,
                                 std::span<const OutArray> out, Sink& sink) {
    const std::unique_lock turn = wait_for_turn(sink);
    prepare(settings, outputs, sink);
    Session& session = opened_.session(*record_);
    check_arrays(out, session.settings());
    session.cut();
    const bool has_checkpoint = !options_.checkpoint.empty();
    const bool is_read =
        !out.empty() && outputs.empty() && !has_checkpoint && FilmReader::reads(out, session.settings());
    std::shared_ptr<const PictureRecord> shown = record_;
    if (writes_tone_mapped(outputs) || has_checkpoint || writes_films(outputs)) {
        PictureRecord with_display = *record_;
        with_display.display = choose_display(options_, session, sink);
        shown = std::make_shared<const PictureRecord>(std::move(with_display));
    }
    if (writes_tone_mapped(outputs)) record_ = shown;
    // Only a checkpoint keeps an interrupted picture; its files stay as they were.
    std::optional<RenderWithCheckpoint> kept;
    if (has_checkpoint) kept.emplace(session, options_, *shown, sink);
    PythonResult made = is_read ? render_into(session, out, sink)
                                : PythonResult(kept ? kept->render(sink) : render_samples(session, sink), record_);
    sink.check();
    if (made.result.samples == 0) sink.warn({"this part has no samples, so its picture is black"});
    WrittenPicture written;
    if (!outputs.empty()) {
        RenderResult result = made.result; // files take the layers out of it
        if (writes_films(outputs)) {
            const Film& film = kept ? kept->film() : session.film();
            const FilmHeader header = film_header(options_, *shown, facts_of(*shown, result.ids), result, film);
            written.files = write_film_files(outputs, header, film);
        }
        WrittenPicture pictures = write_picture(outputs, *record_, result);
        written.files.insert(written.files.end(), pictures.files.begin(), pictures.files.end());
    }
    if (kept) written.files.push_back(kept->written());
    if (!out.empty() && !is_read) {
        copy_into(out, made.result);
        made.known_hash(); // before the caller can change its arrays
        made.result.layers.clear(), made.result.ids.clear();
    }
    refuse_faults(written, made.result.invalid_samples, options_.strict);
    return made;
}

/// Makes record_ and options_ those of a call whose settings have the first camera.
void PythonScene::prepare_cameras(const CallSettings& settings, const CamerasArgument& cameras, Sink& sink) {
    try {
        prepare(settings, {}, sink);
    } catch (const Error& error) {
        if (cameras.is_single) throw;
        throw error_of_camera(error, 0);
    }
}

void PythonScene::render_batch(const CallSettings& settings, const CamerasArgument& cameras, PythonBatch& batch,
                               Sink& sink) {
    const std::unique_lock turn = wait_for_turn(sink);
    prepare_cameras(settings, cameras, sink);
    Session& session = opened_.session(*record_, true);
    batch.render(opened_, session, cameras, record_, options_, sink);
    if (options_.strict) refuse_invalid_samples(batch.invalid_samples());
}

uint32_t PythonScene::batch_size(const CallSettings& settings, const CamerasArgument& cameras, Sink& sink) {
    const std::unique_lock turn = wait_for_turn(sink);
    prepare_cameras(settings, cameras, sink);
    return size_of_chunk(opened_, cameras.settings_of(record_->settings), cameras, options_);
}

std::vector<std::string> PythonScene::paths(Sink& sink) {
    const std::unique_lock turn = wait_for_turn(sink);
    open_in_turn(sink);
    return opened_.parameters().paths(opened_.setup()->scene());
}

std::optional<PythonScene::Value> PythonScene::value(const std::string& path, Sink& sink) {
    const std::unique_lock turn = wait_for_turn(sink);
    open_in_turn(sink);
    const Scene& scene = opened_.setup()->scene();
    const auto parameter = opened_.parameters().find(scene, path);
    if (!parameter) return std::nullopt;
    const auto edit = source_.edits.find(path);
    return Value{shape_of(*parameter),
                 edit != source_.edits.end() ? edit->second.values : read_parameter(scene, *parameter)};
}

bool PythonScene::set_value(const std::string& path, const Value& value, Sink& sink) {
    const std::unique_lock turn = wait_for_turn(sink);
    open_in_turn(sink);
    const Scene& scene = opened_.setup()->scene();
    const auto parameter = opened_.parameters().find(scene, path);
    if (!parameter) return false;
    if (shape_of(*parameter) != value.shape) {
        throw Error(ErrorCode::BadInput, path, "",
                    fmt::format("its shape is ({}); expected ({})", fmt::join(value.shape, ", "),
                                fmt::join(shape_of(*parameter), ", ")));
    }
    check_parameter(scene, *parameter, value.values, path);
    source_.edits[path] = {value.values, ++source_.edit_count};
    return true;
}

std::map<std::string, PythonScene::Value> PythonScene::edits(Sink& sink) {
    const std::unique_lock turn = wait_for_turn(sink);
    std::map<std::string, Value> values;
    for (const auto& [path, edit] : source_.edits) {
        const std::size_t size = edit.values.size();
        const std::vector<std::size_t> shapes[] = {{}, {size}, {4, 4}};
        values[path] = {shapes[size == 1 ? 0 : size == 16 ? 2 : 1], edit.values};
    }
    return values;
}

} // namespace pertev
