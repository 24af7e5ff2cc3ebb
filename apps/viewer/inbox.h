#pragma once

// A queue with a mutex from the network's thread to the render's thread. Its size is bounded: clients' rates are
// limited, and commands that do not fit are refused.

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

/// A request of a client that steers.
struct Steer {
    uint32_t client = 0;
    ClientMessage message;
};

/// A request to save a picture as "png" or "exr". `reply` is called once, from the render's thread, with the file's
/// bytes, or with none on failure.
struct Save {
    std::string format;
    std::function<void(std::vector<std::byte>)> reply;
};

/// A client has connected and needs the current state.
struct Joined {};

using Command = std::variant<Steer, Save, Joined>;

class Inbox {
public:
    static constexpr std::size_t kMaxCommands = 4096;

    /// Sets `abandon` while commands wait that make the current samples useless, and `hurry` while commands wait that
    /// do that or only change how samples are shown. Both outlive the inbox.
    void raise(std::atomic<bool>& abandon, std::atomic<bool>& hurry) {
        abandon_ = &abandon;
        hurry_ = &hurry;
    }

    /// Sets the view from which the effect of further settings is predicted. A setting that this view refuses, or has
    /// already, sets no flag, because it must not cost any sample.
    void expect(const ViewState& view) {
        const std::lock_guard lock(mutex_);
        expected_ = view;
        for (const Command& command : commands_) {
            if (const Steer* steer = std::get_if<Steer>(&command)) foresee(steer->message);
        }
    }

    /// Returns false if there is no room, or it is closed.
    bool put(Command command) {
        const std::lock_guard lock(mutex_);
        if (is_closed_ || commands_.size() >= kMaxCommands) return false;
        const Steer* steer = std::get_if<Steer>(&command);
        if (steer != nullptr) raise_for(foresee(steer->message));
        commands_.push_back(std::move(command));
        there_is_more_.notify_one();
        return true;
    }

    /// Returns whether the viewer is ending, so that refusals are not the sender's fault.
    bool is_closed() const {
        const std::lock_guard lock(mutex_);
        return is_closed_;
    }

    /// Returns all commands in order; waits for the first until `timeout`.
    std::vector<Command> take(std::chrono::milliseconds timeout) {
        std::unique_lock lock(mutex_);
        there_is_more_.wait_for(lock, timeout, [&] { return !commands_.empty(); });
        if (abandon_ != nullptr) *abandon_ = *hurry_ = false;
        return std::exchange(commands_, {});
    }

    /// Discards queued commands and accepts no more.
    void close() {
        std::vector<Command> forgotten; // destroyed after the lock is released, because a reply may call the sender
        const std::lock_guard lock(mutex_);
        is_closed_ = true;
        forgotten.swap(commands_);
    }

private:
    enum class Effect : uint8_t { None, ShownOtherwise, Restarts };

    /// Applies the message to the expected view. Returns its effect on the picture.
    Effect foresee(const ClientMessage& message) {
        if (moves_the_picture(message.kind)) return Effect::Restarts;
        if (message.kind == MessageKind::Meter) return Effect::ShownOtherwise;
        ViewState after = expected_;
        bool is_taken = false;
        if (message.kind == MessageKind::Set) {
            is_taken = set_view_setting(after, message.name, message.value).empty();
        } else if (message.kind == MessageKind::Shape) {
            is_taken = resize_to_window(after, message.width, message.height);
        }
        if (!is_taken) return Effect::None;
        const ViewState before = std::exchange(expected_, std::move(after));
        if (restarts(before, expected_)) return Effect::Restarts;
        return is_shown_otherwise(before, expected_) ? Effect::ShownOtherwise : Effect::None;
    }

    void raise_for(Effect effect) {
        if (abandon_ == nullptr || effect == Effect::None) return;
        *hurry_ = true;
        if (effect == Effect::Restarts) *abandon_ = true;
    }

    mutable std::mutex mutex_;
    ViewState expected_; // after all queued commands
    bool is_closed_ = false;
    std::condition_variable there_is_more_;
    std::vector<Command> commands_;
    std::atomic<bool>*abandon_ = nullptr, *hurry_ = nullptr; // both or none
};

} // namespace pertev
