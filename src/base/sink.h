#pragma once

// The object that a user of the library gives to long work: it takes messages and progress, and may end the work. Work
// that can have partial results keeps them when it is ended; the rest throws Error(Interrupted).

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/messages.h"

namespace pertev {

struct Progress {
    std::string doing;                  // the current step
    double share = 0;                   // the finished share of all steps, [0, 1]
    double seconds = 0;                 // since the work began
    std::optional<double> seconds_left; // none: unknown
    double share_of_step = 0;           // finished share of a long step that is done in pieces
    // These apply to renders.
    uint32_t samples_done = 0, samples = 0; // in the film now, and at the end of the call
    uint64_t rays = 0;                      // rays of the call
    double made_share = 1;                  // share of the integrator's precomputation; 1 when it is complete
    double made_seconds = 0;                // the part of `seconds` that it took; 0 if there was none
};

class Sink {
public:
    virtual ~Sink() = default;

    /// Collects warnings and notices. Names of settings are in backquotes in their texts (base/phrase_settings.h).
    virtual Messages& messages() { return messages_; }
    /// Called when something long begins, so that the messages so far can be shown.
    virtual void report_messages() {}
    /// `work`, such as "building trees", begins.
    virtual void set_work(const std::string& work) { static_cast<void>(work); }
    /// Called several times a second, by one thread at a time.
    virtual void progress(const Progress& now) { static_cast<void>(now); }
    /// Returns whether the work should stop. Called often and from any thread, so it must be cheap.
    virtual bool should_stop() { return false; }

    /// Reports and returns whether the work goes on.
    bool goes_on(const Progress& now) {
        progress(now);
        return !should_stop();
    }
    /// Throws Error(Interrupted) if the work should stop.
    void check() {
        if (should_stop()) throw Error(ErrorCode::Interrupted, "interrupted");
    }

private:
    Messages messages_;
};

/// Returns a sink that nobody hears. It keeps no messages.
inline Sink& nobody() {
    class Nobody final : public Sink {
    public:
        Messages& messages() override { return none_ = {}; }

    private:
        Messages none_;
    };
    thread_local Nobody sink;
    return sink;
}

/// A sink for part of some work: `goes_on` gets the progress, and the part stops once it returns false, or with the
/// whole, which gets the messages.
class ProgressSink final : public Sink {
public:
    /// `whole` outlives it; null: there is none.
    explicit ProgressSink(std::function<bool(const Progress&)> goes_on, Sink* whole = nullptr)
        : goes_on_(std::move(goes_on)), whole_(whole) {}
    Messages& messages() override { return whole_ != nullptr ? whole_->messages() : Sink::messages(); }
    void progress(const Progress& now) override { stops_ = stops_ || !goes_on_(now); }
    bool should_stop() override { return stops_ || (whole_ != nullptr && whole_->should_stop()); }

private:
    std::function<bool(const Progress&)> goes_on_;
    Sink* whole_;
    std::atomic<bool> stops_ = false;
};

/// Returns a sink for the part of a work between these shares of `whole`, which outlives it.
inline ProgressSink part_of(Sink& whole, double first, double last) {
    return ProgressSink(
        [&whole, first, last](Progress now) {
            now.share = first + (last - first) * now.share;
            now.seconds_left.reset();
            return whole.goes_on(now);
        },
        &whole);
}

} // namespace pertev
