// Invalid options are refused before anything is read, for every front end, and the error names the setting and its
// value.

#include "session/pictures/check_options.h"

#include <doctest/doctest.h>

#include "session/writing/check_outputs.h"
#include "settings/check_settings.h"
#include "settings/setting_table.h"
#include "settings/value_names.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

using Values = std::vector<std::pair<const char*, std::string>>;

PictureOptions options_of(const Values& values) {
    PictureOptions options;
    for (const auto& [name, text] : values) set_value(options, *find_setting(name), {&text, 1});
    return options;
}

std::optional<Error> refusal(const Values& values, uint32_t verb = kRender) {
    return test::thrown_error([&] {
        const PictureOptions options = options_of(values);
        check_options(options, verb);
    });
}

std::optional<Error> refusal_of_outputs(const Values& values, const std::vector<std::string>& names) {
    std::vector<std::string> outputs;
    const std::filesystem::path folder = test::scratch_folder();
    for (const std::string& name : names) outputs.push_back(folder / name);
    Messages messages;
    return test::thrown_error([&] { check_outputs(options_of(values), outputs, messages); });
}

} // namespace

TEST_CASE("incompatible options are refused with the name of one of them") {
    struct Case {
        Values values;
        const char* setting;
        const char* value = "";
        ErrorCode code = ErrorCode::BadInput;
    };
    for (const Case& c : std::vector<Case>{
             {{{"integrator", "radiosity"}, {"solver", "hierarchical"}, {"form_factors", "hemicube"}},
              "form_factors",
              "hemicube"},
             {{{"denoise", "svgf"}, {"max_depth", "0"}}, "denoise", "svgf"},
             {{{"denoise", "svgf"}, {"integrator", "cast"}}, "denoise", "svgf"},
             {{{"denoise", "svgf"}, {"aov", "variance"}}, "denoise", "svgf"},
             {{{"denoise", "oidn"}, {"aov", "distance"}}, "denoise", "oidn"},
             {{{"false_color", "illuminance"}, {"denoise", "svgf"}}, "false_color", "illuminance"},
             {{{"false_color", "illuminance"}, {"integrator", "light"}}, "false_color", "illuminance"},
             {{{"lpe", "a=LE"}, {"integrator", "light"}}, "lpe"},
             {{{"lpe", "a=LE"}, {"denoise", "svgf"}}, "lpe"},
             {{{"aov", "uv"}, {"layers_at", "centre"}}, "layers_at", "centre"},
             {{{"transparent", "true"}, {"ground", "on"}}, "transparent"},
             {{{"view_height", "2"}, {"projection", "perspective"}}, "view_height"},
             {{{"focus", "2"}, {"aperture", "0"}}, "focus"},
             {{{"aperture_blades", "1"}, {"aperture", "0.1"}}, "aperture_blades", "1"},
             {{{"aperture_blades", "2"}}, "aperture_blades", "2"},
             {{{"aperture_blades", "5"}, {"aperture", "0"}}, "aperture_blades"},
             {{{"aperture_rotation", "9"}, {"aperture_blades", "0"}}, "aperture_rotation"},
             {{{"shutter", "0.1"}}, "shutter"},
             {{{"shutter", "0.2,0.1"}, {"time", "1"}}, "shutter", "0.2,0.1"},
             {{{"shutter", "0.1"}, {"time", "1"}, {"turntable", "9"}}, "shutter", "0.1"},
             {{{"shutter", "0.1"}, {"time", "1"}, {"denoise", "svgf"}}, "shutter"},
             {{{"shutter", "0.1"}, {"time", "1"}, {"integrator", "hybrid"}}, "shutter"},
             {{{"real_time", "true"}, {"frames", "0-1"}, {"spp", "4"}}, "spp", "4"},
             {{{"real_time", "true"}, {"frames", "0-1"}, {"integrator", "whitted"}}, "real_time"},
             {{{"frames", "3-2"}}, "frames", "3-2"},
             {{{"exposure", "bright"}}, "exposure", "bright"},
             {{{"false_color", "luminance"}, {"false_color_range", "2,1"}}, "false_color_range", "2,1"},
             {{{"unit", "inch"}}, "unit", "inch"},
             {{{"lamp", "bulb"}}, "lamp", "bulb"},
             {{{"integrator", "hybrid"}, {"aperture", "0.1"}}, "integrator", "hybrid"},
             {{{"integrator", "radiosity"}, {"solution", "nowhere.rad"}}, "solution", "nowhere.rad"},
             {{{"integrator", "whitted"}, {"max_depth", "256"}}, "max_depth", "256", ErrorCode::OverLimit}}) {
        INFO(c.setting);
        CHECK(test::is_about(refusal(c.values), c.code, c.setting, c.value));
    }
}

TEST_CASE("compatible options are accepted") {
    for (const Values& values :
         std::vector<Values>{{},
                             {{"integrator", "radiosity"}, {"solver", "hierarchical"}, {"form_factors", "rays"}},
                             {{"denoise", "none"}, {"max_depth", "0"}},
                             {{"ground", "on"}},
                             {{"transparent", "true"}, {"ground", "off"}},
                             {{"view_height", "2"}, {"projection", "orthographic"}},
                             {{"focus", "2"}},
                             {{"shutter", "0.1"}, {"frames", "0-1"}, {"turntable", "9"}},
                             {{"real_time", "true"}, {"frames", "0-1"}, {"spp", "1"}, {"integrator", "hybrid"}},
                             {{"device", "cpu,cpu"}, {"frames", "0-1"}, {"real_time", "true"}, {"spp", "1"}},
                             {{"denoise", "svgf"}, {"part", "1/2"}},
                             {{"denoise", "none"}, {"integrator", "light"}, {"aov", "distance"}},
                             {{"false_color", "luminance"}, {"integrator", "light"}},
                             {{"real_time", "true"}, {"frames", "0-1"}, {"spp", "1"}, {"moving_depth", "3"}},
                             {{"denoise", "svgf"}, {"samples", "3:9"}, {"device", "cpu,cpu"}},
                             {{"exposure", "auto"}, {"max_memory", "5"}}}) {
        const std::optional<Error> error = refusal(values);
        CHECK_MESSAGE(!error, error->what());
    }
    CHECK(!refusal({{"restir", "di"}, {"integrator", "cast"}},
                   SettingVerbs::kView)); // the panel may choose another integrator
}

TEST_CASE("outputs that coincide, need a frame number or ignore a given setting are refused") {
    using Names = std::vector<std::string>;
    const auto is_refused = [](const Values& values, const Names& names, const char* setting) {
        return test::is_about(refusal_of_outputs(values, names), ErrorCode::BadInput, setting);
    };
    CHECK(is_refused({}, {"a.png", "b.exr", "./a.png"}, "output"));
    CHECK(is_refused({{"frames", "0-1"}}, {"a.png"}, "output"));
    CHECK(is_refused({{"frames", "0-10"}}, {"f-#.png", "f-##.png"}, "output")); // at frame 10
    CHECK(!refusal_of_outputs({{"frames", "8-9"}}, {"f-#.png", "f-##.png"}));
    CHECK(is_refused({{"transparent", "true"}}, {"a.jpg"}, "transparent"));
    CHECK(!refusal_of_outputs({{"transparent", "false"}}, {"a.jpg"}));
    CHECK(is_refused({{"aov", "depth"}}, {"a.png"}, "aov"));
    CHECK(is_refused({{"lpe", "a=LE"}}, {"a.hdr"}, "lpe"));
    CHECK(is_refused({{"exposure", "1"}}, {"a.exr"}, "exposure"));
    CHECK(is_refused({{"tone_map", "agx"}}, {"a.hdr"}, "tone_map"));
    CHECK(is_refused({{"f_number", "2"}, {"shutter_time", "1"}}, {"a.exr"}, "f_number"));
    CHECK(is_refused({{"false_color", "luminance"}}, {"a.exr"}, "false_color"));
    CHECK(!refusal_of_outputs({{"false_color", "illuminance"}}, {"a.exr"}));
    CHECK(is_refused({{"false_color", "luminance"}, {"frames", "0-1"}}, {"f-#.png"}, "false_color"));
    CHECK(!refusal_of_outputs({{"aov", "depth"}, {"exposure", "1"}}, {"a.png", "a.exr"}));
    const auto unwritable = refusal_of_outputs({}, {"a.bmp"});
    REQUIRE(unwritable);
    CHECK(unwritable->location()->file.ends_with("a.bmp"));

    PictureOptions options = options_of({{"aov", "depth"}, {"transparent", "true"}});
    for (auto& [name, origin] : options.given) origin = SettingOrigin::File; // the setting may apply to other outputs
    Messages messages;
    const std::vector<std::string> outputs = {test::scratch_folder() / "a.jpg"};
    CHECK_NOTHROW(check_outputs(options, outputs, messages));
    REQUIRE(messages.all().size() == 1);
    CHECK(messages.all().front().remark.setting == "transparent");
    CHECK(messages.all().front().remark.location->file == outputs.front());
}

TEST_CASE("the rules of lenses name all that see behind, and all panoramas") {
    for (const auto& [lens, name] : kLensModels) {
        CAPTURE(name);
        const auto is_refused = [&](const char* other, const char* text) {
            PictureOptions options = options_of({{"lens", std::string(name)}, {"filter", "box"}, {other, text}});
            const auto conflict = find_conflict(options, kRender);
            return conflict && conflict->setting->name == std::string_view("lens") && conflict->value == name;
        };
        for (const auto& [other, text] : {std::pair("aperture", "0.1"), {"denoise", "svgf"}, {"real_time", "true"}})
            CHECK(is_refused(other, text) == sees_behind(lens));
        for (const auto& [other, text] : {std::pair("fov", "40"), {"eye_offset", "0.1"}, {"stereo", "0.1"}})
            CHECK(is_refused(other, text) == is_panorama(lens));
        CHECK_FALSE(is_refused("aperture", "0"));
        CHECK_FALSE(is_refused("denoise", "oidn"));
    }
}

TEST_CASE("the settings of frames and of motion blur belong to the integrators that have them") {
    for (const IntegratorDescriptor& integrator : integrators()) {
        CHECK(has_setting(integrator.value, *find_setting("real_time")) == integrator.makes_frames);
        CHECK(has_setting(integrator.value, *find_setting("shutter")) == integrator.has_shutter);
    }
}
