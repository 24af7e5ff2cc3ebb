#pragma once

// A scene as Python keeps it: open, with its trees and its place on a device, as long as pictures differ in nothing
// that these depend on.

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "python/result.h"
#include "session/pictures/prepare_render.h"
#include "session/session.h"

namespace pertev {

/// Values of settings by their names, as texts (settings/setting.h).
using SettingTexts = std::map<std::string, std::vector<std::string>>;

/// Several threads may use one, and take turns.
class PythonScene {
public:
    /// `settings` hold for all pictures that do not overrule them.
    PythonScene(std::string name, SettingTexts settings) : name_(std::move(name)), settings_(std::move(settings)) {}

    const std::string& name() const { return name_; }
    /// Reads the scene and builds its trees. Throws as prepare_render.
    void open(Sink& sink);
    /// Renders a picture, and writes it to `outputs`. Throws Error.
    PythonResult render(const std::string& settings_file, const SettingTexts& settings,
                        const std::vector<std::string>& outputs, Sink& sink);

private:
    /// Waits until no other thread uses the scene. Throws Error(Interrupted) if the sink stops.
    std::unique_lock<std::timed_mutex> take_turn(Sink& sink);
    PictureOptions options_of(const std::string& settings_file, const SettingTexts& settings, Sink& sink) const;
    /// Makes setup_ and session_ those of a picture.
    void prepare(PictureOptions& options, Sink& sink);

    std::string name_;
    SettingTexts settings_;
    std::timed_mutex turn_;
    PictureOptions used_; // those that setup_ was made or last adapted by
    std::unique_ptr<RenderSetup> setup_;
    std::optional<Session> session_;
};

} // namespace pertev
