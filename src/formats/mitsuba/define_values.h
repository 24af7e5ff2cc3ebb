#pragma once

// Values of $NAME in a Mitsuba file: those that the user defines (setting `define`), and the file's defaults.

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/sink.h"

namespace pertev::mitsuba {

class DefineValues {
public:
    /// `defines` are texts NAME=VALUE. `sink` outlives it. Throws Error(BadInput) for another text.
    DefineValues(const std::vector<std::string>& defines, Sink& sink);

    /// Sets the value of a name that has none yet. Throws Error(BadInput) without a name.
    void set_default(std::string name, std::string value, const FileLocation& from);
    /// Returns `text` with values in place of names, each the longest that fits. Throws Error(BadInput) if a name has
    /// no value.
    std::string put_into(std::string_view text, const FileLocation& from);
    /// Warns of the user's names that the file does not use.
    void report_unused() const;

private:
    using Values = std::map<std::string, std::string, std::less<>>;
    /// Returns the longest name that the text begins with; the end if there is none.
    Values::const_iterator longest_in_front_of(std::string_view text) const;

    Values values_;
    std::set<std::string, std::less<>> defined_, used_;
    std::size_t missing_ = 0; // names without a value
    std::size_t in_all_ = 0;  // bytes of all texts with values in them
    Sink& sink_;
};

} // namespace pertev::mitsuba
