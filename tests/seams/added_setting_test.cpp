#include <algorithm>
#include <array>

#include <doctest/doctest.h>

#include <CLI/CLI.hpp>

#include "apps/cli/help.h"
#include "apps/cli/setting_flags.h"
#include "apps/viewer/view_state.h"
#include "session/writing/picture_metadata.h"
#include "settings/settings_file.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

TEST_CASE("a setting added by one row appears as a flag and in help, JSON, metadata and the panel") {
    const std::vector<Setting> table = {row("roulette_depth", "Quality", "N",
                                            PERTEV_SETTING_FIELD(render.path.roulette_depth),
                                            "Russian roulette begins at this vertex.", Range{1, 99}, Recorded::Always,
                                            Panel{"Roulette", PanelGroup::Light, 2})};
    PictureOptions options;
    CLI::App app("A program", "program");
    app.formatter(std::make_shared<Help>(""));
    CLI::App& verb = *app.add_subcommand("render", "A verb");
    SettingFlags flags;
    flags.add(verb, kRender, options, table);
    CHECK(verb.help().find("--roulette-depth N") != std::string::npos);
    CHECK(verb.help().find("begins at this vertex") != std::string::npos);
    CHECK(verb.help().find("(3)") != std::string::npos); // its default
    Messages messages;
    app.parse("render --roulette-depth 0");
    CHECK(test::is_about(test::thrown_error([&] { flags.read(options, messages); }), ErrorCode::BadInput,
                         "roulette_depth", "0"));
    app.parse("render --roulette-depth 5");
    flags.read(options, messages);
    CHECK(options.render.path.roulette_depth == 5);
    CHECK(settings_json(options, "", table).find(R"("settings":{"roulette_depth":5})") != std::string::npos);
    const ExrMetadata metadata = recorded_settings(options, table);
    REQUIRE(metadata.size() == 1);
    CHECK(metadata[0].first == "pertev.roulette_depth");
    CHECK(std::get<int32_t>(metadata[0].second) == 5);
    const std::vector<ViewSetting> panel = make_view_settings(table), own = make_view_settings({});
    const auto row = std::ranges::find(panel, std::string_view("roulette_depth"), &ViewSetting::name);
    REQUIRE(panel.size() == own.size() + 1);
    REQUIRE(row != panel.end());
    CHECK(row->label == std::string("Roulette"));
    CHECK(row->kind == ViewSetting::Kind::Whole);
    CHECK(std::array{row->low, row->high, row->step} == std::array{1.0, 99.0, 2.0});
    ViewState view;
    CHECK(row->set(view, 7.0).empty());
    CHECK(std::get<double>(row->get(view)) == 7);
    CHECK(view.options.render.path.roulette_depth == 7);
    CHECK(restarts({}, view));
}
