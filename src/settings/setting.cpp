#include "settings/setting.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/json_text.h"
#include "formats/files/parse_number.h"
#include "settings/parse_values.h"

namespace pertev {
namespace {

template <class... Cases>
struct Overloaded : Cases... {
    using Cases::operator()...;
};

template <class Field, class Value>
constexpr bool is_field_of = std::is_same_v<Field, Value*> || std::is_same_v<Field, std::optional<Value>*>;

template <class Field>
constexpr bool is_number = is_field_of<Field, float> || is_field_of<Field, double>;

template <class Field>
constexpr bool is_on_off = std::is_same_v<Field, bool*> || std::is_same_v<Field, InverseSwitch>;

double max_of(const Setting& setting) {
    return setting.high > 0 ? setting.high : double(std::numeric_limits<float>::max());
}

std::string why_no_number_for(const Setting& setting, const std::string& text) {
    return setting.above ? why_not_above(text, setting.low, max_of(setting))
                         : why_no_number(text, setting.low, max_of(setting));
}

std::string text_of(bool value) { return value ? "true" : "false"; }
std::string text_of(const Vec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }
std::string text_of(const DoubleVec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }
std::string text_of(const Rgb& c) { return fmt::format("{},{},{}", c.r, c.g, c.b); }
std::string text_of(const PictureSize& size) { return fmt::format("{}x{}", size.width, size.height); }
std::string text_of(const std::filesystem::path& path) { return path.string(); }
std::string text_of(const std::string& text) { return text; }
std::string text_of(const std::vector<double>& numbers) { return fmt::format("{}", fmt::join(numbers, ",")); }
template <class Number>
    requires std::is_arithmetic_v<Number>
std::string text_of(Number number) {
    return fmt::format("{}", number);
}

void put_value(PictureOptions& options, const Setting& setting, std::span<const std::string> texts) {
    PERTEV_CHECK(is_list(setting) || texts.size() == 1);
    const SettingField field = setting.field(options);
    const std::string name = setting.name, text = texts.empty() ? "" : texts.front();
    std::visit(Overloaded{[&](bool* f) { *f = text == "true"; }, [&](InverseSwitch f) { *f.field = text != "true"; },
                          [&](std::string* f) { *f = text; },
                          [&](std::vector<std::string>* f) { f->assign(texts.begin(), texts.end()); },
                          [&](std::vector<std::filesystem::path>* f) { f->assign(texts.begin(), texts.end()); },
                          [&](std::vector<double>* f) { *f = *numbers_in(text); },
                          [&](std::optional<Vec3>* f) { *f = parse_vec3(name, text); },
                          [&](std::optional<DoubleVec3>* f) { *f = parse_position(name, text); },
                          [&](std::optional<Rgb>* f) { *f = parse_radiance(name, text); },
                          [&](std::optional<PictureSize>* f) {
                              const auto [width, height] = parse_size(name, text);
                              *f = PictureSize{width, height};
                          },
                          [&](NamedField f) { f.set(f.field, text); },
                          [&]<class Number>(std::optional<Number>* f) {
                              if constexpr (std::is_same_v<Number, uint32_t>)
                                  *f = parse_whole_number<Number>(text);
                              else
                                  *f = parse_whole_float<Number>(text);
                          },
                          [&]<class Number>(Number* f) {
                              if constexpr (std::is_same_v<Number, uint32_t>)
                                  *f = *parse_whole_number<Number>(text);
                              else
                                  *f = *parse_whole_float<Number>(text);
                          }},
               field);
}

} // namespace

std::vector<std::string> words_of(std::string_view text) {
    std::vector<std::string> words;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(' '), text.size());
        words.emplace_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return words;
}

bool is_switch(const Setting& setting) {
    return read_field({}, setting, []<class Field>(Field) { return is_on_off<Field>; });
}

bool is_list(const Setting& setting) {
    return read_field({}, setting, []<class Field>(Field) {
        return std::is_same_v<Field, std::vector<std::string>*> ||
               std::is_same_v<Field, std::vector<std::filesystem::path>*>;
    });
}

bool is_vector(const Setting& setting) {
    return read_field({}, setting, []<class Field>(Field) {
        return std::is_same_v<Field, std::vector<double>*> || is_field_of<Field, Vec3> ||
               is_field_of<Field, DoubleVec3> || is_field_of<Field, Rgb>;
    });
}

std::vector<std::string> choices_of(const Setting& setting) {
    PictureOptions any;
    const SettingField field = setting.field(any);
    const NamedField* const named = std::get_if<NamedField>(&field);
    return named != nullptr ? named->names() : setting.choices;
}

bool has_setting(IntegratorKind integrator, const Setting& setting) {
    return setting.integrators == 0 || (setting.integrators >> static_cast<uint32_t>(integrator) & 1u) != 0;
}

std::string why_no_value(const Setting& setting, const std::string& text) {
    if (const std::vector<std::string> choices = choices_of(setting); !choices.empty()) {
        const std::size_t equals = setting.is_by_ray ? text.find('=') : std::string::npos;
        if (equals == std::string::npos) return why_no_choice(text, choices);
        if (!value_named<RayKind>(text.substr(0, equals))) return "expected a kind of ray: camera, bounce or shadow";
        return why_no_choice(text.substr(equals + 1), choices);
    }
    if (setting.is_name) return text.empty() ? "the name is empty" : "";
    return read_field({}, setting, [&]<class Field>(Field) -> std::string {
        if constexpr (is_field_of<Field, uint32_t>) {
            const auto most = setting.high > 0 ? static_cast<uint32_t>(setting.high) : UINT32_MAX;
            return why_not_whole(text, static_cast<uint32_t>(setting.low), most);
        } else if constexpr (is_number<Field>) {
            return why_no_number_for(setting, text);
        } else if constexpr (is_on_off<Field>) {
            return why_no_choice(text, {"true", "false"});
        } else if constexpr (std::is_same_v<Field, std::vector<double>*>) {
            const auto numbers = numbers_in(text);
            const bool is_one = numbers && std::ranges::find(setting.counts, numbers->size()) != setting.counts.end();
            return is_one ? "" : fmt::format("expected {} numbers between commas", fmt::join(setting.counts, " or "));
        } else {
            return "";
        }
    });
}

void set_value(PictureOptions& options, const Setting& setting, std::span<const std::string> texts,
               SettingOrigin origin) {
    for (const std::string& text : texts) {
        if (const std::string why = why_no_value(setting, text); !why.empty()) {
            throw Error(ErrorCode::BadInput, setting.name, text, why);
        }
    }
    put_value(options, setting, texts);
    options.given[setting.name] = origin;
}

std::vector<std::string> texts_of(const PictureOptions& options, const Setting& setting) {
    return read_field(options, setting,
                      Overloaded{[](InverseSwitch f) { return std::vector{text_of(!*f.field)}; },
                                 [](NamedField f) {
                                     const std::string_view name = f.get(f.field);
                                     return name.empty() ? std::vector<std::string>() : std::vector{std::string(name)};
                                 },
                                 [](std::vector<double>* f) {
                                     return f->empty() ? std::vector<std::string>() : std::vector{text_of(*f)};
                                 },
                                 []<class Value>(std::vector<Value>* f) {
                                     std::vector<std::string> texts;
                                     for (const Value& value : *f) texts.push_back(text_of(value));
                                     return texts;
                                 },
                                 []<class Value>(std::optional<Value>* f) {
                                     return *f ? std::vector{text_of(**f)} : std::vector<std::string>();
                                 },
                                 []<class Value>(Value* f) { return std::vector{text_of(*f)}; }});
}

std::string json_of(const PictureOptions& options, const Setting& setting) {
    const std::vector<std::string> texts = texts_of(options, setting);
    if (is_list(setting)) return json_strings(texts);
    if (texts.empty()) return "null";
    if (is_vector(setting)) return json_vector(texts.front()).value();
    return read_field({}, setting, [&]<class Field>(Field) {
        constexpr bool is_bare = is_number<Field> || is_field_of<Field, uint32_t> || is_on_off<Field>;
        return is_bare ? texts.front() : json_string(texts.front());
    });
}

} // namespace pertev
