#include "python/opened_scene.h"

#include "base/error.h"
#include "base/hash.h"
#include "session/pictures/share_records.h"
#include "settings/settings_file.h"

namespace pertev {
namespace {

SceneParameter parameter_of(const SceneParameters& parameters, const Scene& scene, const std::string& path) {
    if (const auto found = parameters.find(scene, path)) return *found;
    throw Error(ErrorCode::BadInput, path, "", "the scene has no such parameter with these settings");
}

} // namespace

std::string EditedScene::edited(const std::string& hash) const {
    if (edits.empty()) return hash;
    Hasher hasher;
    const auto add = [&](const std::string& text) { hasher.add(std::as_bytes(std::span(text))); };
    add(hash);
    for (const auto& [path, edit] : edits) {
        add(path);
        hasher.add(std::as_bytes(std::span(edit.values)));
    }
    return hasher.result().hex();
}

void EditedScene::edit(Scene& scene) const {
    const SceneParameters parameters(scene);
    for (const auto& [path, edit] : edits) write_parameter(scene, parameter_of(parameters, scene, path), edit.values);
}

const SceneParameters& OpenedScene::parameters() {
    if (!parameters_) parameters_.emplace(setup_->scene());
    return *parameters_;
}

/// Changes the opened scene as its source was since. Returns false if it must be opened again.
bool OpenedScene::apply_edits(const EditedScene& source, Sink& sink) {
    if (edits_ == source.edit_count) return true;
    MovingScene& moving = *setup_->moving;
    std::vector<std::pair<SceneParameter, const std::vector<double>*>> news;
    for (const auto& [path, edit] : source.edits) {
        if (edit.number <= edits_) continue;
        news.emplace_back(parameter_of(parameters(), moving.scene(), path), &edit.values);
        // A world that moves has its centre where the scene at rest has it.
        if (news.back().first.owner == ParameterOwner::Instance && moving.is_animated()) return false;
    }
    const auto write_all = [&](Scene& scene) {
        SceneUpdate update;
        for (const auto& [parameter, values] : news) update += write_parameter(scene, parameter, *values);
        return update;
    };
    for (const auto& [parameter, values] : news) {
        const bool is_seen_from =
            parameter.owner == ParameterOwner::Instance || parameter.owner == ParameterOwner::Camera;
        setup_->must_choose = setup_->must_choose || is_seen_from; // a made-up view depends on places
    }
    setup_->changed_parts |= moving.edit(write_all, sink);
    edits_ = source.edit_count;
    return true;
}

void OpenedScene::open(PictureOptions& options, const EditedScene& source, Sink& sink) {
    SceneInMemory in_memory;
    if (source.arrays) in_memory.read = [&](Sink&) { return *source.arrays; };
    in_memory.edit = [&](Scene& scene) { source.edit(scene); };
    auto made = prepare_render(options, kRender, sink, {}, in_memory);
    if (source.arrays) made->hash = source.hash_of_arrays;
    session_.reset(); // it refers to the old setup
    parameters_.reset();
    setup_ = std::move(made);
    edits_ = source.edit_count;
}

void OpenedScene::prepare(PictureOptions& options, const EditedScene& source, Sink& sink) {
    const PictureOptions asked = options; // without what the scene's file suggests
    const bool is_open = setup_ && apply_edits(source, sink) && adapt_setup(*setup_, used_, options, kRender, sink);
    if (!is_open) {
        try {
            open(options, source, sink);
        } catch (const Error& error) {
            // Two scenes may not fit into memory. A wrong setting leaves the old one open, with its session.
            if (error.code() != ErrorCode::OutOfMemory || !setup_) throw;
            session_.reset();
            setup_.reset();
            options = asked;
            open(options, source, sink);
        }
    }
    used_ = asked;
}

PictureRecord OpenedScene::record(const PictureOptions& options, const EditedScene& source, Sink& sink) {
    report_motion(options, *setup_->moving, sink);
    Messages known = setup_->reading;
    known.add_all(sink.messages());
    const std::string own = setup_->hash;
    setup_->hash = source.edited(own);
    PictureRecord record = picture_record(options, *setup_, known);
    setup_->hash = own;
    share_records(options, *setup_, record, sink);
    return record;
}

Session& OpenedScene::session(const PictureRecord& record, bool for_batch) {
    Session& session = updated_session(record);
    session_->share_pictures(!for_batch);
    return session;
}

Session& OpenedScene::updated_session(const PictureRecord& record) {
    const uint32_t parts = std::exchange(setup_->changed_parts, 0);
    if (!session_) {
        session_.emplace(setup_->queues, setup_->prepared(), record.camera.camera, record.settings, shared_);
        return session_->session();
    }
    Session& session = session_->session();
    try {
        if (parts != 0) session_->update_scene(setup_->prepared(), parts);
        session.set_settings(record.settings);
    } catch (...) {
        session_.reset(); // it is made again with the whole scene
        throw;
    }
    session.set_camera(record.camera.camera);
    return session;
}

} // namespace pertev
