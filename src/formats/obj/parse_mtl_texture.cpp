#include "formats/obj/parse_mtl_texture.h"

#include <optional>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/files/parse_number.h"
#include "formats/obj/obj_text.h"
#include "math/scalar.h"

namespace pertev {
namespace {

bool take_switch(std::string_view& text, std::string_view of) {
    const std::string_view word = take_word(text);
    if (word == "on" || word == "off") return word == "on";
    throw MtlFault{fmt::format("{}: \"{}\" is neither on nor off", of, shortened(word))};
}

/// Parses the one to three numbers of -o, -s and -t. Before the name, a number that ends the line is the name.
void take_up_to_three(std::string_view& text, std::string_view of, bool is_behind_name, float (&to)[3]) {
    for (float& value : to) {
        std::string_view ahead = text, word = take_word(ahead);
        const std::optional<float> read = parse_float(word);
        if (!read || !word.empty() || (!is_behind_name && is_mtl_end(ahead))) return;
        if (!is_finite(*read)) throw MtlFault{fmt::format("{}: {} is not a finite number", of, *read)};
        value = *read;
        text = ahead;
    }
}

/// Parses the option at the start of `text` and removes it. Returns false if there is none.
bool take_option(std::string_view& text, bool is_behind_name, MtlTexture& to) {
    std::string_view ahead = text;
    const std::string_view option = take_word(ahead);
    if (option == "-o" || option == "-s" || option == "-t") {
        Vec2& pair = option == "-s" ? to.scale : to.offset;
        float numbers[3] = {pair.x, pair.y, 0};
        take_up_to_three(ahead, option, is_behind_name, numbers);
        if (option != "-t") pair = {numbers[0], numbers[1]}; // -t is turbulence
    } else if (option == "-clamp") {
        to.clamp = take_switch(ahead, option);
    } else if (option == "-blendu" || option == "-blendv" || option == "-cc") {
        take_switch(ahead, option);
    } else if (option == "-bm") {
        to.bump_multiplier = take_mtl_number(ahead, option);
    } else if (option == "-mm") {
        take_mtl_number(ahead, option);
        take_mtl_number(ahead, option);
    } else if (option == "-boost" || option == "-texres") {
        take_mtl_number(ahead, option);
    } else if (option == "-imfchan") {
        const std::string_view channel = take_word(ahead);
        if (!channel.empty()) to.channel = channel[0];
    } else if (option == "-colorspace") {
        to.is_linear = take_word(ahead) == "linear";
    } else if (option == "-type") {
        take_word(ahead);
    } else {
        return false;
    }
    text = ahead;
    return true;
}

/// Returns whether `text` consists of options.
bool are_options(std::string_view text, MtlTexture& to) {
    MtlTexture read = to;
    try {
        do {
            if (!take_option(text, true, read)) return false;
        } while (!is_mtl_end(text));
    } catch (const MtlFault&) {
        return false;
    }
    to = read;
    return true;
}

} // namespace

bool is_mtl_end(std::string_view text) {
    skip_space(text);
    return text.empty() || text[0] == '#';
}

float take_mtl_number(std::string_view& text, std::string_view of) {
    if (is_mtl_end(text)) throw MtlFault{fmt::format("{} lacks a number", of)};
    const std::string_view word = take_word(text);
    std::string_view rest = word;
    const std::optional<float> value = parse_float(rest);
    if (!value || !rest.empty()) throw MtlFault{fmt::format("{}: \"{}\" is not a number", of, shortened(word))};
    if (!is_finite(*value)) throw MtlFault{fmt::format("{}: {} is not a finite number", of, shortened(word))};
    return *value;
}

MtlTexture parse_mtl_texture(std::string_view text) {
    MtlTexture to;
    while (take_option(text, false, to)) {
    }
    std::string_view name = rest_as_name(text);
    for (std::size_t at = name.find('-'); at != name.npos; at = name.find('-', at + 1)) {
        if (at == 0 || !is_obj_space(name[at - 1]) || !are_options(name.substr(at), to)) continue;
        name = rest_as_name(name.substr(0, at));
        break;
    }
    if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    to.name = name;
    return to;
}

} // namespace pertev
