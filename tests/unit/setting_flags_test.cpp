#include "apps/cli/setting_flags.h"

#include <doctest/doctest.h>

#include <CLI/CLI.hpp>

#include "apps/cli/help.h"
#include "base/error.h"

using namespace pertev;

TEST_CASE("flags override options, and a switch that is turned off counts as not given") {
    PictureOptions options;
    CLI::App app("A program", "program");
    SettingFlags flags;
    flags.add(app, kRender, options);
    app.parse("--spp 3 --aov normal,depth --aov ids --transparent=false --false-color luminance --no-anti-alias=false");
    Messages messages;
    flags.read(options, messages); // false colours exclude alpha
    CHECK(options.render.samples == 3);
    CHECK(options.aovs == std::vector<std::string>{"normal", "depth", "ids"});
    CHECK(!options.render.transparent);
    CHECK(options.reconstruction.settings.anti_alias);
    CHECK(options.is_given("spp"));
    CHECK(!options.is_given("seed"));
}

TEST_CASE("a renamed flag is accepted under its old name, which help and completion hide") {
    for (const char* line : {"--frames 0-1 --real-time --traversal shadow=wide8 --no-history-clamping",
                             "--frames 0-1 --real-time --walk shadow=wide8 --no-history-limit"}) {
        PictureOptions options;
        CLI::App app("A program", "program");
        SettingFlags flags;
        flags.add(app, kRender, options);
        app.parse(line);
        Messages messages;
        flags.read(options, messages);
        CHECK(options.tracer.traversals == std::vector<std::string>{"shadow=wide8"});
        CHECK(!options.reconstruction.settings.clamp_history);
        CHECK(options.is_given("traversal"));
        const std::string help = Help("all").make_help(&app, "", CLI::AppFormatMode::Normal);
        CHECK(help.find("--traversal") != std::string::npos);
        CHECK(help.find("--walk") == std::string::npos);
        CHECK(completion(app, "bash").find("--walk") == std::string::npos);
    }
}

TEST_CASE("a verb's own defaults replace those of the table in its help") {
    CLI::App app("A program", "program");
    SettingFlags flags;
    flags.add(app, kLab, PictureOptions(), all_settings(), {{"size", "7x5"}});
    const std::string help = Help("").make_help(&app, "", CLI::AppFormatMode::Normal);
    CHECK(help.find("(7x5)") != std::string::npos);
    CHECK(help.find("1280x720") == std::string::npos);
}

TEST_CASE("the word after --help names a group of flags") {
    std::vector<std::string> words = {"render", "--help", "Camera"};
    CHECK(take_help_group(words) == "camera");
    CHECK(words == std::vector<std::string>{"render", "--help"});
    words = {"--help", "render"};
    CHECK(take_help_group(words) == "");
    CHECK(words.size() == 2);
    words = {"render", "-h", "cornell-box"};
    CHECK_THROWS_WITH_AS(take_help_group(words), doctest::Contains("all, "), Error);
}
