#include "python/session.h"

#include "base/error.h"
#include "python/unlocked.h"
#include "session/pictures/check_options.h"
#include "session/pictures/frame_settings.h"
#include "session/pictures/render_sequence.h"

namespace pertev {

void PythonSession::set(const SettingTexts& settings, Sink& sink) {
    const std::unique_lock turn = wait_for(turn_, sink);
    SettingTexts changed = settings_;
    for (const auto& [name, texts] : settings) {
        if (texts.empty()) {
            changed.erase(name);
        } else {
            changed[name] = texts;
        }
    }
    PartMessages unsaid(sink); // the next frame reports them
    PictureOptions options = scene_.options_of({"", changed}, unsaid);
    complete_options(options, kRender);
    std::swap(settings_, changed);
    record_.reset();
    if (opened_.setup() == nullptr) return;
    try {
        prepare(sink);
    } catch (...) {
        std::swap(settings_, changed);
        record_.reset();
        throw;
    }
}

void PythonSession::reset(Sink& sink) {
    const std::unique_lock turn = wait_for(turn_, sink);
    frame_.reset(), cut_.reset();
}

std::optional<uint32_t> PythonSession::frame(Sink& sink) {
    const std::unique_lock turn = wait_for(turn_, sink);
    return frame_;
}

/// Makes the record that of the settings and the scene as they are now.
void PythonSession::prepare(Sink& sink) {
    scene_.with_source(sink, [&](const EditedScene& source) {
        if (record_ && edits_ == source.edit_count) return;
        PictureOptions options = scene_.options_of({"", settings_}, sink);
        const RenderSetup* const before = opened_.setup();
        opened_.prepare(options, source, sink);
        if (opened_.setup() != before) cut_.reset(); // it was opened again, and has no history
        options_ = options;
        record_ = opened_.record(options_, source, sink);
        edits_ = source.edit_count;
    });
}

std::optional<PythonResult> PythonSession::next(Sink& sink) {
    const std::unique_lock turn = wait_for(turn_, sink);
    prepare(sink);
    RenderSetup& setup = *opened_.setup();
    if (!frame_) frame_ = setup.sequence.first;
    if (*frame_ > setup.sequence.last) return std::nullopt;
    if (setup.sequence.is_cut(*frame_)) cut_.reset();
    Session& session = opened_.session(*record_);
    if (!cut_) session.cut();
    if (!cut_ || session.history().cuts != cuts_) cut_ = frame_; // other settings may have ended the history
    cuts_ = session.history().cuts;
    if (record_->in_sequence) record_->in_sequence->cut = *cut_;
    const FrameCamera camera = {*setup.camera, setup.sequence};
    RenderedFrame rendered = render_frame(*frame_, {camera, *setup.moving, *record_, session}, sink);
    if (rendered.result.samples < record_->settings.samples) {
        if (options_.real_time) cut_.reset(); // the cut has ended the history
        sink.check();
        throw Error(ErrorCode::Interrupted, "interrupted before the frame was complete");
    }
    PictureRecord record = *record_;
    record.scene.build_seconds = rendered.update_s;
    record.scene.settings = settings_of_frame(options_, record, *frame_);
    ++*frame_;
    return PythonResult(std::move(rendered.result), std::make_shared<const PictureRecord>(std::move(record)));
}

} // namespace pertev
