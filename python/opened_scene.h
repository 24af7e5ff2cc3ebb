#pragma once

// A scene that stays open, with its trees and its place on a device, as long as pictures or frames differ in nothing
// that these depend on, and follows changes of its numbers.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "python/scene_parameters.h"
#include "session/devices/session_on_devices.h"
#include "session/pictures/prepare_render.h"

namespace pertev {

/// A scene's source, and the edits of its user.
struct EditedScene {
    struct Edit {
        std::vector<double> values;
        uint64_t number = 0; // counts all edits
    };

    std::string name;                    // a file or a built-in scene; a scene of arrays has it for messages
    std::shared_ptr<const Scene> arrays; // in place of a file; null: there is one
    std::string hash_of_arrays;
    std::map<std::string, Edit> edits; // by their paths (SceneParameters); the last one of each
    uint64_t edit_count = 0;

    /// Returns the hash of a scene that was read with `hash` after all edits.
    std::string edited(const std::string& hash) const;
    /// Applies all edits to a scene. Throws Error(BadInput) if the scene lacks a parameter.
    void edit(Scene& scene) const;
};

class OpenedScene {
public:
    /// `shared` is what all devices render together.
    explicit OpenedScene(const SharedWork& shared = {.pictures = true}) : shared_(shared) {}

    /// Prepares a picture of the source by `options`, which get what the scene suggests, as it was opened, or opens it.
    /// Throws as prepare_render; the scene stays open if a setting is wrong.
    void prepare(PictureOptions& options, const EditedScene& source, Sink& sink);

    /// Returns null before the first prepare() that succeeded.
    RenderSetup* setup() const { return setup_.get(); }
    /// Returns the names of the scene's parameters; there must be a setup.
    const SceneParameters& parameters();
    /// Returns the record of a picture without its display; prepare() has gone before.
    PictureRecord record(const PictureOptions& options, const EditedScene& source, Sink& sink);
    /// Returns the session, made or brought up to date, with the record's camera and settings. Several devices render
    /// its pictures together, but `for_batch` each renders alone.
    Session& session(const PictureRecord& record, bool for_batch = false);
    /// Returns what renders by several devices, for which session() has gone before; null if there is one device.
    RenderOnDevices* together() { return session_->together(); }

private:
    bool apply_edits(const EditedScene& source, Sink& sink);
    void open(PictureOptions& options, const EditedScene& source, Sink& sink);
    Session& updated_session(const PictureRecord& record);

    SharedWork shared_;
    PictureOptions used_; // options that setup_ was made or last adapted by
    std::unique_ptr<RenderSetup> setup_;
    std::optional<SceneParameters> parameters_;
    std::optional<SessionOnDevices> session_;
    uint64_t edits_ = 0; // how many of the source's edits the setup has
};

} // namespace pertev
