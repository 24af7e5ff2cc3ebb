#pragma once

// Frames of a scene for Python, one after the other: reconstructed with the history of earlier ones, or pictures.

#include <memory>
#include <mutex>
#include <optional>

#include "python/scene.h"

namespace pertev {

/// Frames of a scene, which the session opens for itself, with the scene's changes so far at each frame, so that
/// pictures of the scene and frames do not disturb each other. Several threads may use one, and take turns.
class PythonSession {
public:
    /// Frames are those of `pertev render --frames` with these settings; `scene` outlives it.
    PythonSession(PythonScene& scene, SettingTexts settings) : scene_(scene), settings_(std::move(settings)) {}

    /// Renders the next frame; none after the last one. Throws Error, after which the frame is the next one still.
    std::optional<PythonResult> next(Sink& sink);
    /// Changes settings of the frames to come. No texts: the setting counts as not given. Throws Error if a value is
    /// wrong, once the scene is open also one that does not fit the scene; all settings stay as they were then.
    void set(const SettingTexts& settings, Sink& sink);
    /// Forgets earlier frames: the next one is the first.
    void reset(Sink& sink);
    /// Number of the next frame; none before the first one is known.
    std::optional<uint32_t> frame(Sink& sink);
    const std::string& scene_name() const { return scene_.name(); }

private:
    void prepare(Sink& sink);

    PythonScene& scene_;
    std::timed_mutex turn_;
    SettingTexts settings_;
    OpenedScene opened_{{.pictures = true, .frames = true}};
    PictureOptions options_;
    std::optional<PictureRecord> record_; // none: the settings have changed
    uint64_t edits_ = 0, cuts_ = 0;
    std::optional<uint32_t> frame_, cut_; // the next one; the first one of the history
};

} // namespace pertev
