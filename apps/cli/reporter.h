#pragma once

// What a verb says: messages and a progress line for people on stderr, or one JSON object a line on stdout.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "base/heartbeat.h"
#include "base/json_text.h"
#include "session/sink.h"

namespace CLI {
class App;
}

namespace pertev {

/// -q silences all but errors; --json turns everything into JSON lines on stdout. Every verb has both.
struct ReportFlags {
    bool quiet = false, json = false;
    std::string measurement; // file that a benchmark writes its measurement into; empty: none
};

void add_report_flags(CLI::App& verb, ReportFlags& flags);

class Reporter final : public Sink {
public:
    explicit Reporter(const ReportFlags& flags);
    ~Reporter() override;
    Reporter(const Reporter&) = delete;
    Reporter& operator=(const Reporter&) = delete;

    /// Says the messages. The destructor says what was not said: before an error, it may tell why.
    void say_messages() override;
    /// Returns whether Ctrl-C was heard.
    bool is_cancelled() override;
    /// One line for people, on stderr.
    void say(const std::string& line);
    /// Share done in [0, 1], and what stands behind the bar. Redrawn in place on a terminal; where there is none, or a
    /// dumb one, a line every 10 s.
    void progress(double share, const std::string& detail) override;
    /// What is being done from now on, for these lines: where there is no share yet.
    void set_work(const std::string& work) override;
    /// A JSON object ("{...}") of the given event; only with --json.
    void event(const std::string& object);
    /// The event that tells a verb's result: `object` with the lists `made_up` and `left_out` of all messages before
    /// it.
    void result(const std::string& object);
    /// What the verb was asked for, for people, on stdout.
    void answer(const std::string& lines);
    /// A file that was written, or with a reason one that was not; only with --json.
    void output(const std::string& path, const std::string& why_not = "");
    /// Has `write` write this file, and says so, or why it did not. Throws as `write`.
    void write_output(const std::string& path, const std::function<void()>& write);
    void end_progress();

    bool json() const { return flags_.json; }

private:
    bool is_silent() const { return flags_.quiet || flags_.json; }

    ReportFlags flags_;
    bool redraws_; // a terminal that takes escapes
    bool drawn_ = false;
    std::size_t said_ = 0;
    std::unique_ptr<Heartbeat> heartbeat_; // where nobody sees a bar
};

} // namespace pertev
