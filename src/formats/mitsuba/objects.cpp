#include "formats/mitsuba/objects.h"

#include <utility>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/files/closest_name.h"
#include "formats/files/parse_number.h"

namespace pertev::mitsuba {
namespace {

constexpr char kNumbered = '\x01'; // begins ids of objects without their own

bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }

} // namespace

std::string snake_case(std::string_view name) {
    std::string to;
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (i > 0 && is_upper(name[i]) && !is_upper(name[i - 1]) && name[i - 1] != '_') to += '_';
        to += is_upper(name[i]) ? static_cast<char>(name[i] - 'A' + 'a') : name[i];
    }
    return to;
}

Object& Objects::add(std::string tag, std::string type, std::string id, FileLocation location, std::string what) {
    Object object;
    object.number = static_cast<uint32_t>(all_.size());
    object.tag = std::move(tag);
    object.type = std::move(type);
    object.id = std::move(id);
    object.parameters = Parameters(std::move(location), std::move(what));
    if (!object.id.empty()) ids_.insert_or_assign(object.id, object.number);
    all_.push_back(std::move(object));
    return all_.back();
}

std::string Objects::id_of(const Object& object) { return kNumbered + std::to_string(object.number); }

Object& Objects::find(const std::string& id, const FileLocation& from) {
    if (id.starts_with(kNumbered)) {
        const auto number = parse_whole_number<uint32_t>(std::string_view(id).substr(1));
        if (number && *number < all_.size()) return all_[*number];
    }
    std::string name = id;
    for (int i = 0; i < 16; ++i) {
        if (const auto found = ids_.find(name); found != ids_.end()) return all_[found->second];
        const auto alias = aliases_.find(name);
        if (alias == aliases_.end()) break;
        name = alias->second;
    }
    throw Error(ErrorCode::BadInput, from,
                fmt::format("there is no object with the id {}{}", shortened(id),
                            ++missing_ <= kMostWithSuggestion ? did_you_mean(id, first_names(ids_)) : ""));
}

Depth::Depth(int& depth, const Object& from) : depth_(depth) {
    if (depth >= kMostDepth)
        throw Error(ErrorCode::BadInput, from.location(),
                    fmt::format("{} is within over {} others, or within itself", from.parameters.what(), kMostDepth));
    ++depth_;
}

} // namespace pertev::mitsuba
