#pragma once

// The state of the viewer besides the camera's pose, and the settings that a page may change, of which it makes its
// panel: the viewer's own, and the rows of the table of settings that have a Panel.

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "apps/viewer/client_message.h"
#include "session/writing/picture_metadata.h"
#include "settings/setting_table.h"

namespace pertev {

/// The layer of the picture that is shown. Beauty is the picture itself; the others are false colours of at least one
/// sample.
enum class ShownLayer : uint8_t {
    Beauty,
    Albedo,
    Normal,
    Depth,
    Instances,
    Triangles,
    Materials,
    NodeHeat,
    TriangleHeat,
    Motion,
    Deviation,
};

/// Maximum number of scatterings in moving pictures (RenderSettings::frame_depth), unless a depth was chosen.
inline constexpr uint32_t kMovingDepth = 4;

struct ViewState {
    PictureOptions options; // except for the tone map, the exposure and the camera, which are the fields below
    Display display;        // automatic exposure is added to its stops
    bool finds_exposure = false;
    float found_stops = 0; // automatic exposure of the last picture
    Camera lens;           // field of view, aperture, focus; its position is the pose's
    ShownLayer layer = ShownLayer::Beauty;
    bool is_real_time = false; // pictures at rest are like moving ones
    // Moving frames; none of this affects the picture at rest.
    float moving_scale = 0; // scale; 0: chosen to meet the frame rate
    float screen_rate = 0;  // refresh rate of the screen of the client that steers; 0: unknown
    bool on_cuda = false;
    uint64_t window_pixels = 0; // maximum pixels of a picture with the window's shape; 0: its size was requested
    std::vector<std::pair<IntegratorKind, std::string>> dark; // integrators that would show the scene as black, and
                                                              // why
};

/// The value of a setting: text for choices, a number for the others.
using SettingValue = std::variant<double, std::string>;

struct ViewSetting {
    enum class Kind : uint8_t { Choice, Number, Whole };
    const char *name = "", *label = "";
    PanelGroup group = PanelGroup::Picture;
    const char* hint = ""; // for people who do not know it
    Kind kind = Kind::Choice;
    std::vector<std::string> choices;   // for a Choice
    double low = 0, high = 0, step = 1; // for a number
    std::function<SettingValue(const ViewState&)> get;
    /// Returns empty on success, else why nothing was changed, in plain words.
    std::function<std::string(ViewState&, const SettingValue&)> set;
};

/// Returns the viewer's own settings and those of a table, which stays where it is, in the panel's order.
std::vector<ViewSetting> make_view_settings(std::span<const Setting> table);
/// All settings, in the panel's order.
const std::vector<ViewSetting>& view_settings();

/// Returns whether the picture at rest of `after` needs other samples than that of `before`.
bool restarts(const ViewState& before, const ViewState& after);

/// Returns whether the same samples are displayed differently in `after`.
bool is_shown_otherwise(const ViewState& before, const ViewState& after);

/// Gives the picture the shape of a window of this size in pixels, unless its size was requested. Returns whether the
/// size has changed.
bool resize_to_window(ViewState& state, uint32_t width, uint32_t height);

/// Changes a setting by name. Returns empty on success, else why nothing was changed.
std::string set_view_setting(ViewState& state, const std::string& name, const SettingValue& value);

const char* name_of(ShownLayer layer);
/// Returns whether the layer belongs to the reconstruction, without which it does not exist.
bool is_of_frames(ShownLayer layer);
/// Returns the auxiliary channels that the film needs for this layer.
uint32_t aovs_of(ShownLayer layer);

} // namespace pertev
