#pragma once

// The object that a user of the library gives to long work: it takes messages and progress, and may end the work. Work
// that can have partial results keeps them when it is ended; the rest throws Error(Interrupted).
//
// The library prints nothing itself. One rule applies to everything that is read: unknown or unreadable parts are
// skipped with a warning (leave_out) that names the file and the location, and only an input that leaves no picture is
// an error. A strict render stops if anything was left out. A notice (make_up) reports what the scene lacks and gets by
// default (a camera, a light).

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/remark.h"

namespace pertev {

struct Message {
    bool is_warning = false;
    Remark remark = {""};
    std::string text = {}; // all parts of the remark
    std::size_t times = 1;
    bool is_left_out = false; // for a warning: the picture lacks something that the input has
    bool is_made_up = false;  // for a notice: the picture has something that the input lacks
};
class Messages;

struct Progress {
    std::string doing;                  // the current step
    double share = 0;                   // the finished share of all steps, [0, 1]
    double seconds = 0;                 // since the work began
    std::optional<double> seconds_left; // none: unknown
    double share_of_step = 0;           // finished share of a long step that is done in pieces
    // The members from here on apply to renders.
    uint32_t samples_done = 0, samples = 0; // in the film now, and at the end of the call
    uint64_t rays = 0;                      // rays of the call
    double made_share = 1;                  // share of the integrator's precomputation; 1 when it is complete
    double made_seconds = 0;                // the part of `seconds` that it took; 0 if there was none
};

class Sink {
public:
    virtual ~Sink() = default;

    /// Takes a message, from one thread at a time. Names of settings are in backquotes in its text
    /// (base/phrase_settings.h).
    virtual void receive(const Message& message) { static_cast<void>(message); }
    /// Returns the messages so far; none if the sink keeps none. A strict render refuses what they say is left out.
    virtual const Messages& messages() const;
    /// Called when something long begins, so that the messages so far can be shown.
    virtual void report_messages() {}
    /// Called when `work` begins, such as "building trees".
    virtual void set_work(const std::string& work) { static_cast<void>(work); }
    /// Called several times a second, by one thread at a time.
    virtual void progress(const Progress& now) { static_cast<void>(now); }
    /// Returns whether the work should stop. Called often and from any thread, so it must be cheap.
    virtual bool should_stop() { return false; }

    /// Reports a warning: something was repaired, or a request has no effect.
    void warn(Remark remark) { tell({.is_warning = true}, std::move(remark)); }
    /// Reports a warning that the picture lacks something that the input has.
    void leave_out(Remark remark) { tell({.is_warning = true, .is_left_out = true}, std::move(remark)); }
    /// Reports a notice: a default was used, or there is other information.
    void note(Remark remark) { tell({}, std::move(remark)); }
    /// Reports a notice that the picture has something that the input lacks.
    void make_up(Remark remark) { tell({.is_made_up = true}, std::move(remark)); }
    void add_all(const Messages& messages);

    /// Reports and returns whether the work goes on.
    bool goes_on(const Progress& now) {
        progress(now);
        return !should_stop();
    }
    /// Throws Error(Interrupted) if the work should stop.
    void check() {
        if (should_stop()) throw Error(ErrorCode::Interrupted, "interrupted");
    }
    /// Checks at some steps of a long loop.
    void check_at(uint64_t step) {
        if (step % (1 << 16) == 0) check();
    }

private:
    void tell(Message message, Remark remark) {
        message.text = remark.text();
        message.remark = std::move(remark);
        receive(message);
    }
};

/// A sink that keeps all messages. Repeated ones are counted, not stored. Of things that are left out it lists the
/// first 100.
class Messages : public Sink {
public:
    void receive(const Message& message) override {
        const bool is_listed =
            left_out_ < kMaxLeftOut || message.text == kMoreLeftOut || indices_[1].contains(message.text);
        if (message.is_left_out && !is_listed) return leave_out(kMoreLeftOut);
        const auto [found, is_new] = indices_[message.is_warning ? 1 : 0].try_emplace(message.text, all_.size());
        if (message.is_left_out && (is_new || !all_[found->second].is_left_out)) ++left_out_;
        if (is_new) return all_.push_back(message);
        Message& here = all_[found->second];
        here.times += message.times;
        here.is_left_out = here.is_left_out || message.is_left_out;
        here.is_made_up = here.is_made_up || message.is_made_up;
    }
    const Messages& messages() const override { return *this; }

    const std::vector<Message>& all() const { return all_; }
    /// Returns the messages from index `first` on.
    Messages since(std::size_t first) const {
        Messages found;
        for (; first < all_.size(); ++first) found.receive(all_[first]);
        return found;
    }

    // Texts of what was made up and of what was left out, in order.
    std::vector<std::string> made_up() const { return texts_of(&Message::is_made_up); }
    std::vector<std::string> left_out() const { return texts_of(&Message::is_left_out); }

private:
    static constexpr std::size_t kMaxLeftOut = 100;
    static constexpr const char* kMoreLeftOut = "more parts are left out; only the first are listed";

    std::vector<std::string> texts_of(bool Message::*kind) const {
        std::vector<std::string> texts;
        for (const Message& message : all_) {
            if (message.*kind) texts.push_back(message.text);
        }
        return texts;
    }

    std::vector<Message> all_;
    std::unordered_map<std::string, std::size_t> indices_[2]; // indices of notices and warnings in all_
    std::size_t left_out_ = 0;                                // number of such messages in all_
};

inline const Messages& Sink::messages() const {
    static const Messages none;
    return none;
}

inline void Sink::add_all(const Messages& messages) {
    for (const Message& message : messages.all()) receive(message);
}

/// Returns a sink that drops all messages.
inline Sink& nobody() {
    static Sink sink;
    return sink;
}

/// Keeps the messages of a part of some work. The part stops with the whole, which hears none of them.
class PartMessages final : public Messages {
public:
    /// `whole` must outlive this object.
    explicit PartMessages(Sink& whole) : whole_(whole) {}
    bool should_stop() override { return whole_.should_stop(); }

private:
    Sink& whole_;
};

/// A sink for part of some work: `goes_on` gets the progress, and the part stops once it returns false, or with the
/// whole, which gets the messages.
class ProgressSink final : public Sink {
public:
    /// `whole` must outlive this object.
    explicit ProgressSink(std::function<bool(const Progress&)> goes_on, Sink& whole = nobody())
        : goes_on_(std::move(goes_on)), whole_(whole) {}
    void receive(const Message& message) override { whole_.receive(message); }
    const Messages& messages() const override { return whole_.messages(); }
    void progress(const Progress& now) override { stops_ = stops_ || !goes_on_(now); }
    bool should_stop() override { return stops_ || whole_.should_stop(); }

private:
    std::function<bool(const Progress&)> goes_on_;
    Sink& whole_;
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
        whole);
}

} // namespace pertev
