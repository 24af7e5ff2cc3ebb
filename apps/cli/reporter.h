#pragma once

// Output of a verb: messages and a progress line for people on stderr, or one JSON object per line on stdout.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "base/heartbeat.h"
#include "base/json_text.h"
#include "base/sink.h"

namespace CLI {
class App;
}

namespace pertev {

/// -q silences everything but errors; --json turns everything into JSON lines on stdout. Every verb has both.
struct ReportFlags {
    bool quiet = false, json = false;
    std::string progress;    // "json": progress as JSON lines on stderr; empty: a bar or lines
    std::string measurement; // file that a benchmark writes its measurement into; empty: none
};

void add_report_flags(CLI::App& verb, ReportFlags& flags);
/// Adds --progress, which verbs for farms have.
void add_progress_flag(CLI::App& verb, ReportFlags& flags);

class Reporter final : public Messages {
public:
    explicit Reporter(const ReportFlags& flags);
    ~Reporter() override;
    Reporter(const Reporter&) = delete;
    Reporter& operator=(const Reporter&) = delete;

    /// Writes the messages. The destructor writes remaining ones, which may explain an error.
    void report_messages() override;
    /// Returns whether Ctrl-C was pressed.
    bool should_stop() override;
    /// Writes a line for people to stderr.
    void print(const std::string& line);
    /// Shows the progress, and the event `progress`.
    void progress(const Progress& now) override;
    /// Shows the completed share, in [0, 1], and a text after the bar. It is redrawn in place on a terminal;
    /// otherwise, or on a dumb one, there is a line every 10 s.
    void progress(double share, const std::string& detail);
    /// Names the current work for the lines of progress() until there is a share.
    void set_work(const std::string& work) override;
    /// Writes the JSON object ("{...}") of an event; only with --json.
    void event(const std::string& object);
    /// Writes the event with a verb's result: `object` with the lists `made_up` and `left_out` of all messages before
    /// it.
    void result(const std::string& object);
    /// Writes the requested information for people to stdout.
    void answer(const std::string& lines);
    /// Reports a file that was written, or that could not be written and why; only with --json.
    void output(const std::string& path, const std::string& why_not = "");
    /// Lets `write` write this file, and reports that, or why it failed. Throws as `write`.
    void write_output(const std::string& path, const std::function<void()>& write);
    void end_progress();
    /// Names the part of a picture that is rendered, such as "part 2/3", in every line and in the progress.
    void set_part(std::string part);
    /// Writes no events, because another process writes those of the same stdout.
    void silence_events() { flags_.quiet = flags_.quiet || flags_.json, flags_.json = false; }

    bool json() const { return flags_.json; }

private:
    std::string prefix() const { return part_.empty() ? "" : part_ + ": "; }
    bool is_silent() const { return flags_.quiet || flags_.json; }

    ReportFlags flags_;
    bool redraws_; // a terminal with escape sequences
    bool drawn_ = false;
    std::string part_;
    std::size_t reported_ = 0;
    std::string shown_step_; // step of the last progress, and the time of that
    double shown_at_s_ = 0;
    std::unique_ptr<Heartbeat> heartbeat_; // used if there is no progress bar
};

} // namespace pertev
