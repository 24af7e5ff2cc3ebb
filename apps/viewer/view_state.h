#pragma once

// What the viewer shows besides the camera's pose, and the table of settings that a page may change. A setting is one
// row of that table: the page builds its panel from it, so a new setting is added here alone.

#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "apps/viewer/client_message.h"
#include "denoise/reconstruction_settings.h"
#include "restir/restir_settings.h"
#include "session/writing/picture_metadata.h"
#include "settings/render_settings.h"

namespace pertev {

/// What of the picture is shown. Beauty is the picture itself; the layers are false colours of one sample or more.
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

/// Scatterings at most of pictures of the movement, unless somebody has chosen a depth.
inline constexpr uint32_t kMovingDepth = 4;

struct ViewState {
    RenderSettings picture; // at rest: size, light, number of samples, tracers
    Display display;        // where the exposure is found by itself, its stops are added to that
    bool finds_exposure = false;
    float found_stops = 0; // of the last picture
    Camera lens;           // angle of view, aperture, focus; its place is the pose's
    ShownLayer layer = ShownLayer::Beauty;
    bool is_real_time = false; // also at rest, pictures are those of the movement
    // Frames of the movement; none of this touches the picture at rest.
    bool is_reconstructed = true; // by what frames before have seen (denoise/); else they are their samples
    ReconstructionSettings reconstruction;
    RestirSettings restir;
    float moving_scale = 0;               // of the size; 0: whatever keeps the frame rate
    uint32_t moving_depth = kMovingDepth; // scatterings at most, where that is fewer than the picture's
    float screen_rate = 0;                // pictures a second of the screen of who steers; 0: not known
    bool on_cuda = false;
    uint64_t window_pixels = 0; // at most, of a picture that takes the window's shape; 0: its size was asked for
    std::vector<std::pair<IntegratorKind, std::string>> dark; // those that would show the scene as black, and why
};

/// The value of a setting: text for choices, a number for the others.
using SettingValue = std::variant<double, std::string>;

struct ViewSetting {
    enum class Kind : uint8_t { Choice, Number, Whole };
    const char* name;
    const char* label;
    const char* group;
    const char* hint; // for who does not know it
    Kind kind;
    std::vector<std::string> choices;   // of a Choice
    double low = 0, high = 0, step = 1; // of a number
    std::function<SettingValue(const ViewState&)> get;
    /// Empty where that was done; else why not, in plain words, and nothing was done.
    std::function<std::string(ViewState&, const SettingValue&)> set;
};

/// All settings, in the panel's order.
const std::vector<ViewSetting>& view_settings();

/// Whether the picture at rest of `after` needs other samples than that of `before`.
bool begins_anew(const ViewState& before, const ViewState& after);

/// Whether the same samples look otherwise in `after`.
bool is_shown_otherwise(const ViewState& before, const ViewState& after);

/// Gives the picture the shape of a window of so many pixels, unless its size was asked for. Returns whether that is
/// another size.
bool take_window_shape(ViewState& state, uint32_t width, uint32_t height);

/// Sets one by its name. Empty where that was done; else why not, and nothing was done.
std::string set_view_setting(ViewState& state, const std::string& name, const SettingValue& value);

const char* name_of(ShownLayer layer);
/// Of the reconstruction, so that they are there only with it.
bool is_of_frames(ShownLayer layer);

} // namespace pertev
