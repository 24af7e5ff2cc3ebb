#include "formats/pbrt/read_parameters.h"

#include <algorithm>

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

/// Adds `token` to the values of `to`. Returns false if it is no value.
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

void read_parameters(Tokens& tokens, Parameters& parameters, Sink& sink) {
    while (tokens.peek().kind == TokenKind::Quoted) {
        const Token declaration = tokens.next();
        const auto [type_name, name] = split(declaration.text);
        const FileLocation location{parameters.location().file, declaration.line};
        Parameter to;
        to.name = std::string(name);
        to.line = declaration.line;
        const auto* const type = std::ranges::find(kTypeNames, type_name, &TypeName::name);
        if (type != std::end(kTypeNames)) to.type = type->type;
        std::string fault;
        const auto take = [&](const Token& token) {
            sink.check_at(to.numbers.size());
            if (!take_value(token, to) && fault.empty())
                fault =
                    fmt::format("\"{}\" is not a value of \"{}\"", shortened(token.text), shortened(declaration.text));
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
            fault = fmt::format("\"{}\" is not a type of a parameter{}", shortened(type_name),
                                did_you_mean(type_name, known));
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
            parameters.add(std::move(to));
        } else {
            sink.leave_out({location, fmt::format("{}; it is left out of {}", fault, parameters.what())});
        }
    }
}

} // namespace pertev::pbrt
