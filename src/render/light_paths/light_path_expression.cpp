#include "render/light_paths/light_path_expression.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "render/light_paths/light_path_nfa.h"

namespace pertev {
namespace {

constexpr uint32_t kMaxNesting = 200;
constexpr uint32_t kMaxRepeats = 255;
constexpr std::string_view kBlanks = " \t";

/// Explains why a letter begins nothing, with the letter that others write for it or that is missing, if known.
std::string_view why_no_atom(char letter) {
    switch (letter) {
    case '*':
    case '+':
    case '?':
    case '{':
        return "nothing stands before it that it could repeat";
    case '<':
        return "names follow a single letter, once; in brackets each letter has its own: D<R 'a'>, [D<'a'>G<'a'>]";
    case '\'':
    case '"':
        return "names are enclosed in < and >: L<'lamp'>";
    case ',':
        return "expected one expression; give each its own `lpe` NAME=EXPRESSION";
    case 'C':
        return "expressions go from the light to the eye: LD*E is CD*L elsewhere";
    case 'l':
    case 'd':
    case 'g':
    case 's':
    case 'e':
        return "letters are upper case: L, D, G, S, E";
    default:
        return "unknown letter; expected L, D, G, S, ., E, ( or [";
    }
}

class Parser {
public:
    explicit Parser(LightPathExpression& expression) : expression_(expression), text_(expression.text) {}

    void parse() {
        if (text_.find_first_not_of(kBlanks) == std::string_view::npos) fail(0, "expected an expression, such as LD*E");
        expression_.root = parse_choice(0);
        if (peek() == ')') fail(at_, "no ( stands before it");
        if (at_ < text_.size()) fail(at_, why_no_atom(text_[at_]));
    }

private:
    [[noreturn]] void fail(std::size_t offset, std::string_view why) const {
        throw Error(ErrorCode::BadInput, point_at(expression_, offset, why));
    }
    /// Returns the next letter that is not blank; 0 at the end.
    char peek() {
        at_ = std::min(text_.find_first_not_of(kBlanks, at_), text_.size());
        return at_ < text_.size() ? text_[at_] : '\0';
    }
    bool take(char letter) {
        if (peek() != letter) return false;
        ++at_;
        return true;
    }
    uint32_t add(LightPathNode node) {
        expression_.nodes.push_back(std::move(node));
        return static_cast<uint32_t>(expression_.nodes.size() - 1);
    }
    uint32_t add(LightPathLetter letter) {
        expression_.letters.push_back(std::move(letter));
        return add(LightPathNode{.kind = LightPathNode::Kind::Letter,
                                 .letter = static_cast<uint32_t>(expression_.letters.size() - 1)});
    }

    uint32_t parse_choice(uint32_t nesting) {
        if (nesting > kMaxNesting) fail(at_, fmt::format("more than {} nested parentheses", kMaxNesting));
        LightPathNode choice = {.kind = LightPathNode::Kind::Choice};
        choice.parts.push_back(parse_branch(nesting));
        while (take('|')) choice.parts.push_back(parse_branch(nesting));
        return choice.parts.size() == 1 ? choice.parts.front() : add(std::move(choice));
    }
    uint32_t parse_branch(uint32_t nesting) {
        LightPathNode branch = {.kind = LightPathNode::Kind::Sequence};
        for (char next = peek(); next != 0 && next != '|' && next != ')'; next = peek()) {
            branch.parts.push_back(parse_piece(nesting));
        }
        return add(std::move(branch));
    }
    uint32_t parse_piece(uint32_t nesting) {
        uint32_t piece = parse_atom(nesting);
        for (;;) {
            LightPathNode repeat = {.kind = LightPathNode::Kind::Repeat, .parts = {piece}};
            if (take('*')) {
            } else if (take('+')) {
                repeat.least = 1;
            } else if (take('?')) {
                repeat.most = 1;
            } else if (peek() == '{') {
                parse_counts(repeat);
            } else {
                return piece;
            }
            piece = add(std::move(repeat));
        }
    }
    void parse_counts(LightPathNode& repeat) {
        const std::size_t open = at_;
        take('{');
        repeat.least = repeat.most = parse_count();
        if (take(',')) repeat.most = peek() == '}' ? LightPathNode::kAny : parse_count();
        if (!take('}')) fail(at_, "} is missing: {2}, {2,} or {2,5}");
        if (repeat.most < repeat.least) fail(open, "the second number is smaller than the first");
    }
    uint32_t parse_count() {
        peek();
        const std::size_t first = at_;
        uint32_t count = 0;
        for (; at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9'; ++at_) {
            count = std::min(count * 10 + static_cast<uint32_t>(text_[at_] - '0'), kMaxRepeats + 1);
        }
        if (at_ == first) fail(at_, "expected a whole number: {2}, {2,} or {2,5}");
        if (count > kMaxRepeats) fail(first, fmt::format("at most {}", kMaxRepeats));
        return count;
    }
    uint32_t parse_atom(uint32_t nesting) {
        const char letter = peek();
        const std::size_t offset = at_;
        switch (letter) {
        case '(': {
            ++at_;
            const uint32_t inner = parse_choice(nesting + 1);
            if (!take(')')) fail(offset, "this ( is not closed");
            return inner;
        }
        case '[':
            return parse_set();
        case 'L': {
            ++at_;
            LightPathLetter light = {.kind = LightPathLetter::Kind::Light};
            uint8_t modes = 0;
            if (peek() == '<') light.names = parse_filter(modes);
            if (modes != 0) fail(offset, "R and T apply only to scattering; a light has only a name, L<'lamp'>");
            return add(std::move(light));
        }
        case 'E':
            ++at_;
            if (peek() == '<') fail(at_, "the eye E takes no name");
            return add(LightPathLetter{.kind = LightPathLetter::Kind::Eye});
        default:
            break;
        }
        if (const auto term = parse_term()) return add(LightPathLetter{.terms = {*term}});
        fail(offset, why_no_atom(letter));
    }
    /// Parses D, G, S or . with its filter.
    std::optional<ScatteringTerm> parse_term() {
        ScatteringTerm term;
        switch (peek()) {
        case 'D':
            term.classes = only(LobeClass::Diffuse);
            break;
        case 'G':
            term.classes = only(LobeClass::Glossy);
            break;
        case 'S':
            term.classes = only(LobeClass::Specular);
            break;
        case '.':
            break;
        default:
            return std::nullopt;
        }
        ++at_;
        if (peek() != '<') return term;
        uint8_t modes = 0;
        term.names = parse_filter(modes);
        if (modes != 0) term.modes = modes;
        return term;
    }
    uint32_t parse_set() {
        const std::size_t open = at_;
        take('[');
        LightPathLetter set;
        set.is_negated = take('^');
        while (const auto term = parse_term()) set.terms.push_back(*term);
        const char next = peek();
        if (next == 'L' || next == 'E') fail(at_, "a set can hold only scatterings: D, G, S or .");
        if (next == 0) fail(open, "this [ is not closed");
        if (next != ']') fail(at_, "unknown letter of a set; expected D, G, S or .");
        if (set.terms.empty()) fail(at_, "a set is empty; expected at least one letter, as in [DS]");
        ++at_;
        return add(std::move(set));
    }
    /// Parses a filter. Returns kNoNames if it has no names, and leaves `modes` if it has none.
    uint32_t parse_filter(uint8_t& modes) {
        const std::size_t open = at_;
        take('<');
        if (take('R')) {
            modes = kReflected;
        } else if (take('T')) {
            modes = kTransmitted;
        }
        NameFilter filter;
        const std::size_t caret = peek() == '^' ? at_ : text_.size();
        filter.is_negated = take('^');
        while (peek() == '\'' || peek() == '"') filter.names.push_back(parse_name());
        if (peek() == 0) fail(open, "this < is not closed");
        if (peek() != '>') fail(at_, "expected R or T, then names between < and >: <T 'glass' 'wine*'>");
        if (filter.is_negated && filter.names.empty()) fail(caret, "^ comes before names: <^'wall'>");
        if (filter.names.empty() && modes == 0) fail(at_, "expected R or T, then names between < and >: <T 'glass'>");
        ++at_;
        if (filter.names.empty()) return kNoNames;
        expression_.filters.push_back(std::move(filter));
        return static_cast<uint32_t>(expression_.filters.size() - 1);
    }
    NameFilter::Name parse_name() {
        const std::size_t open = at_;
        const char quote = text_[at_++];
        std::string pattern;
        for (; at_ < text_.size() && text_[at_] != quote; ++at_) {
            if (text_[at_] == '\\' && at_ + 1 < text_.size()) pattern += text_[at_++];
            pattern += text_[at_];
        }
        if (at_ == text_.size()) fail(open, "this quotation mark is not closed");
        if (pattern.empty()) fail(at_, "expected a name");
        ++at_;
        return {std::move(pattern), open + 1};
    }

    LightPathExpression& expression_;
    const std::string_view text_;
    std::size_t at_ = 0;
};

bool is_name(std::string_view name) {
    const auto is_letter = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    };
    return !name.empty() && name.size() <= 64 && std::ranges::all_of(name, is_letter);
}

/// Number of visible letters before byte `offset`; UTF-8 has up to four bytes per letter.
std::size_t letters_before(std::string_view text, std::size_t offset) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text.substr(0, offset), [](char c) { return (static_cast<uint8_t>(c) & 0xc0) != 0x80; }));
}

} // namespace

Remark point_at(const LightPathExpression& expression, std::size_t offset, std::string_view why) {
    const std::size_t column = letters_before(expression.text, offset);
    std::string shown = expression.text;
    std::ranges::replace_if(
        shown, [](char c) { return static_cast<uint8_t>(c) < ' '; }, ' ');
    return {"lpe", expression.name,
            fmt::format("character {}: {}\n  {}\n  {}^", column + 1, why, shown, std::string(column, ' '))};
}

LightPathExpression parse_light_path(std::string_view text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos || !is_name(text.substr(0, equals))) {
        throw Error(ErrorCode::BadInput, "lpe", std::string(text),
                    "expected NAME=EXPRESSION, as caustics=LS+DE; a name has letters, digits, - and _, 64 at most");
    }
    LightPathExpression expression;
    expression.name = text.substr(0, equals);
    expression.text = text.substr(equals + 1);
    if (expression.text.size() > kMaxLightPathText) {
        throw Error(ErrorCode::OverLimit, "lpe", expression.name,
                    fmt::format("an expression has more than {} characters", kMaxLightPathText));
    }
    Parser(expression).parse();
    check_matches_something(expression);
    return expression;
}

} // namespace pertev
