#include "apps/cli/reporter.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

namespace pertev {

std::string json_string(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            out += '\\';
            out += c;
        } else if (byte < 0x20) {
            out += fmt::format("\\u{:04x}", byte);
        } else {
            out += c;
        }
    }
    return out + '"';
}

std::string json_number(double value) { return std::isfinite(value) ? fmt::format("{:.9g}", value) : "null"; }

Reporter::Reporter(bool quiet, bool json) : quiet_(quiet), json_(json), terminal_(::isatty(STDERR_FILENO) == 1) {}

Reporter::~Reporter() { end_progress(); }

void Reporter::say(const Messages& messages) {
    for (; said_ < messages.all().size(); ++said_) {
        const Message& message = messages.all()[said_];
        if (json_ && !quiet_) {
            event(fmt::format(R"({{"event":"{}","text":{},"times":{}}})", message.is_warning ? "warning" : "notice",
                              json_string(message.text), message.times));
        } else {
            say(fmt::format("{}: {}{}", message.is_warning ? "warning" : "note", message.text,
                            message.times > 1 ? fmt::format(" ({} times)", message.times) : ""));
        }
    }
}

void Reporter::say(const std::string& line) {
    if (quiet_ || json_) return;
    end_progress();
    fmt::print(stderr, "{}\n", line);
}

void Reporter::progress(double share, const std::string& detail) {
    if (quiet_ || json_ || !terminal_) return;
    constexpr int width = 24;
    const int full = std::clamp(static_cast<int>(share * width), 0, width);
    fmt::print(stderr, "\r[{:=<{}}{: <{}}] {:3.0f} %  {}\x1b[K", "", full, "", width - full, 100 * share, detail);
    std::fflush(stderr);
    drawn_ = true;
}

void Reporter::event(const std::string& object) {
    if (!json_) return;
    fmt::print("{}\n", object);
    std::fflush(stdout);
}

void Reporter::end_progress() {
    if (!drawn_) return;
    fmt::print(stderr, "\n");
    drawn_ = false;
}

} // namespace pertev
