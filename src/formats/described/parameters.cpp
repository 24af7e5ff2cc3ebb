#include "formats/described/parameters.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/files/closest_name.h"

namespace pertev::described {

void Parameters::add_missing(const Parameters& others) {
    for (const Parameter& parameter : others.all_) {
        if (!contains(parameter.name)) all_.push_back(parameter);
    }
}

std::size_t Parameters::bytes() const {
    std::size_t sum = 0;
    for (const Parameter& parameter : all_) {
        sum += parameter.name.size() + parameter.numbers.size() * sizeof(double);
        for (const std::string& text : parameter.texts) sum += sizeof(double) + text.size();
    }
    return sum;
}

bool Parameters::contains(std::string_view name) const {
    return std::ranges::find(all_, name, &Parameter::name) != all_.end();
}

const Parameter* Parameters::find(std::string_view name) {
    if (std::ranges::find(asked_, name) == asked_.end()) asked_.push_back(name);
    const auto found = std::ranges::find(all_, name, &Parameter::name);
    return found == all_.end() ? nullptr : &*found;
}

void Parameters::leave_out_type(const Parameter& parameter, std::string_view expected, Sink& sink) const {
    sink.leave_out({location_of(parameter), fmt::format("the parameter \"{}\" of {} is left out; expected {}",
                                                        shortened(parameter.name), what_, expected)});
}

const Parameter* Parameters::find_of(std::string_view name, std::initializer_list<ParameterType> types,
                                     std::string_view expected, Sink& sink) {
    const Parameter* const found = find(name);
    if (found == nullptr || std::ranges::find(types, found->type) != types.end()) return found;
    leave_out_type(*found, expected, sink);
    return nullptr;
}

double Parameters::number(std::string_view name, double missing, Sink& sink) {
    const Parameter* const found =
        find_of(name, {ParameterType::Float, ParameterType::Integer}, "a number, \"float\"", sink);
    if (found == nullptr) return missing;
    if (std::isfinite(found->numbers.front())) return found->numbers.front();
    leave_out_type(*found, "a finite number", sink);
    return missing;
}

int64_t Parameters::integer(std::string_view name, int64_t missing, Sink& sink) {
    const double value = number(name, static_cast<double>(missing), sink);
    constexpr double kMost = 1e15;
    return static_cast<int64_t>(std::clamp(value, -kMost, kMost));
}

bool Parameters::truth(std::string_view name, bool missing, Sink& sink) {
    const Parameter* const found = find_of(name, {ParameterType::Bool}, "true or false, \"bool\"", sink);
    if (found == nullptr) return missing;
    if (found->texts.front() == "true") return true;
    if (found->texts.front() == "false") return false;
    leave_out_type(*found, "true or false", sink);
    return missing;
}

std::string Parameters::text(std::string_view name, const std::string& missing, Sink& sink) {
    const Parameter* const found = find_of(name, {ParameterType::String}, "a text, \"string\"", sink);
    return found == nullptr ? missing : found->texts.front();
}

std::span<const double> Parameters::numbers(std::string_view name, std::size_t size, Sink& sink) {
    const Parameter* const found = find(name);
    if (found == nullptr) return {};
    if (!found->numbers.empty() && found->numbers.size() % size == 0) return found->numbers;
    leave_out_type(*found, fmt::format("a multiple of {} numbers", size), sink);
    return {};
}

std::optional<DoubleVec3> Parameters::vector(std::string_view name, Sink& sink) {
    const std::span<const double> all = numbers(name, 3, sink);
    if (all.empty()) return std::nullopt;
    return DoubleVec3{all[0], all[1], all[2]};
}

void Parameters::ignore(std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) {
        if (std::ranges::find(asked_, name) == asked_.end()) asked_.push_back(name);
    }
}

void Parameters::leave_out(std::initializer_list<std::string_view> names, std::string_view reason, Sink& sink) {
    for (const std::string_view name : names) {
        if (const Parameter* const found = find(name)) {
            sink.leave_out(
                {location_of(*found), fmt::format("the parameter \"{}\" of {} is left out; {}", name, what_, reason)});
        }
    }
}

void Parameters::leave_out_unknown(Sink& sink) const {
    for (const Parameter& parameter : all_) {
        if (std::ranges::find(asked_, parameter.name) != asked_.end()) continue;
        if (std::ranges::find(looked_up_, parameter.name) != looked_up_.end()) continue;
        sink.leave_out({location_of(parameter),
                        fmt::format("the parameter \"{}\" of {} is unknown and left out{}", shortened(parameter.name),
                                    what_, did_you_mean(parameter.name, asked_))});
    }
}

} // namespace pertev::described
