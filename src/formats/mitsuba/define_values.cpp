#include "formats/mitsuba/define_values.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/files/closest_name.h"

namespace pertev::mitsuba {
namespace {

// Bytes of a text with values in it, since names in values multiply, and of all such texts.
constexpr std::size_t kMostText = 1 << 16, kMostInAll = std::size_t(1) << 25;

} // namespace

DefineValues::DefineValues(const std::vector<std::string>& defines, Sink& sink) : sink_(sink) {
    for (const std::string& define : defines) {
        const std::size_t equal = define.find('=');
        if (equal == 0 || equal == std::string::npos)
            throw Error(ErrorCode::BadInput, "define", define, "no NAME=VALUE");
        values_.insert_or_assign(define.substr(0, equal), define.substr(equal + 1));
        defined_.insert(define.substr(0, equal));
    }
}

void DefineValues::set_default(std::string name, std::string value, const FileLocation& from) {
    if (name.empty()) throw Error(ErrorCode::BadInput, from, "a default has no name");
    if (defined_.contains(name)) used_.insert(name);
    values_.try_emplace(std::move(name), std::move(value));
}

DefineValues::Values::const_iterator DefineValues::longest_in_front_of(std::string_view text) const {
    while (!text.empty()) {
        auto found = values_.upper_bound(text);
        if (found == values_.begin()) break;
        --found; // names between one in front of the text and the text begin with it, too
        if (text.starts_with(found->first)) return found;
        const auto [differs, at] = std::ranges::mismatch(text, found->first);
        text = text.substr(0, static_cast<std::size_t>(differs - text.begin()));
    }
    return values_.end();
}

std::string DefineValues::put_into(std::string_view text, const FileLocation& from) {
    if (text.find('$') == std::string_view::npos) return std::string(text);
    std::string to;
    while (!text.empty()) {
        const std::size_t begin = text.find('$');
        to += text.substr(0, begin);
        if (begin == std::string_view::npos) break;
        text.remove_prefix(begin + 1);
        const auto longest = longest_in_front_of(text);
        if (longest == values_.end())
            throw Error(ErrorCode::BadInput, from,
                        fmt::format("${} has no value; `define` sets one{}", shortened(text),
                                    ++missing_ <= kMostWithSuggestion ? did_you_mean(text, first_names(values_)) : ""));
        to += longest->second;
        text.remove_prefix(longest->first.size());
        used_.insert(longest->first);
        if (to.size() > kMostText)
            throw Error(ErrorCode::BadInput, from, fmt::format("a text with values takes over {} bytes", kMostText));
    }
    in_all_ += to.size();
    if (in_all_ > kMostInAll)
        throw Error(ErrorCode::OverLimit, from, fmt::format("values take over {} MiB of texts", kMostInAll >> 20));
    return to;
}

void DefineValues::report_unused() const {
    std::vector<std::string_view> known; // names in the file
    for (const auto& [name, value] : values_) {
        if (known.size() < kMostSuggestions && (!defined_.contains(name) || used_.contains(name)))
            known.push_back(name);
    }
    for (const std::string& name : defined_) {
        if (!used_.contains(name))
            sink_.warn(Remark("define", name, fmt::format("the file has no ${}{}", name, did_you_mean(name, known))));
    }
}

} // namespace pertev::mitsuba
