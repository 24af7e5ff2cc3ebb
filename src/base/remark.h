#pragma once

// The content of an error, a warning or a notice, in parts: programs and tests read them, front ends format them.
//
// A setting has one name, as in metadata and JSON (`max_depth`); the front end decides how users set it. A reason
// that refers to a setting therefore has its name between backquotes, possibly with a value: "`eye=0,1,3` looks at
// it". The command line turns each into a flag (base/phrase_settings.h).

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace pertev {

/// A location in the input. At most one of `line` and `pointer` is set.
struct FileLocation {
    std::string file;
    std::size_t line = 0;                    // the first is 1; 0 means none
    std::optional<std::string> pointer = {}; // RFC 6901; "" is the whole document
    bool operator==(const FileLocation&) const = default;
};

/// Text such as "a.obj:12", "a.gltf: /nodes/3" or "a.exr".
std::string text_of(const FileLocation& location);

/// The text between a setting and the reason: " is " before a reason such as "not a number", otherwise ": ".
std::string_view before_reason(std::string_view reason);

struct Remark {
    Remark(std::string why) : reason(std::move(why)) {}
    Remark(const char* why) : reason(why) {}
    Remark(FileLocation where, std::string why) : location(std::move(where)), reason(std::move(why)) {}
    /// Makes a remark about a setting. The value is empty if the setting has none or if it does not matter.
    Remark(std::string name, std::string its_value, std::string why)
        : setting(std::move(name)), value(std::move(its_value)), reason(std::move(why)) {}

    /// All parts as one text: the place, the setting between backquotes, the reason.
    std::string text() const;
    /// Returns the remark with `more` appended to its reason.
    Remark and_then(std::string_view more) const;

    std::optional<FileLocation> location;
    std::string setting; // empty if the remark is about no setting
    std::string value;   // value of that setting
    std::string reason;
};

} // namespace pertev
