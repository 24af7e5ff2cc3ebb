#include "lab/describe_camera.h"

#include <fmt/format.h>

#include "session/writing/picture_metadata.h"
#include "settings/setting_table.h"

namespace pertev {

std::string describe_camera(const Camera& camera, DoubleVec3 origin) {
    Camera aimed = camera;
    // The target is as far from the camera as the camera is from the origin. If it were nearer, the direction would
    // lose digits in the difference of the two.
    aimed.focus_distance = 1;
    while (aimed.focus_distance < max_component(abs(camera.world_from_camera.translation))) aimed.focus_distance *= 2;
    PictureOptions options;
    options.scene.camera = choice_of(source_of(CameraChoice{}, aimed, origin));
    std::string text;
    for (const char* name : {"eye", "target", "up", "projection", "fov", "view_height"}) {
        for (const std::string& value : texts_of(options, *find_setting(name))) {
            if (!value.empty()) text += fmt::format("{}`{}={}`", text.empty() ? "" : " ", name, value);
        }
    }
    return text;
}

} // namespace pertev
