#pragma once

// What a library wants to say without printing: warnings (something of the input was left out or repaired) and
// notices (a default was taken). The command line prints them; tests read them. Repeats are counted, not stored.

#include <cstddef>
#include <string>
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
        for (Message& message : all_) {
            if (message.is_warning == is_warning && message.text == text) {
                ++message.times;
                return;
            }
        }
        all_.push_back({is_warning, std::move(text)});
    }

    std::vector<Message> all_;
};

} // namespace pertev
