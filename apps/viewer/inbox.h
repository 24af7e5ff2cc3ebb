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

    /// While commands wait that make the samples under way useless, this flag is true. It outlives the inbox.
    void raise(std::atomic<bool>& flag) { flag_ = &flag; }

    /// False where there is no room, or it is closed.
    bool put(Command command) {
        const std::lock_guard lock(mutex_);
        if (is_closed_ || commands_.size() >= kMost) return false;
        const Steer* steer = std::get_if<Steer>(&command);
        if (flag_ != nullptr && steer != nullptr && begins_anew(steer->message)) *flag_ = true;
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
        if (flag_ != nullptr) *flag_ = false;
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
    mutable std::mutex mutex_;
    bool is_closed_ = false;
    std::condition_variable there_is_more_;
    std::vector<Command> commands_;
    std::atomic<bool>* flag_ = nullptr;
};

} // namespace pertev
