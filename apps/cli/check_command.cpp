// pertev check SCENE: lists what a render would omit from a scene, and which defaults it would add.

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/commands.h"
#include "apps/cli/flag_phrases.h"
#include "apps/cli/reporter.h"
#include "apps/cli/scene_options.h"
#include "apps/cli/setting_flags.h"
#include "session/opening/moving_camera.h"
#include "session/opening/open_scene.h"

namespace pertev {
namespace {

constexpr int kIsIncomplete = 1; // exit status

struct CheckFlags : PictureOptions {
    SettingFlags settings;
    ReportFlags report;
};

const char* kind_of(const Message& message) {
    if (message.is_left_out) return "left out";
    if (message.is_made_up) return "added by default";
    return message.is_warning ? "warning" : "note";
}

int check(CheckFlags& flags) {
    Reporter reporter(flags.report);
    flags.settings.read(flags, reporter);
    Messages messages;
    const Scene scene = open_scene(flags.scene, messages, SceneUse::Picture, Ground::Auto);
    MovingCamera(flags.scene.camera, std::nullopt, scene, 1, messages); // adds the view of a scene without a camera
    bool is_complete = true;
    std::string lines;
    for (const Message& message : messages.all()) {
        is_complete = is_complete && !message.is_left_out && !message.is_made_up;
        lines += fmt::format("{:17} {}{}\n", kind_of(message), phrase(message.remark),
                             message.times > 1 ? fmt::format(" ({} times)", message.times) : "");
    }
    if (flags.report.json) {
        reporter.add_all(messages);
        reporter.report_messages();
    }
    reporter.result(
        fmt::format(R"({{"event":"check","file":{},"complete":{}}})", json_string(flags.scene.scene), is_complete));
    reporter.answer(lines + (is_complete ? "nothing is left out or added by default\n" : ""));
    return is_complete ? 0 : kIsIncomplete;
}

} // namespace

void add_check_command(CLI::App& app, int& status) {
    CLI::App& verb =
        *app.add_subcommand("check", "List what a render would omit from a scene, and which defaults it would add");
    const auto flags = std::make_shared<CheckFlags>();
    add_scene_name(verb, flags->scene);
    flags->settings.add(verb, kCheck, *flags);
    add_report_flags(verb, flags->report);
    verb.footer("The exit status is 1 if anything is left out or added by default.");
    verb.callback([flags, &status] { status = check(*flags); });
}

} // namespace pertev
