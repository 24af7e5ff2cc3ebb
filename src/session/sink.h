#pragma once

// The library user's callbacks for long operations: messages, the current work and its progress, and cancellation.
// Each session has its own. The rendering thread makes all calls.

#include <string>

#include "base/messages.h"

namespace pertev {

class Sink {
public:
    virtual ~Sink() = default;

    /// Collects warnings and notices. Names of settings are in backquotes in their texts (base/phrase_settings.h).
    Messages& messages() { return messages_; }
    /// Called when long work begins, so that the messages so far can be shown.
    virtual void report_messages() {}
    /// Called when `work`, such as "building trees", begins.
    virtual void set_work(const std::string& work) { static_cast<void>(work); }
    /// Called when `share` in [0, 1] of the current work is done; `detail` is more text about it.
    virtual void progress(double share, const std::string& detail) {
        static_cast<void>(share);
        static_cast<void>(detail);
    }
    /// Returns whether the current work should stop. It is called often.
    virtual bool is_cancelled() { return false; }

private:
    Messages messages_;
};

} // namespace pertev
