#pragma once

// What the network's thread hands to the render's thread: a plain queue behind a mutex. It cannot grow without bound:
// the clients' rates are limited, and what does not fit is refused.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "apps/viewer/view_state.h"

namespace pertev {

/// What somebody who steers has asked for.
struct Steer {
    uint32_t client = 0;
    ClientMessage message;
};

/// A picture to be saved: "png" or "exr". `reply` is called once, from the render's thread, with the file's bytes; or
/// with none where that failed.
struct Save {
    std::string format;
    std::function<void(std::vector<std::byte>)> reply;
};

/// Somebody came, whom the present state is news to.
struct Joined {};

using Command = std::variant<Steer, Save, Joined>;

class Inbox {
public:
    static constexpr std::size_t kMost = 4096;

    /// While commands wait that make the samples under way useless, `abandon` is true. While commands wait that show
    /// the same samples in another way, or that, `hurry` is true. Both outlive the inbox.
    void raise(std::atomic<bool>& abandon, std::atomic<bool>& hurry) {
        abandon_ = &abandon;
        hurry_ = &hurry;
    }

    /// Tells what settings that are yet to come will change. One that this view refuses, or has already, raises no
    /// flag: it must cost no sample.
    void expect(const ViewState& view) {
        const std::lock_guard lock(mutex_);
        expected_ = view;
        for (const Command& command : commands_) {
            if (const Steer* steer = std::get_if<Steer>(&command)) foresee(steer->message);
        }
    }

    /// False where there is no room, or it is closed.
    bool put(Command command) {
        const std::lock_guard lock(mutex_);
        if (is_closed_ || commands_.size() >= kMost) return false;
        const Steer* steer = std::get_if<Steer>(&command);
        if (steer != nullptr) raise_for(foresee(steer->message));
        commands_.push_back(std::move(command));
        there_is_more_.notify_one();
        return true;
    }

    /// Whether the viewer is ending: no fault of whoever still sends.
    bool is_closed() const {
        const std::lock_guard lock(mutex_);
        return is_closed_;
    }

    /// All there are, in their order; waits for the first until `timeout` is over.
    std::vector<Command> take(std::chrono::milliseconds timeout) {
        std::unique_lock lock(mutex_);
        there_is_more_.wait_for(lock, timeout, [&] { return !commands_.empty(); });
        if (abandon_ != nullptr) *abandon_ = *hurry_ = false;
        return std::exchange(commands_, {});
    }

    /// Forgets what waits, and takes no more.
    void close() {
        std::vector<Command> forgotten; // goes after the lock: a reply may lead back to whoever put it here
        const std::lock_guard lock(mutex_);
        is_closed_ = true;
        forgotten.swap(commands_);
    }

private:
    enum class Effect : uint8_t { None, ShownOtherwise, BeginsAnew };

    /// Takes the message into the expected view. Returns what it does to the picture.
    Effect foresee(const ClientMessage& message) {
        if (moves_the_picture(message.kind)) return Effect::BeginsAnew;
        if (message.kind == MessageKind::Meter) return Effect::ShownOtherwise;
        ViewState after = expected_;
        bool is_taken = false;
        if (message.kind == MessageKind::Set) {
            is_taken = set_view_setting(after, message.name, message.value).empty();
        } else if (message.kind == MessageKind::Shape) {
            is_taken = take_window_shape(after, message.width, message.height);
        }
        if (!is_taken) return Effect::None;
        const ViewState before = std::exchange(expected_, std::move(after));
        if (begins_anew(before, expected_)) return Effect::BeginsAnew;
        return is_shown_otherwise(before, expected_) ? Effect::ShownOtherwise : Effect::None;
    }

    void raise_for(Effect effect) {
        if (abandon_ == nullptr || effect == Effect::None) return;
        *hurry_ = true;
        if (effect == Effect::BeginsAnew) *abandon_ = true;
    }

    mutable std::mutex mutex_;
    ViewState expected_; // once all commands that wait are done
    bool is_closed_ = false;
    std::condition_variable there_is_more_;
    std::vector<Command> commands_;
    std::atomic<bool>*abandon_ = nullptr, *hurry_ = nullptr; // both or none
};

} // namespace pertev
