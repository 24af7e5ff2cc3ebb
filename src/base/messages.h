#pragma once

// What a library wants to say without printing: warnings (something of the input was left out or repaired) and
// notices (a default was taken). The command line prints them; tests read them. Repeats are counted, not stored.

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
};

class Messages {
public:
    void warn(std::string text) { add(true, std::move(text)); }
    void note(std::string text) { add(false, std::move(text)); }
    const std::vector<Message>& all() const { return all_; }

private:
    void add(bool is_warning, std::string text) {
        const auto [place, is_new] = places_[is_warning ? 1 : 0].try_emplace(text, all_.size());
        if (is_new) {
            all_.push_back({is_warning, std::move(text)});
        } else {
            ++all_[place->second].times;
        }
    }

    std::vector<Message> all_;
    std::unordered_map<std::string, std::size_t> places_[2]; // of notices and warnings in all_
};

} // namespace pertev
