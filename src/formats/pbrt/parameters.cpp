#include "formats/pbrt/parameters.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/files/closest_name.h"
#include "formats/files/parse_number.h"

namespace pertev::pbrt {
namespace {

struct TypeName {
    std::string_view name;
    ParameterType type;
    std::size_t size; // numbers of one value; 0: any
};
constexpr TypeName kTypeNames[] = {{"integer", ParameterType::Integer, 1},
                                   {"float", ParameterType::Float, 1},
                                   {"bool", ParameterType::Bool, 0},
                                   {"string", ParameterType::String, 0},
                                   {"point2", ParameterType::Point2, 2},
                                   {"vector2", ParameterType::Vector2, 2},
                                   {"point3", ParameterType::Point3, 3},
                                   {"vector3", ParameterType::Vector3, 3},
                                   {"normal3", ParameterType::Normal3, 3},
                                   {"point", ParameterType::Point3, 3},
                                   {"vector", ParameterType::Vector3, 3},
                                   {"normal", ParameterType::Normal3, 3},
                                   {"rgb", ParameterType::Rgb, 3},
                                   {"color", ParameterType::Rgb, 3},
                                   {"xyz", ParameterType::Xyz, 3},
                                   {"spectrum", ParameterType::Spectrum, 0},
                                   {"blackbody", ParameterType::Blackbody, 1},
                                   {"texture", ParameterType::Texture, 0}};

/// Splits `TYPE NAME`. The name is empty if there is none.
std::pair<std::string_view, std::string_view> split(std::string_view declaration) {
    constexpr std::string_view kBlanks = " \t";
    const std::size_t begin = std::min(declaration.find_first_not_of(kBlanks), declaration.size());
    declaration.remove_prefix(begin);
    const std::size_t end = std::min(declaration.find_first_of(kBlanks), declaration.size());
    std::string_view name = declaration.substr(end);
    name.remove_prefix(std::min(name.find_first_not_of(kBlanks), name.size()));
    name = name.substr(0, std::min(name.find_first_of(kBlanks), name.size()));
    return {declaration.substr(0, end), name};
}

/// Takes the value that `token` is. Returns whether it is one.
bool take_value(const Token& token, Parameter& to) {
    const bool is_truth = to.type == ParameterType::Bool && token.kind == TokenKind::Word;
    if (token.kind == TokenKind::Quoted || is_truth) {
        to.texts.push_back(unescaped(token.text));
        return !token.is_open_ended;
    }
    std::string_view text = token.text;
    const std::optional<double> number = parse_float<double>(text);
    if (!number || !text.empty()) return false;
    to.numbers.push_back(*number);
    return true;
}

/// Returns whether a token may stand in a list. A statement, which begins with a capital, may not, so that a list
/// without its end costs nothing else.
bool may_be_value(const Token& token) {
    if (token.kind == TokenKind::Quoted) return true;
    if (token.kind != TokenKind::Word) return false;
    std::string_view text = token.text;
    return !(text[0] >= 'A' && text[0] <= 'Z') || parse_float<double>(text).has_value();
}

bool holds_texts(ParameterType type) {
    return type == ParameterType::Bool || type == ParameterType::String || type == ParameterType::Texture;
}

} // namespace

void Parameters::read(Tokens& tokens, Sink& sink) {
    while (tokens.peek().kind == TokenKind::Quoted) {
        const Token declaration = tokens.next();
        const auto [type_name, name] = split(declaration.text);
        const FileLocation place{location_.file, declaration.line};
        Parameter to;
        to.name = std::string(name);
        to.line = declaration.line;
        const auto* const type = std::ranges::find(kTypeNames, type_name, &TypeName::name);
        if (type != std::end(kTypeNames)) to.type = type->type;
        std::string fault;
        const auto take = [&](const Token& token) {
            sink.check_at(to.numbers.size());
            if (!take_value(token, to) && fault.empty())
                fault = fmt::format("\"{}\" is no value of \"{}\"", shortened(token.text), shortened(declaration.text));
        };
        if (tokens.peek().kind == TokenKind::Open) {
            tokens.next();
            while (may_be_value(tokens.peek())) take(tokens.next());
            if (tokens.peek().kind == TokenKind::Close) {
                tokens.next();
            } else if (fault.empty()) {
                fault = fmt::format("the list of \"{}\" has no ]", shortened(declaration.text));
            }
        } else if (tokens.peek().kind == TokenKind::Word || tokens.peek().kind == TokenKind::Quoted) {
            take(tokens.next());
        }
        if (type == std::end(kTypeNames)) {
            std::vector<std::string_view> known;
            for (const TypeName& row : kTypeNames) known.push_back(row.name);
            fault =
                fmt::format("\"{}\" is no type of a parameter{}", shortened(type_name), did_you_mean(type_name, known));
        } else if (name.empty()) {
            fault = fmt::format("\"{}\" has no name; expected \"TYPE NAME\"", shortened(declaration.text));
        } else if (fault.empty() && to.numbers.empty() && to.texts.empty()) {
            fault = fmt::format("\"{}\" has no value", shortened(declaration.text));
        } else if (fault.empty() && to.texts.empty() == holds_texts(to.type) && to.type != ParameterType::Spectrum) {
            fault = fmt::format("\"{}\" has a value of another type", shortened(declaration.text));
        } else if (fault.empty() && type->size > 1 && to.numbers.size() % type->size != 0) {
            fault = fmt::format("\"{}\" has {} numbers; expected a multiple of {}", shortened(declaration.text),
                                to.numbers.size(), type->size);
        }
        if (fault.empty()) {
            all_.push_back(std::move(to));
        } else {
            sink.leave_out({place, fmt::format("{}; it is left out of {}", fault, what_)});
        }
    }
}

void Parameters::add_missing(const Parameters& others) {
    for (const Parameter& parameter : others.all_) {
        if (!contains(parameter.name)) all_.push_back(parameter);
    }
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
    asked_.insert(asked_.end(), names.begin(), names.end());
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
        sink.leave_out({location_of(parameter),
                        fmt::format("the parameter \"{}\" of {} is unknown and left out{}", shortened(parameter.name),
                                    what_, did_you_mean(parameter.name, asked_))});
    }
}

} // namespace pertev::pbrt
