// Remarks and errors: their parts, their text, and how front ends phrase the settings in it.

#include <doctest/doctest.h>

#include "apps/viewer/panel_phrases.h"
#include "base/phrase_settings.h"
#include "base/sink.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

std::string in_brackets(const std::string& text) {
    return phrase_settings(text, [](std::string_view name, std::string_view value) {
        return '[' + std::string(name) + (value.empty() ? "" : " ") + std::string(value) + ']';
    });
}

} // namespace

TEST_CASE("an error keeps its parts, and its text contains them") {
    const auto of_setting = test::thrown_error(
        [] { throw Error(ErrorCode::OverLimit, "max_depth", "20", "with `integrator=cast` at most 12"); });
    REQUIRE(test::is_about(of_setting, ErrorCode::OverLimit, "max_depth", "20"));
    CHECK(of_setting->reason() == "with `integrator=cast` at most 12");
    CHECK(of_setting->what() == std::string("`max_depth=20`: with `integrator=cast` at most 12"));
    CHECK_FALSE(of_setting->location());
    const Error of_line(ErrorCode::BadInput, FileLocation{"a.obj", 12}, "no face");
    CHECK(of_line.what() == std::string("a.obj:12: no face"));
    CHECK(of_line.location() == FileLocation{"a.obj", 12});
    CHECK(of_line.setting().empty());
    const Error of_value(ErrorCode::BadInput, FileLocation{.file = "a.gltf", .pointer = "/nodes/3"}, "no node");
    CHECK(of_value.what() == std::string("a.gltf: /nodes/3: no node"));
    CHECK(Error(ErrorCode::BadInput, FileLocation{.file = "a.gltf", .pointer = ""}, "empty").what() ==
          std::string("a.gltf: /: empty"));
    CHECK(Error(ErrorCode::FileWrite, FileLocation{"a.png"}, "full").what() == std::string("a.png: full"));
    CHECK(Error(ErrorCode::BadInput, "plain").what() == std::string("plain"));
}

TEST_CASE("a message keeps the parts of an error, and repeats of it are counted") {
    Messages messages;
    const Error error(ErrorCode::BadInput, FileLocation{"a.obj", 12}, "no face");
    for (int i = 0; i < 2; ++i) messages.leave_out(error.remark().and_then("; it is left out"));
    messages.leave_out({FileLocation{"a.obj", 13}, "no face; it is left out"});
    REQUIRE(messages.all().size() == 2);
    CHECK(messages.all()[0].times == 2);
    CHECK(messages.all()[0].remark.location == error.location());
    CHECK(messages.all()[0].remark.reason == "no face; it is left out");
    Messages others;
    others.add_all(messages);
    CHECK(others.all()[1].remark.location == FileLocation{"a.obj", 13});
}

TEST_CASE("settings between backquotes are phrased, and the rest of a text is unchanged") {
    CHECK(in_brackets("say `fov`, or `projection=orthographic`") == "say [fov], or [projection orthographic]");
    CHECK(in_brackets("`eye=0,1,3` `lpe=a=LE`") == "[eye 0,1,3] [lpe a=LE]");
    CHECK(in_brackets("`` `Ply` `a b` `open `fov` last`") == "`` `Ply` `a b` `open [fov] last`");
    CHECK(in_brackets("").empty());
}

TEST_CASE("the viewer names the row of a setting, or the setting in plain words") {
    CHECK(panel_phrase(Remark("integrator", "cast", "`allow_path=/a` shows it")) ==
          "\"Integrator\" cast: allow path /a shows it");
}
