#pragma once

// Warnings and notices of the library, which prints nothing itself. The command line prints them; tests read them.
// Repeated messages are counted, not stored.
//
// One rule applies to everything that is read: unknown or unreadable parts are skipped with a warning (leave_out)
// that names the file and the location, and only an input that leaves no picture is an error. A strict render stops
// if anything was left out. A notice (make_up) reports what the scene lacks and gets by default (a camera, a light).

#include <cstddef>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/remark.h"

namespace pertev {

struct Message {
    bool is_warning = false;
    Remark remark;
    std::string text; // all parts of the remark
    std::size_t times = 1;
    bool is_left_out = false; // for a warning: the picture lacks something that the input has
    bool is_made_up = false;  // for a notice: the picture has something that the input lacks
};

class Messages {
public:
    /// Adds a warning: something was repaired, or a request has no effect.
    void warn(Remark remark) { add(true, std::move(remark)); }
    /// Adds a warning that the picture lacks something that the input has. For a file with many faults only the first
    /// is named.
    void leave_out(Remark remark) {
        const bool is_one_too_many = left_out_ >= kMaxLeftOut && !indices_[1].contains(remark.text());
        Message& message = all_[add(true, is_one_too_many ? Remark(kMoreLeftOut) : std::move(remark))];
        if (!message.is_left_out) ++left_out_;
        message.is_left_out = true;
    }
    /// Adds a notice: a default was used, or there is other information.
    void note(Remark remark) { add(false, std::move(remark)); }
    /// Adds a notice that the picture has something that the input lacks.
    void make_up(Remark remark) { all_[add(false, std::move(remark))].is_made_up = true; }

    /// Appends all messages of `other`.
    void add_all(const Messages& other) {
        for (const Message& message : other.all_) {
            Message& here = all_[add(message.is_warning, message.remark)];
            here.times += message.times - 1;
            if (message.is_left_out && !here.is_left_out) ++left_out_;
            here.is_left_out = here.is_left_out || message.is_left_out;
            here.is_made_up = here.is_made_up || message.is_made_up;
        }
    }
    const std::vector<Message>& all() const { return all_; }

    // Texts of what was made up and of what was left out, in order.
    std::vector<std::string> made_up() const { return texts_of(&Message::is_made_up); }
    std::vector<std::string> left_out() const { return texts_of(&Message::is_left_out); }

private:
    static constexpr std::size_t kMaxLeftOut = 100;
    static constexpr const char* kMoreLeftOut = "further things are left out; only the first are listed";

    /// Adds a message and returns its index in all_.
    std::size_t add(bool is_warning, Remark remark) {
        std::string text = remark.text();
        const auto [found, is_new] = indices_[is_warning ? 1 : 0].try_emplace(text, all_.size());
        if (is_new) {
            all_.push_back({.is_warning = is_warning, .remark = std::move(remark), .text = std::move(text)});
        } else {
            ++all_[found->second].times;
        }
        return found->second;
    }

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

} // namespace pertev
