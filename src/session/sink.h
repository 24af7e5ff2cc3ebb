#pragma once

// What the user of the library gives to all that takes long: it hears of messages, of the work that goes on and how far
// it is, and can end it. Each session has its own. All calls come from the thread that renders.

#include <string>

#include "base/messages.h"

namespace pertev {

class Sink {
public:
    virtual ~Sink() = default;

    /// Warnings and notices gather here. Names of settings stand between backquotes in their texts
    /// (base/phrase_settings.h).
    Messages& messages() { return messages_; }
    /// The messages so far can be shown, because something long begins.
    virtual void say_messages() {}
    /// `work`, as "building trees", goes on from now on.
    virtual void set_work(const std::string& work) { static_cast<void>(work); }
    /// `share` in [0, 1] of what goes on is done; `detail` says more.
    virtual void progress(double share, const std::string& detail) {
        static_cast<void>(share);
        static_cast<void>(detail);
    }
    /// Returns whether what goes on is to end. It is asked often.
    virtual bool is_cancelled() { return false; }

private:
    Messages messages_;
};

} // namespace pertev
