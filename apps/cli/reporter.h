#pragma once

// What a verb says: messages and a progress line for people on stderr, or one JSON object a line on stdout.

#include <cstdint>
#include <string>

#include "base/json_text.h"
#include "base/messages.h"

namespace CLI {
class App;
}

namespace pertev {

/// -q silences all but errors; --json turns everything into JSON lines on stdout. Every verb has both.
struct ReportFlags {
    bool quiet = false, json = false;
};

void add_report_flags(CLI::App& verb, ReportFlags& flags);

class Reporter {
public:
    explicit Reporter(const ReportFlags& flags);
    ~Reporter();
    Reporter(const Reporter&) = delete;
    Reporter& operator=(const Reporter&) = delete;

    /// What the verb's libraries have to say. The destructor says what was not said: before an error, it may tell why.
    Messages& messages() { return messages_; }
    void say_messages();
    /// One line for people, on stderr.
    void say(const std::string& line);
    /// Share done in [0, 1], and what stands behind the bar. Redrawn in place, only on a terminal.
    void progress(double share, const std::string& detail);
    /// A JSON object ("{...}") of the given event; only with --json.
    void event(const std::string& object);
    /// What the verb was asked for, for people, on stdout.
    void answer(const std::string& lines);
    void end_progress();

    bool json() const { return flags_.json; }

private:
    bool is_silent() const { return flags_.quiet || flags_.json; }

    ReportFlags flags_;
    Messages messages_;
    bool terminal_;
    bool drawn_ = false;
    std::size_t said_ = 0;
};

} // namespace pertev
