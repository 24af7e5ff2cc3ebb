#include "apps/cli/reporter.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "apps/cli/flag_phrases.h"
#include "apps/cli/interrupt.h"
#include "base/error.h"

namespace pertev {
namespace {

void write_now(std::FILE* file, const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), file); // main checks stdout for errors at the end
    std::fflush(file);
}

/// Returns whether stderr is a terminal that obeys escape sequences.
bool is_drawn_on() {
    const char* const kind = std::getenv("TERM");
    return ::isatty(STDERR_FILENO) == 1 && kind != nullptr && std::string_view(kind) != "dumb";
}

} // namespace

void add_report_flags(CLI::App& verb, ReportFlags& flags) {
    verb.add_flag("-q,--quiet", flags.quiet, "prints only errors");
    verb.add_flag("--json", flags.json,
                  "prints one JSON object per line on stdout, errors included, and\nnothing else");
}

void add_progress_flag(CLI::App& verb, ReportFlags& flags) {
    verb.add_option("--progress", flags.progress, "progress as one JSON object per line on stderr")
        ->type_name("json")
        ->check(one_of({"json"}));
}

Reporter::Reporter(const ReportFlags& flags) : flags_(flags), redraws_(flags.progress.empty() && is_drawn_on()) {
    if (is_silent() || redraws_ || !flags.progress.empty()) return;
    heartbeat_ = std::make_unique<Heartbeat>(std::chrono::seconds(10), [](double seconds, const std::string& work) {
        write_now(stderr, fmt::format("{:.0f} s: {}\n", seconds, work));
    });
}

Reporter::~Reporter() {
    end_progress();
    try {
        report_messages();
    } catch (const std::bad_alloc&) { // the error that exhausted memory matters more
    }
}

void Reporter::report_messages() {
    for (; reported_ < all().size(); ++reported_) {
        const Message& message = all()[reported_];
        if (flags_.json && !flags_.quiet) {
            event(fmt::format(R"({{"event":"{}","text":{},"times":{}{}}})", message.is_warning ? "warning" : "notice",
                              json_string(phrase(message.remark)), message.times, json_parts(message.remark)));
        } else {
            print(fmt::format("{}: {}{}", message.is_warning ? "warning" : "note", phrase(message.remark),
                              message.times > 1 ? fmt::format(" ({} times)", message.times) : ""));
        }
    }
}

bool Reporter::should_stop() { return interrupted(); }

void Reporter::print(const std::string& line) {
    if (is_silent()) return;
    end_progress();
    write_now(stderr, prefix() + line + '\n');
}

void Reporter::progress(const Progress& now) {
    constexpr double often_s = 0.1; // the bar is redrawn at most this often
    const bool is_soon = now.seconds >= shown_at_s_ && now.seconds - shown_at_s_ < often_s;
    if (now.samples == 0 && now.doing == shown_step_ && is_soon && now.share < 1) return; // a render reports seldom
    shown_step_ = now.doing, shown_at_s_ = now.seconds;
    const bool is_render = now.samples > 0, is_made = now.made_share >= 1;
    std::string detail = !is_render ? now.doing
                         : is_made  ? fmt::format("{}/{} spp", now.samples_done, now.samples)
                                    : "before the first sample";
    if (now.share_of_step > 0) detail += fmt::format(" ({:.0f} %)", 100 * now.share_of_step);
    if (is_render) {
        detail += fmt::format("  {:.1f} Mrays/s", static_cast<double>(now.rays) / std::max(now.seconds, 1e-9) * 1e-6);
    }
    if (now.seconds_left) detail += fmt::format("{}{:.0f} s left", is_render ? "  " : ", ", *now.seconds_left);
    progress(now.share, detail);
    std::string members = fmt::format(R"("seconds":{:.3f},"step":{},"share":{:.4f},"seconds_left":{})", now.seconds,
                                      json_string(now.doing), now.share,
                                      now.seconds_left ? fmt::format("{:.3f}", *now.seconds_left) : "null");
    if (now.share_of_step > 0) members += fmt::format(R"(,"share_of_step":{:.4f})", now.share_of_step);
    if (is_render)
        members += fmt::format(R"(,"samples":{},"of":{},"rays":{})", now.samples_done, now.samples, now.rays);
    if (!part_.empty()) members += fmt::format(R"(,"part":{})", json_string(part_));
    const std::string object = fmt::format(R"({{"event":"progress",{}}})", members);
    event(object);
    if (!flags_.progress.empty()) write_now(stderr, object + '\n');
}

void Reporter::progress(double share, const std::string& detail) {
    if (!redraws_) set_work(fmt::format("{:.0f} %  {}", 100 * share, detail)); // it is phrased there
    if (is_silent() || !redraws_) return;
    constexpr int width = 24;
    const int full = std::clamp(static_cast<int>(share * width), 0, width);
    write_now(stderr, fmt::format("\r{}[{:=<{}}{: <{}}] {:3.0f} %  {}\x1b[K", prefix(), "", full, "", width - full,
                                  100 * share, phrase(detail)));
    drawn_ = true;
}

void Reporter::set_work(const std::string& work) {
    if (heartbeat_) heartbeat_->set_work(prefix() + phrase(work));
}

void Reporter::event(const std::string& object) {
    if (flags_.json) write_now(stdout, object + '\n');
}

void Reporter::result(const std::string& object) {
    std::vector<std::string> made_up, left_out, warnings;
    for (const Message& message : all()) {
        if (message.is_made_up) made_up.push_back(phrase(message.remark));
        if (message.is_warning) (message.is_left_out ? left_out : warnings).push_back(phrase(message.remark));
    }
    event(fmt::format(R"({},"made_up":{},"left_out":{},"warnings":{}}})",
                      std::string_view(object).substr(0, object.size() - 1), json_strings(made_up),
                      json_strings(left_out), json_strings(warnings)));
}

void Reporter::answer(const std::string& lines) {
    if (!is_silent()) write_now(stdout, lines);
}

void Reporter::output(const std::string& path, const std::string& why_not) {
    event(fmt::format(R"({{"event":"output","path":{},"written":{},"error":{}}})", json_string(path), why_not.empty(),
                      why_not.empty() ? "null" : json_string(why_not)));
}

void Reporter::write_output(const std::string& path, const std::function<void()>& write) {
    try {
        write();
    } catch (const Error& error) {
        output(path, phrase(error.remark()));
        throw;
    }
    output(path);
}

void Reporter::set_part(std::string part) { part_ = std::move(part); }

void Reporter::end_progress() {
    if (!drawn_) return;
    write_now(stderr, "\n");
    drawn_ = false;
}

} // namespace pertev
