// Light-path expressions: errors name the character, and the automaton accepts the words that the standard library's
// regular expressions accept.

#include <doctest/doctest.h>

#include <algorithm>
#include <regex>

#include <fmt/format.h>

#include "base/error.h"
#include "render/light_paths/light_path_automaton.h"
#include "render/light_paths/light_path_layers.h"
#include "scene/names.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

constexpr LobeClass kLobeClasses[] = {LobeClass::Diffuse, LobeClass::Glossy, LobeClass::Specular};
constexpr char kLobeLetters[] = "DGS";

/// All objects have one tag, which every filter accepts.
LightPathAutomaton automaton_of(const std::vector<std::string>& texts) {
    std::vector<LightPathExpression> expressions;
    std::size_t filters = 0;
    for (const std::string& text : texts) {
        expressions.push_back(parse_light_path("x=" + text));
        filters += expressions.back().filters.size();
    }
    const std::vector<bool> tag(filters, true);
    return make_automaton(expressions, {{tag}, {tag}});
}

/// Returns the state of a path with the scatterings `word`, from the light to the eye. Lower-case letters are
/// transmissions.
uint16_t state_after(const LightPathAutomaton& automaton, const std::string& word) {
    uint16_t state = automaton.start;
    for (auto letter = word.rbegin(); letter != word.rend(); ++letter) {
        const bool is_small = *letter >= 'a';
        const char capital = is_small ? static_cast<char>(*letter - 'a' + 'A') : *letter;
        const auto number = std::string_view(kLobeLetters).find(capital);
        state = automaton.next_state(state, 0, kLobeClasses[number], is_small);
    }
    return state;
}

/// Returns the layers that receive the path's light, of at most 32.
uint32_t layers_of_word(const LightPathAutomaton& automaton, const std::string& word) {
    REQUIRE(automaton.words == 1);
    return automaton.layers_of(state_after(automaton, word), 0)[0];
}

/// Translates an expression into the syntax of the standard library.
std::regex as_regex(const std::string& text) {
    return std::regex(
        std::regex_replace(std::regex_replace(text, std::regex("\\."), "[DGS]"), std::regex("\\[\\^S\\]"), "[DG]"));
}

/// Returns whether making an automaton of `texts` ends with OverLimit and a message that says `says`.
bool is_over(const std::vector<std::string>& texts, const std::string& says) {
    const auto error = test::thrown_error([&] { automaton_of(texts); });
    if (error) INFO(error->what());
    return error && error->code() == ErrorCode::OverLimit && std::string(error->what()).find(says) != std::string::npos;
}

/// Returns all words of at most `most` letters.
std::vector<std::string> words_of_lobes(std::size_t most) {
    std::vector<std::string> all = {""};
    for (std::size_t first = 0, length = 0; length < most; ++length) {
        const std::size_t end = all.size();
        for (; first < end; ++first) {
            for (const char letter : std::string_view(kLobeLetters)) all.push_back(all[first] + letter);
        }
    }
    return all;
}

std::string lpe_refusal(const std::string& text) {
    return test::bad_input_message([&] { parse_light_path(text); });
}

/// Returns the position of the caret in the last line, without its two blanks.
std::size_t lpe_caret(const std::string& message) { return message.size() - message.rfind("\n  ") - 4; }

} // namespace

TEST_CASE("the automaton accepts exactly the words that std::regex accepts") {
    const std::vector<std::string> texts = {
        "LE",         "L(D|S)*E",      "LDE",     "L(S|D)*D+DE", "LS+DE",         "L.*E",
        "L.{0}E",     "L.{2,3}E",      "L.{2,}E", "L[DS]?G*E",   "L[^S]+E",       "(LD|LS)(G|D)*E",
        "L(D?S){2}E", "L((D|G)*S)*DE", "L(|D)E",  "L(D*)*E",     "L(S(D|GS)?)+E", "LD*E|LS*E|L.G.E"};
    const LightPathAutomaton automaton = automaton_of(texts);
    std::vector<std::regex> oracle;
    for (const std::string& text : texts) oracle.push_back(as_regex(text));
    for (const std::string& word : words_of_lobes(6)) {
        CAPTURE(word);
        uint32_t expected = 0;
        for (std::size_t i = 0; i < texts.size(); ++i) {
            expected |= std::regex_match("L" + word + "E", oracle[i]) ? 1u << i : 0;
        }
        REQUIRE(layers_of_word(automaton, word) == expected);
    }
}

TEST_CASE("an automaton of many expressions accepts each expression's words") {
    std::vector<std::string> texts;
    for (const char* first : {"", "D", "G", "S", "[^S]"}) {
        for (const char* last : {"", "D", "G", "S", "[^S]"}) {
            for (const char* between : {"", ".", ".*", "D+"})
                texts.push_back(std::string("L") + first + between + last + "E");
        }
    }
    REQUIRE(texts.size() == 100);
    std::vector<std::regex> oracle;
    for (const std::string& text : texts) oracle.push_back(as_regex(text));
    for (const std::size_t count : {1u, 31u, 32u, 33u, 63u, 64u, 65u, 96u, 97u, 100u}) {
        CAPTURE(count);
        const LightPathAutomaton automaton =
            automaton_of({texts.begin(), texts.begin() + static_cast<std::ptrdiff_t>(count)});
        CHECK(automaton.words == (count + 31) / 32);
        std::vector<bool> is_taken(count);
        for (const std::string& word : words_of_lobes(4)) {
            CAPTURE(word);
            const uint16_t state = state_after(automaton, word);
            for (uint32_t i = 0; i < count; ++i) {
                const bool takes = automaton.takes(state, 0, i);
                REQUIRE(takes == std::regex_match("L" + word + "E", oracle[i]));
                is_taken[i] = is_taken[i] || takes;
            }
            const std::size_t beyond = automaton.words * 32 - count; // bits without a layer
            if (beyond > 0) REQUIRE((automaton.layers_of(state, 0).back() >> (32 - beyond)) == 0);
        }
        CHECK(std::ranges::count(is_taken, false) == 0);
    }
}

TEST_CASE("the automaton is minimal") {
    CHECK(automaton_of({"L.*E"}).state_count() == 2); // the state, and the one that accepts nothing
    CHECK(automaton_of({"L(D|G|S)*E", "L[DGS]*E"}).state_count() == 2);
    CHECK(automaton_of({"LS+DE"}).state_count() == 4);            // E, DE, SDE
    CHECK(automaton_of({"L(DD|DS|SD|SS)*E"}).state_count() == 3); // even, odd
    CHECK(automaton_of({"LD{200}E"}).state_count() == 202);
    CHECK(automaton_of({"L.*E"}).column_count == 1); // no scatterings are distinguished
}

TEST_CASE("a scattering event may be limited to reflection or transmission") {
    const LightPathAutomaton automaton = automaton_of({"LS<T>+DE", "L[S<R>D]*E", "L[^S<T>]*E", "L.<T>E"});
    CHECK(layers_of_word(automaton, "ssD") == 0b0001);
    CHECK(layers_of_word(automaton, "SD") == 0b0110);
    CHECK(layers_of_word(automaton, "g") == 0b1100); // not S<T>, and transmitted
    CHECK(layers_of_word(automaton, "d") == 0b1110);
    CHECK(layers_of_word(automaton, "s") == 0b1000);
    CHECK(layers_of_word(automaton, "") == 0b0110);
}

TEST_CASE("a bad expression points at its character") {
    const auto points_at = [](const std::string& text, std::size_t place, const std::string& says) {
        const std::string message = lpe_refusal("name=" + text);
        CAPTURE(message);
        CHECK(lpe_caret(message) == place);
        CHECK(message.find("`lpe=name`: character " + std::to_string(place + 1) + ": ") == 0);
        CHECK(message.find(says) != std::string::npos);
        CHECK(message.find("\n  " + text + "\n  ") != std::string::npos);
    };
    points_at("LXE", 1, "unknown letter; expected L");
    points_at("L(DE", 1, "not closed");
    points_at("LD)E", 2, "no (");
    points_at("L[DE", 3, "a set can hold only scatterings");
    points_at("L[D", 1, "not closed");
    points_at("L[]E", 2, "at least one letter");
    points_at("L[Q]E", 2, "unknown letter of a set");
    points_at("*LE", 0, "repeat");
    points_at("L(|+)E", 3, "repeat");
    points_at("LD{2E", 4, "} is missing");
    points_at("LD{}E", 3, "a whole number");
    points_at("LD{3,2}E", 2, "smaller than the first");
    points_at("LD{256}E", 3, "at most 255");
    points_at("L<'lamp>E", 2, "not closed");
    points_at("L<'lamp' E", 9, "between < and >");
    points_at("L<'lamp'", 1, "not closed");
    points_at("L<>E", 2, "between < and >");
    points_at("L<''>E", 3, "expected a name");
    points_at("LD<^>E", 3, "before names");
    points_at("L<T>E", 0, "apply only to scattering");
    points_at("L[DG]<'x'>E", 5, "in brackets");
    points_at("L(D|G)<'x'>E", 6, "in brackets");
    points_at("LD<R><'x'>E", 5, "a single letter");
    points_at("L'lamp'E", 1, "names are enclosed in < and >");
    points_at("LE,b=LDE", 2, "its own `lpe` NAME=EXPRESSION");
    points_at("CD*L", 0, "from the light to the eye");
    points_at("lde", 0, "upper case");
    points_at("LdE", 1, "upper case");
    points_at("LDE<'x'>", 3, "takes no name");
    points_at("", 0, "expected an expression");
    points_at(" DE", 1, "begins with one L");
    points_at("LD", 1, "ends with one E");
    points_at("ELE", 0, "begins with one L");
    points_at("LEE", 0, "only by scatterings");
    points_at("LLE", 0, "only by scatterings");
}

TEST_CASE("characters of a name are counted as displayed") {
    const std::string message = lpe_refusal("n=L<'\xc3\xa4\xc3\xb6'>XE"); // two letters of two bytes each
    CHECK(message.find("character 8") != std::string::npos);
    CHECK(lpe_caret(message) == 7);
}

TEST_CASE("texts other than NAME=EXPRESSION are refused") {
    for (const std::string text : {"LDE", "=LDE", "a b=LDE", "a.b=LDE", "\xc3\xa4=LDE"}) {
        CHECK(lpe_refusal(text).find("expected NAME=EXPRESSION") != std::string::npos);
    }
}

TEST_CASE("expressions that grow without bound are refused") {
    CHECK(is_over({"L" + std::string(5000, 'D') + "E"}, "more than 4096 characters"));
    CHECK(is_over({"L((D{255}){255}){255}E"}, "more than 4096 letters"));
    CHECK(is_over({"L.{15}D.*E"}, "16384 states")); // read from the eye it needs a state for each of 2^15 histories
    CHECK(lpe_refusal("x=L" + std::string(300, '(') + "D" + std::string(300, ')') + "E").find("nested parentheses") !=
          std::string::npos);
    parse_light_path("x=LD" + std::string(4000, '*') + "E"); // nested as deeply as possible
}

TEST_CASE("expressions whose total size is too large are refused") {
    const auto repeated = [](std::size_t count, auto text_of) {
        std::vector<std::string> texts;
        for (std::size_t i = 0; i < count; ++i) texts.push_back(text_of(i));
        return texts;
    };
    CHECK(is_over(repeated(600, [](std::size_t) { return std::string("L(D{255}){16}E"); }),
                  "600 expressions have too many letters"));
    const auto counting = [](std::size_t i) {
        return fmt::format("L(.{{{0}}})*E", 2 * i + 3);
    }; // the number of states is the product
    CHECK(automaton_of(repeated(4, counting)).state_count() == 3 * 5 * 7 * 9 / 3 + 1);
    CHECK(is_over(repeated(12, counting), "16384 states"));
}

TEST_CASE("an automaton that takes too long to build is refused") {
    const std::vector<LightPathExpression> expressions = {parse_light_path("x=LD{30}(SS|SD|SG)E")};
    const LightPathTags tags = {{std::vector<bool>()}, {std::vector<bool>()}};
    const auto with_steps = [&](uint64_t steps) { return make_automaton(expressions, tags, steps); };
    uint64_t enough = 50; // the time to make one automaton
    for (;; enough += 10) {
        const auto error = test::thrown_error([&] { with_steps(enough); });
        if (!error) break;
        REQUIRE(test::is_about(error, ErrorCode::OverLimit, "lpe"));
    }
    CHECK(enough > 100);
    const LightPathAutomaton least = with_steps(kMaxLightPathSteps), larger = with_steps(enough);
    CHECK(least.state_count() == 34); // E, one of DGS, S, 30 of D, and none
    CHECK(larger.state_count() == 36);
    for (const char* end : {"SS", "SD", "SG", "DS", "GS", "S", ""}) {
        for (const std::size_t count : {0u, 29u, 30u, 31u}) {
            const std::string word = std::string(count, 'D') + end;
            CAPTURE(word);
            const bool is_one = count == 30 && end[0] == 'S' && end[1] != 0;
            CHECK(least.takes(state_after(least, word), 0, 0) == is_one);
            CHECK(larger.takes(state_after(larger, word), 0, 0) == is_one);
        }
    }
}

TEST_CASE("names may have wildcards") {
    CHECK(matches_name("lamp", "lamp"));
    CHECK_FALSE(matches_name("lamp", "lamps"));
    CHECK_FALSE(matches_name("lamps", "lamp"));
    CHECK(matches_name("lamp*", "lamp"));
    CHECK(matches_name("*amp*", "lamps"));
    CHECK(matches_name("*a*a*b", "xaxaxbab"));
    CHECK_FALSE(matches_name("*a*a*b", "xaxbxb"));
    CHECK(matches_name("l?mp", "lamp"));
    CHECK_FALSE(matches_name("l?mp", "lmp"));
    CHECK(matches_name("\\*", "*"));
    CHECK_FALSE(matches_name("\\*", "x"));
    CHECK(matches_name("*", ""));
    CHECK_FALSE(matches_name("?", ""));
}
