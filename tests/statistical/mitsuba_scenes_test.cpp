// Means of small pictures of Mitsuba's scenes, beside those of Mitsuba 3.9.1 (scalar_rgb, 8192 samples a pixel).

#include <doctest/doctest.h>

#include <string>

#include "formats/read_scene.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/write_text.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// A ball on a painted floor under a sky, seen from above.
std::string scene_of_ball(const std::string& ball) {
    const std::string head =
        "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/><transform name='to_world'>"
        "<lookat origin='0,1,4' target='0,0,0' up='0,1,0'/></transform><film type='hdrfilm'><integer name='width' "
        "value='24'/><integer name='height' value='24'/></film></sensor><emitter type='constant'><rgb name='radiance' "
        "value='.6 .7 .8'/></emitter>";
    const std::string paint = "<bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' value='.5 .4 "
                              ".3'/></bsdf></bsdf></shape>";
    return head + "<shape type='cube'><transform name='to_world'><scale x='4' y='.01' z='4'/><translate y='-1.01'/>" +
           "</transform>" + paint + "<shape type='sphere'><float name='radius' value='.9'/>" + ball +
           "</shape></scene>";
}

/// Compares the mean of a picture with `wanted`, within `error` of it.
void check_mean_of_ball(const std::string& ball, uint32_t max_depth, Rgb wanted, double error) {
    Messages messages;
    Scene scene = read_scene(write_text(scratch_folder() / "scene.xml", scene_of_ball(ball)), {}, messages);
    CHECK(messages.left_out() == std::vector<std::string>{});
    Queue queue = requested_queue();
    RenderSettings settings = square_settings(24, static_cast<uint32_t>(effort(128, 2048)), max_depth);
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0.5f;
    const Image picture = render(queue, scene, scene.cameras.at(0), settings).picture;
    double sum[3] = {};
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        sum[i % picture.channels] += static_cast<double>(picture.pixels[i]) / (24 * 24);
    CHECK(sum[0] == doctest::Approx(wanted.r).epsilon(error));
    CHECK(sum[1] == doctest::Approx(wanted.g).epsilon(error));
    CHECK(sum[2] == doctest::Approx(wanted.b).epsilon(error));
}

const std::string kMilkOfBall =
    "<medium name='interior' type='homogeneous'><rgb name='sigma_t' value='.3333 .66667 1'/>"
    "<float name='scale' value='3'/><rgb name='albedo' value='.9 .8 .5'/><phase type='hg'><float "
    "name='g' value='.4'/></phase></medium>";

} // namespace

TEST_CASE("media in a mask and behind a thin pane look like Mitsuba's") {
    check_mean_of_ball(
        "<bsdf type='mask'><float name='opacity' value='.3'/><bsdf type='twosided'><bsdf type='diffuse'/></bsdf>"
        "</bsdf>" +
            kMilkOfBall,
        29, {0.3941f, 0.4068f, 0.3982f}, 4e-3);
    check_mean_of_ball("<bsdf type='thindielectric'/>" + kMilkOfBall, 29, {0.4326f, 0.4331f, 0.4045f}, 8e-3);
}

TEST_CASE("plastic of less reflection is as bright as Mitsuba's") {
    const auto plastic = [](const char* reflectance) {
        return "<bsdf type='plastic'><rgb name='specular_reflectance' value='" + std::string(reflectance) +
               "'/><rgb name='diffuse_reflectance' value='.9'/></bsdf>";
    };
    check_mean_of_ball(plastic("0"), 5, {0.4270f, 0.4715f, 0.5093f}, 4e-3);
    check_mean_of_ball(plastic(".5 .2 .1"), 5, {0.4343f, 0.4747f, 0.5109f}, 8e-3);
}
