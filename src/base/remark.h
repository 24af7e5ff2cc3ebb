#pragma once

// What an error, a warning or a notice says, in parts: programs and tests look at them, front ends phrase them.
//
// A setting has one name, which metadata and JSON spell (`max_depth`); how a user sets it is the front end's to say.
// A reason that names a setting therefore has its name between backquotes, with a value where there is one to say:
// "`eye=0,1,3` looks at it". The command line makes a flag of each (base/phrase_settings.h).

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace pertev {

/// A place in the input. At most one of `line` and `pointer` is there.
struct Place {
    std::string file;
    std::size_t line = 0;                    // the first is 1; 0 stands for none
    std::optional<std::string> pointer = {}; // RFC 6901; "" is the whole document
    bool operator==(const Place&) const = default;
};

/// "a.obj:12", "a.gltf: /nodes/3" or "a.exr".
std::string text_of(const Place& place);

struct Remark {
    Remark(std::string why) : reason(std::move(why)) {}
    Remark(const char* why) : reason(why) {}
    Remark(Place where, std::string why) : place(std::move(where)), reason(std::move(why)) {}
    /// `value` is empty where the setting has none or where it does not matter.
    Remark(std::string name, std::string its_value, std::string why)
        : setting(std::move(name)), value(std::move(its_value)), reason(std::move(why)) {}

    /// All parts as one text: the place, the setting between backquotes, the reason.
    std::string text() const;
    /// The same remark, whose reason has `more` behind it.
    Remark and_then(std::string_view more) const;

    std::optional<Place> place;
    std::string setting; // empty: it is about none
    std::string value;   // of that setting
    std::string reason;
};

} // namespace pertev
