#include <algorithm>
#include <filesystem>
#include <set>

#include <doctest/doctest.h>

#include "base/error.h"
#include "image/image_format.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "integrators/raster/raster_settings.h"
#include "session/writing/picture_metadata.h"
#include "settings/check_settings.h"
#include "settings/settings_file.h"
#include "settings/value_names.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace {

void set(PictureOptions& options, const char* name, std::vector<std::string> texts) {
    set_value(options, *find_setting(name), texts);
}

std::optional<ErrorCode> code_of(const char* name, const std::string& text) {
    PictureOptions options;
    try {
        set(options, name, {text});
    } catch (const Error& error) {
        return error.code();
    }
    return std::nullopt;
}

} // namespace

TEST_CASE("each setting has a unique name, a sentence, and rules that name settings") {
    std::set<std::string> names;
    for (const Setting& setting : all_settings()) {
        INFO(setting.name);
        CHECK(names.insert(setting.name).second);
        if (*setting.old_name != '\0') CHECK(names.insert(setting.old_name).second);
        const std::string sentence = setting.sentence;
        CHECK(sentence.size() > 10);
        CHECK((sentence.ends_with('.') || sentence.ends_with(").")));
        CHECK(setting.verbs != 0);
        PictureOptions options;
        options.given[setting.name] = SettingOrigin::Caller;
        CHECK_NOTHROW(find_conflict(options, ~0u)); // its rules name existing settings
    }
    CHECK(find_setting("max-depth") == nullptr);
}

TEST_CASE("rules for some values of a setting name values that it has") {
    for (const Setting& setting : all_settings()) {
        std::vector<std::string> rules = words_of(setting.excludes);
        if (!setting.integrators_of.empty()) rules.push_back(std::string(setting.integrators_of) + ':');
        for (std::string values : rules) {
            INFO(setting.name << ": " << values);
            values.resize(values.find(':') != std::string::npos ? values.find(':') : 0);
            std::ranges::replace(values, ',', ' ');
            for (const std::string& value : words_of(values.starts_with('!') ? values.substr(1) : values)) {
                const std::vector<std::string> known = choices_of(setting);
                CHECK(std::ranges::find(known, value) != known.end());
            }
        }
    }
}

TEST_CASE("groups of settings stand together, in the order of their names") {
    std::vector<SettingGroup> groups;
    for (const Setting& setting : all_settings()) {
        if (groups.empty() || groups.back() != setting.group) groups.push_back(setting.group);
    }
    CHECK(std::ranges::equal(groups, kValuesOf<SettingGroup>));
}

TEST_CASE("each kept setting with a file says where in its text the path is") {
    for (const Setting& setting : all_settings()) {
        INFO(setting.name);
        const std::string_view form = setting.form;
        const HoldsFile holds = !setting.is_kept || form.find("FILE") == form.npos ? HoldsFile::No
                                : form.find("=FILE") != form.npos                  ? HoldsFile::Named
                                                                                   : HoldsFile::Whole;
        CHECK(setting.holds_file == holds);
        if (setting.may_be_numbers)
            CHECK(
                std::holds_alternative<std::string*>(read_field({}, setting, [](auto f) { return SettingField(f); })));
    }
}

TEST_CASE("settings of PNG and JPEG change the display alone, and irradiance records do not depend on those") {
    const uint32_t toned = bit_of(ImageFormat::Png) | bit_of(ImageFormat::Jpeg);
    const auto is_after_records = [](const Setting& setting) {
        return setting.is_after_records || setting.changes == Changes::Display;
    };
    for (const Setting& setting : all_settings()) {
        if (!setting.is_kept) continue;
        INFO(setting.name);
        if (setting.formats != 0 && (setting.formats & ~toned) == 0) CHECK(setting.changes == Changes::Display);
        const std::vector<std::string> needs = words_of(setting.needs);
        const auto needs_only = [&](auto has) {
            return !needs.empty() && std::ranges::all_of(needs, [&](const std::string& other) {
                return has(*find_setting(other.substr(0, other.find('='))));
            });
        };
        if (needs_only([](const Setting& s) { return s.changes == Changes::Display; }))
            CHECK(setting.changes == Changes::Display);
        if (needs_only(is_after_records)) CHECK(is_after_records(setting));
    }
}

TEST_CASE("an error about a value names the setting, the value and what is expected") {
    const auto thrown = [](const char* name, const std::string& text) {
        PictureOptions options;
        const Error error = test::thrown_error([&] { set(options, name, {text}); }).value();
        CHECK(!options.is_given(name));
        CHECK(error.setting() == name);
        CHECK(error.value() == text);
        CHECK(!error.reason().starts_with(text)); // front ends state the setting once
        return error;
    };
    for (const auto& [name, text] : std::initializer_list<std::pair<const char*, const char*>>{
             {"spp", "0"}, {"integrator", "pathh"}, {"fov", "wide"}, {"size", "12by9"}, {"eye", "1,2"}}) {
        CHECK(thrown(name, text).code() == ErrorCode::BadInput);
    }
    CHECK(thrown("integrator", "pathh").reason().find("path, ") != std::string::npos); // the existing names
    CHECK(thrown("size", "12by9").reason().find("WIDTHxHEIGHT") != std::string::npos);
    CHECK(thrown("eye", "1e30,0,0").code() == ErrorCode::OverLimit);
}

TEST_CASE("the recorded settings of a picture include those set by a program") {
    PictureOptions options;
    set(options, "eye", {"1,2,3"});
    CHECK(options.given.at("eye") == SettingOrigin::Caller);
    CHECK(settings_json(options, "", all_settings()).find(R"("eye":[1,2,3])") != std::string::npos);
}

TEST_CASE("a setting's text parses back to its value") {
    for (const Setting& setting : all_settings()) {
        INFO(setting.name);
        PictureOptions options;
        const std::vector<std::string> now = texts_of(options, setting);
        if (now.empty() || now.front().empty() || !why_no_value(setting, now.front()).empty()) continue;
        set_value(options, setting, now);
        CHECK(texts_of(options, setting) == now);
        for (const std::string& choice : choices_of(setting)) {
            set_value(options, setting, {&choice, 1});
            CHECK(texts_of(options, setting) == std::vector{choice});
        }
    }
}

TEST_CASE("reading settings leaves the options as they are, so that threads may read them at once") {
    PictureOptions options;
    options.render.photon_map.edit().photons = 7;
    const PictureOptions copy = options;
    const auto* const shared = &*copy.render.photon_map;
    const auto* const none = &*copy.render.display;
    for (const Setting& setting : all_settings()) {
        INFO(setting.name);
        json_of(copy, setting);
        recorded_settings(copy, {&setting, 1});
        CHECK(&*copy.render.photon_map == shared);
        CHECK(&*copy.render.display == none);
    }
    CHECK(json_of(copy, *find_setting("photons")) == "7");
}

TEST_CASE("invalid values are refused, and too large ones exceed a limit") {
    CHECK(code_of("spp", "0") == ErrorCode::BadInput);
    CHECK(code_of("spp", "1.5") == ErrorCode::BadInput);
    CHECK(code_of("fov", "180") == ErrorCode::BadInput);
    CHECK(code_of("fov", "nan") == ErrorCode::BadInput);
    CHECK(code_of("clamp", "0") == ErrorCode::BadInput);
    CHECK(code_of("sampler", "halton") == ErrorCode::BadInput);
    CHECK(code_of("integrator", "paths") == ErrorCode::BadInput);
    CHECK(code_of("animation", "") == ErrorCode::BadInput);
    CHECK(code_of("eye", "1,2") == ErrorCode::BadInput);
    CHECK(code_of("size", "8") == ErrorCode::BadInput);
    CHECK(code_of("eye", "1,2,2e12") == ErrorCode::OverLimit);
    CHECK(code_of("size", "65537x1") == ErrorCode::OverLimit);
    CHECK(!code_of("eye", "1,-2e0,.5"));
    CHECK(!code_of("seed", "4294967295"));
    CHECK(code_of("camera_pose", "1,0,0,0,1,0,0,0,1") == ErrorCode::BadInput); // nine numbers
    CHECK(code_of("intrinsics", "1,2,3") == ErrorCode::BadInput);
    CHECK(code_of("distortion", "0,0,0,nan") == ErrorCode::BadInput);
    CHECK(code_of("distortion", "0,0,0,1e60") == ErrorCode::BadInput);
    CHECK(!code_of("distortion", "-0.1,0,1e-3,0,2"));
    CHECK(code_of("structure", "sah") == ErrorCode::BadInput);
    CHECK(code_of("structure", "camera=sah") == ErrorCode::BadInput);
    CHECK(code_of("structure", "sight=binned") == ErrorCode::BadInput);
    CHECK(!code_of("structure", "shadow=binned"));
}

TEST_CASE("integrators name the settings that only they have") {
    using Names = std::vector<std::string>;
    CHECK(integrators_with(*find_setting("ambient")) == Names{"cast", "whitted", "raster", "reyes"});
    CHECK(integrators_with(*find_setting("clamp")) == Names{"path", "direct", "indirect", "hybrid"});
    CHECK(integrators_with(*find_setting("link_error")) == Names{"radiosity"});
    CHECK(integrators_with(*find_setting("spp")) == integrator_names());
}

TEST_CASE("conflicting settings are found") {
    PictureOptions options;
    CHECK(!find_conflict(options, kRender));
    set(options, "photons", {"4"});
    auto conflict = find_conflict(options, kRender);
    REQUIRE(conflict);
    CHECK(conflict->kind == SettingConflict::Kind::Integrator);
    CHECK(conflict->others == std::vector<std::string>{"photon_map"});
    set(options, "integrator", {"photon_map"});
    CHECK(!find_conflict(options, kRender));
    set(options, "fps", {"30"});
    conflict = find_conflict(options, kRender);
    REQUIRE(conflict);
    CHECK(conflict->setting->name == std::string("fps"));
    CHECK(conflict->kind == SettingConflict::Kind::Needs);
    CHECK(!find_conflict(options, kView)); // this integrator has no real-time frames
    set(options, "frames", {"1-2"});
    CHECK(!find_conflict(options, kRender));
    set(options, "time", {"1"});
    conflict = find_conflict(options, kRender);
    REQUIRE(conflict);
    CHECK(conflict->kind == SettingConflict::Kind::Excludes);
}

TEST_CASE("a conflict is an error about the setting, whose reason names the others") {
    const auto refusal = [](const PictureOptions& options) {
        return test::thrown_error([&] { check_settings(options, kRender); });
    };
    PictureOptions options;
    CHECK(!refusal(options));
    set(options, "clamp", {"1"});
    set(options, "integrator", {"light"});
    auto error = refusal(options);
    REQUIRE(test::is_about(error, ErrorCode::BadInput, "clamp"));
    CHECK(error->reason().find("`integrator=path`") != std::string::npos);
    set(options, "integrator", {"path"});
    set(options, "denoise", {"svgf"});
    CHECK(!refusal(options));
    set(options, "max_depth", {"0"}); // excludes only one value of `denoise`
    error = refusal(options);
    REQUIRE(test::is_about(error, ErrorCode::BadInput, "denoise", "svgf"));
    CHECK(error->reason().find("`max_depth=0`") != std::string::npos);
    set(options, "shutter", {"0.1"});
    set(options, "time", {"1"});
    set(options, "max_depth", {"1"});
    error = refusal(options); // excludes every denoiser, and names the one that was set
    REQUIRE(test::is_about(error, ErrorCode::BadInput, "shutter"));
    CHECK(error->reason().find("`denoise=svgf`") != std::string::npos);
    set(options, "denoise", {"none"});
    CHECK(!refusal(options));
    set(options, "fps", {"9"});
    error = refusal(options);
    REQUIRE(test::is_about(error, ErrorCode::BadInput, "fps"));
    CHECK(error->reason() == "needs `frames`");
}

TEST_CASE("a file's settings are dropped if they conflict with given ones") {
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "pertev-settings-to-combine.json";
    test::write_text(file, R"({"version":1,"settings":{"integrator":"photon_map","photons":5,"spp":3,"time":1}})");
    const auto combine = [&](const SetOthers& others) {
        PictureOptions options;
        Messages messages;
        combine_settings(file, kRender, others, options, messages);
        return options;
    };
    const PictureOptions options = combine([](PictureOptions& all) {
        set(all, "integrator", {"path"});
        set(all, "frames", {"0-1"});
    });
    CHECK(options.render.samples == 3);
    CHECK(!options.is_given("photons"));
    CHECK(!options.is_given("time"));
    CHECK(options.frames == "0-1");
    const auto error = test::thrown_error([&] { combine([](PictureOptions& all) { set(all, "accuracy", {"0.5"}); }); });
    CHECK(test::is_about(error, ErrorCode::BadInput, "accuracy")); // no file sets this
}

TEST_CASE("settings survive writing to JSON and reading back") {
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "pertev-settings-test.json";
    PictureOptions options;
    options.scene.scene = "cornell-box";
    set(options, "spp", {"3"});
    set(options, "eye", {"0.1,2,3.5"});
    set(options, "aov", {"normal", "depth"});
    set(options, "transparent", {"true"});
    set(options, "no_anti_alias", {"true"});
    set(options, "tone_map", {"aces"});
    set(options, "intrinsics", {"500.125,500,10,20"});
    set(options, "lpe", {"a=LD+E", "b=L<'la\"mp'>.*E"});
    set(options, "device", {"cpu"});
    const std::string json = settings_json(options, scene_hash("cornell-box"));
    CHECK(json.find("\"device\"") == std::string::npos); // the picture does not depend on this setting
    CHECK(json.find("\"eye\":[0.1,2,3.5]") != std::string::npos);
    CHECK(json.find("\"intrinsics\":[500.125,500,10,20]") != std::string::npos);
    test::write_text(file, json);
    PictureOptions read;
    read.scene.scene = "cornell-box";
    Messages messages;
    read_settings(file, kRender, {}, read, messages);
    CHECK(messages.all().empty());
    CHECK(settings_json(read, scene_hash("cornell-box")) == json);
    CHECK(read.given.at("spp") == SettingOrigin::File);

    SUBCASE("names of earlier versions are read, and written as current names") {
        test::write_text(file, R"({"version":1,"settings":{"no_history_limit":true,"no_follow_light":true}})");
        PictureOptions old;
        const std::vector<std::string> overruled = {"no_temporal_gradients"};
        read_settings(file, kRender, overruled, old, messages);
        CHECK(messages.all().empty());
        CHECK(!old.reconstruction.settings.clamp_history);
        CHECK(old.reconstruction.settings.temporal_gradients);
        CHECK(old.given.size() == 1);
        CHECK(old.is_given("no_history_clamping"));
        CHECK(settings_json(old, "").find("\"no_history_clamping\":true") != std::string::npos);
    }
    SUBCASE("a matrix may be an array of rows") {
        test::write_text(file, R"({"version":1,"settings":{"camera_pose":[[1,0,0,2],[0,1,0,3],[0,0,1,4.5]]}})");
        PictureOptions posed;
        read_settings(file, kRender, {}, posed, messages);
        CHECK(posed.scene.camera.pose == std::vector<double>{1, 0, 0, 2, 0, 1, 0, 3, 0, 0, 1, 4.5});
    }
    SUBCASE("another scene is reported") {
        read.scene.scene = "many-lights";
        read_settings(file, kRender, {}, read, messages);
        CHECK(messages.all().size() == 1);
    }
    SUBCASE("an unknown setting is left out with a warning, and an invalid value is refused") {
        test::write_text(file, R"({"version":1,"settings":{"spp":5,"sppp":4,"device":"cpu"},"more":0})");
        read_settings(file, kRender, {}, read, messages);
        CHECK(messages.left_out().size() == 3);
        CHECK(read.render.samples == 5);
        for (const char* text :
             {R"({"version":1,"settings":{"spp":"many"}})", R"({"version":1,"settings":{"eye":[1,2]}})",
              R"({"version":2,"settings":{}})", R"({"settings":{}})", "[]", "{"}) {
            test::write_text(file, text);
            CHECK_THROWS_AS(read_settings(file, kRender, {}, read, messages), Error);
        }
        test::write_text(file, R"({"version":1,"settings":{"spp":"many"}})");
        const auto error = test::thrown_error([&] { read_settings(file, kRender, {}, read, messages); });
        REQUIRE(test::is_about(error, ErrorCode::BadInput, "spp", "many"));
        CHECK(error->location()->pointer == "/settings/spp");
    }
}

TEST_CASE("a picture's file records each setting of the table that the integrator has") {
    PictureOptions options;
    set(options, "integrator", {"whitted"});
    set(options, "ambient", {"0.5"});
    const ExrMetadata metadata = recorded_settings(options, all_settings());
    const auto has = [&](const std::string& name) {
        return std::ranges::find(metadata, name, &ExrMetadata::value_type::first) != metadata.end();
    };
    CHECK(has("pertev.max_depth"));
    CHECK(has("pertev.ambient"));
    CHECK(!has("pertev.photons"));
    CHECK(!has("pertev.denoise")); // it has the default
}
TEST_CASE("a scene file's suggestions hold unless a given setting excludes them") {
    Scene scene;
    scene.suggested = {{"spp", "64"},       {"size", "320x240"},     {"integrator", "photon_map"},
                       {"photons", "1000"}, {"seed", "7"},           {"sampler", "none such"},
                       {"samples", "1"},    {"transparent", "true"}, {"ambient", "1"}};
    PictureOptions options;
    options.given["seed"] = SettingOrigin::Caller;
    options.render.path.seed = 3;
    Messages messages;
    apply_suggestions(scene, nullptr, kRender, options, messages);
    CHECK(options.render.samples == 64);
    CHECK(options.size == PictureSize{320, 240});
    CHECK(options.render.integrator == IntegratorKind::PhotonMap);
    CHECK(options.given.at("photons") == SettingOrigin::Scene);
    CHECK(options.render.path.seed == 3);
    CHECK(options.given.at("seed") == SettingOrigin::Caller);
    CHECK_FALSE(options.is_given("ambient")); // photon mapping lacks this setting
    REQUIRE(messages.left_out().size() == 3); // an unknown sampler, an unknown setting, and one that comes too late
    CHECK(messages.all()[0].remark.setting == "sampler");
    CHECK(messages.all()[0].remark.value == "none such");
    CHECK_FALSE(options.render.transparent);

    PictureOptions real_time;
    real_time.real_time = true;
    real_time.render.samples = 1;
    apply_suggestions(scene, nullptr, kRender, real_time, messages);
    CHECK(real_time.render.samples == 1);

    PictureOptions whitted;
    whitted.render.integrator = IntegratorKind::Whitted;
    whitted.given["integrator"] = SettingOrigin::File;
    apply_suggestions(scene, nullptr, kRender, whitted, messages);
    CHECK(whitted.render.integrator == IntegratorKind::Whitted);
    CHECK_FALSE(whitted.is_given("photons"));
    CHECK(whitted.given.at("ambient") == SettingOrigin::Scene);
}
TEST_CASE("a suggestion for one camera holds for pictures of that camera alone") {
    Scene scene;
    scene.cameras.resize(3);
    scene.cameras[1].name = "B@";
    scene.suggested = {{"size", "320x240"}, {"spp", "64"}, {"size@B@", "40x20"}};
    const auto size_of = [&](const Camera* own, bool is_given = false) {
        PictureOptions options;
        if (is_given) options.size = {7, 5}, options.given["size"] = SettingOrigin::Caller;
        apply_suggestions(scene, own, kRender, options, nobody());
        CHECK(options.render.samples == 64);
        return options.size.value();
    };
    CHECK(size_of(nullptr) == PictureSize{320, 240});
    CHECK(size_of(&scene.cameras[0]) == PictureSize{320, 240});
    CHECK(size_of(&scene.cameras[1]) == PictureSize{40, 20});
    CHECK(size_of(&scene.cameras[1], true) == PictureSize{7, 5});
}
