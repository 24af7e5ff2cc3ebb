#pragma once

// What a library wants to say without printing: warnings (something of the input was left out or repaired) and
// notices (a default was taken). The command line prints them; tests read them. Repeats are counted, not stored.
// A warning of something missing (a texture that is not there or cannot be read) is one that a strict render ends with.

#include <cstddef>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pertev {

struct Message {
    bool is_warning = false;
    std::string text;
    std::size_t times = 1;
    bool is_missing = false; // a warning that what the scene refers to is not there, or broken
};

class Messages {
public:
    void warn(std::string text) { add(true, std::move(text)); }
    void warn_of_missing(std::string text) { all_[add(true, std::move(text))].is_missing = true; }
    void note(std::string text) { add(false, std::move(text)); }
    /// All that `other` has, after what is here.
    void add_all(const Messages& other) {
        for (const Message& message : other.all_) {
            Message& here = all_[add(message.is_warning, message.text)];
            here.times += message.times - 1;
            here.is_missing = here.is_missing || message.is_missing;
        }
    }
    const std::vector<Message>& all() const { return all_; }

private:
    /// Its place in all_.
    std::size_t add(bool is_warning, std::string text) {
        const auto [place, is_new] = places_[is_warning ? 1 : 0].try_emplace(text, all_.size());
        if (is_new) {
            all_.push_back({.is_warning = is_warning, .text = std::move(text)});
        } else {
            ++all_[place->second].times;
        }
        return place->second;
    }

    std::vector<Message> all_;
    std::unordered_map<std::string, std::size_t> places_[2]; // of notices and warnings in all_
};

} // namespace pertev
