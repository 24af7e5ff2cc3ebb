#include "formats/obj/parse_mtl.h"

#include <algorithm>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "base/lower_case.h"
#include "base/message_text.h"
#include "formats/obj/obj_text.h"
#include "formats/obj/parse_mtl_texture.h"

namespace pertev {
namespace {

struct ColourKey {
    std::string_view key;
    Rgb MtlStatements::*to;
};
constexpr ColourKey kColours[] = {
    {"ks", &MtlStatements::ks}, {"ke", &MtlStatements::ke}, {"tf", &MtlStatements::tf}, {"kt", &MtlStatements::tf}};

struct NumberKey {
    std::string_view key;
    float MtlStatements::*to;
};
constexpr NumberKey kNumbers[] = {{"illum", &MtlStatements::illum}, {"ns", &MtlStatements::ns},
                                  {"ni", &MtlStatements::ni},       {"pr", &MtlStatements::pr},
                                  {"pm", &MtlStatements::pm},       {"ps", &MtlStatements::ps},
                                  {"pc", &MtlStatements::pc},       {"pcr", &MtlStatements::pcr},
                                  {"aniso", &MtlStatements::aniso}, {"anisor", &MtlStatements::anisor}};

struct MapKey {
    std::string_view key;
    MtlTexture MtlStatements::*to;
};
constexpr MapKey kMaps[] = {
    {"map_kd", &MtlStatements::map_kd}, {"map_ke", &MtlStatements::map_ke},   {"map_d", &MtlStatements::map_d},
    {"map_pr", &MtlStatements::map_pr}, {"map_pm", &MtlStatements::map_pm},   {"map_ps", &MtlStatements::map_ps},
    {"map_pc", &MtlStatements::map_pc}, {"map_pcr", &MtlStatements::map_pcr}, {"norm", &MtlStatements::norm},
    {"bump", &MtlStatements::bump},     {"map_bump", &MtlStatements::bump}};

/// Statements that are ignored without a message: ambient light, and those that do not describe the surface.
constexpr std::string_view kHarmless[] = {"ka", "map_ka", "map_aat", "sharpness"};
constexpr std::string_view kLeftOut[] = {"map_ks", "map_ns",   "map_aniso", "map_anisor", "disp",
                                         "decal",  "map_disp", "refl",      "map_refl"};

template <class Range>
bool holds(const Range& keys, std::string_view key) {
    return std::find(std::begin(keys), std::end(keys), key) != std::end(keys);
}

template <class Keys>
auto find_key(const Keys& keys, std::string_view key) {
    const auto found =
        std::find_if(std::begin(keys), std::end(keys), [&](const auto& known) { return known.key == key; });
    return found == std::end(keys) ? nullptr : &*found;
}

class MtlParser {
public:
    MtlParser(std::string_view text, const std::string& file, Sink& sink) : lines_(text), file_(file), sink_(sink) {}

    std::vector<MtlStatements> run() {
        std::string_view line;
        while (lines_.next(line)) {
            key_ = take_word(line);
            if (key_.empty() || key_[0] == '#') continue;
            try {
                statement(line);
            } catch (const MtlFault& fault) {
                sink_.leave_out(
                    {FileLocation{file_, lines_.number()}, fmt::format("{}; the line is left out", fault.what)});
            }
        }
        for (const auto& [key, lines] : left_out_) {
            sink_.leave_out(
                {FileLocation{file_, lines.first_line},
                 fmt::format("{} of {} {} left out", counted(lines.times, "line"), key, is_or_are(lines.times))});
        }
        if (too_long_.times > 0) {
            sink_.leave_out({FileLocation{file_, too_long_.first_line},
                             fmt::format("{} with more numbers than the key has; the rest is left out",
                                         counted(too_long_.times, "line"))});
        }
        if (unknown_.times > 0) {
            sink_.leave_out({FileLocation{file_, unknown_.first_line},
                             fmt::format("{} with an unknown key ({} is the first) {} left out",
                                         counted(unknown_.times, "line"), first_unknown_, is_or_are(unknown_.times))});
        }
        return std::move(materials_);
    }

private:
    void statement(std::string_view line) {
        const std::string key = lower_case(key_);
        if (key == "newmtl") {
            MtlStatements& begun = materials_.emplace_back();
            begun.name = rest_as_name(line);
            begun.line = lines_.number();
            if (begun.name.empty()) unknown();
            return;
        }
        if (materials_.empty()) return unknown();
        MtlStatements& to = materials_.back();
        if (key == "kd") {
            if (const std::optional<Rgb> read = colour(line)) to.kd = read;
        } else if (const ColourKey* as_colour = find_key(kColours, key)) {
            if (const std::optional<Rgb> read = colour(line)) to.*as_colour->to = *read;
        } else if (const NumberKey* as_number = find_key(kNumbers, key)) {
            to.*as_number->to = only_number(line);
        } else if (const MapKey* as_map = find_key(kMaps, key)) {
            MtlTexture& texture = to.*as_map->to;
            texture = parse_mtl_texture(line);
            texture.line = lines_.number();
        } else if (key == "d") {
            std::string_view ahead = line;
            if (take_word(ahead) == "-halo") line = ahead; // denser at the rim: taken as dense everywhere
            to.d = only_number(line);
            to.has_d = true;
        } else if (key == "tr") {
            const float tr = only_number(line);
            if (!to.has_d) to.d = 1 - tr;
        } else if (holds(kLeftOut, key)) {
            if (!rest_as_name(line).empty()) left_out_[std::string(key_)].add(lines_.number());
        } else if (!holds(kHarmless, key)) {
            unknown();
        }
    }

    void unknown() {
        if (unknown_.times == 0) first_unknown_ = shortened(key_);
        unknown_.add(lines_.number());
    }

    void check_end(std::string_view line) {
        if (!is_mtl_end(line)) too_long_.add(lines_.number());
    }

    float only_number(std::string_view line) {
        const float value = take_mtl_number(line, key_);
        check_end(line);
        return value;
    }

    /// Parses a colour; one number is a grey. Returns nothing, with a warning, for a spectral curve and for CIE XYZ.
    std::optional<Rgb> colour(std::string_view line) {
        std::string_view ahead = line;
        const std::string_view word = take_word(ahead);
        if (word == "spectral" || word == "xyz") {
            left_out_[fmt::format("{} {}", key_, word)].add(lines_.number());
            return std::nullopt;
        }
        const float r = take_mtl_number(line, key_);
        if (is_mtl_end(line)) return grey(r);
        const float g = take_mtl_number(line, key_), b = take_mtl_number(line, key_);
        check_end(line);
        return Rgb{r, g, b};
    }

    ObjLines lines_;
    const std::string& file_;
    Sink& sink_;
    std::vector<MtlStatements> materials_;
    std::string_view key_; // key of the statement, as written
    std::map<std::string, CountedLines> left_out_;
    CountedLines unknown_, too_long_;
    std::string first_unknown_;
};

} // namespace

std::vector<MtlStatements> parse_mtl(std::span<const std::byte> bytes, const std::string& file, Sink& sink) {
    return MtlParser(text_of(bytes), file, sink).run();
}

} // namespace pertev
