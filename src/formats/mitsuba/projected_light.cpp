#include "formats/mitsuba/projected_light.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/light_tables.h"
#include "formats/mitsuba/colors.h"
#include "formats/mitsuba/view.h"
#include "math/portable_math.h"

namespace pertev::mitsuba {
namespace {

/// The axes of what a picture is projected by: Mitsuba's +x is on the left. Spots turn it by half a circle.
constexpr LightAxes kProjectorAxes = {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr LightAxes kSpotAxes = {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}};

/// Returns whether a picture's first and last columns differ, or its rows.
bool has_other_edges(const Image& picture, bool across) {
    const uint32_t count = across ? picture.height : picture.width;
    for (uint32_t i = 0; i < count; ++i) {
        const float* const first = across ? picture.at(0, i) : picture.at(i, 0);
        const float* const last = across ? picture.at(picture.width - 1, i) : picture.at(i, picture.height - 1);
        if (!std::equal(first, first + picture.channels, last)) return true;
    }
    return false;
}

/// Reads how a bitmap goes on beyond its edges. A light shows half a pixel of that, the edge's own; if the other edge
/// would be there, it is left out, with a notice if the file leaves it to Mitsuba's default.
void report_edges(Object& texture, const IntensityTable& table, Sink& sink) {
    Parameters& parameters = texture.parameters;
    const std::string both = parameters.text("wrap_mode", "repeat", sink);
    for (const bool across : {true, false}) {
        const char* const name = across ? "wrap_mode_u" : "wrap_mode_v";
        const std::string mode = parameters.text(name, both, sink);
        const bool is_edge = mode == "clamp" || mode == "mirror"; // both are the same half a pixel from the edge
        if (is_edge || table.filter == TableFilter::Nearest || !has_other_edges(table.values, across)) continue;
        const bool is_stated = parameters.has(name) || parameters.has("wrap_mode");
        Remark remark(texture.location(),
                      fmt::format("the wrap mode {} along {} of a light's picture is left out; its outer half pixels "
                                  "have the edge's own colours",
                                  shortened(mode), across ? 'u' : 'v'));
        if (is_stated)
            sink.leave_out(std::move(remark));
        else
            sink.note(std::move(remark));
    }
}

/// Returns the bitmap of parameter `name`, if that is one, in `table`. Sets `is_missing`, with a warning, if there is
/// one that cannot be read.
bool find_picture(Object& emitter, std::string_view name, Reading& reading, IntensityTable& table, bool& is_missing) {
    const Parameter* const parameter = emitter.parameters.find(name);
    Object* const texture = parameter != nullptr ? reading.object_of(emitter, *parameter) : nullptr;
    if (texture == nullptr || texture->tag != "texture") return false;
    Sink& sink = reading.sink();
    Parameters& of_texture = texture->parameters;
    is_missing = true;
    const std::string file = of_texture.text("filename", "", sink);
    const auto leave_out = [&](const std::string& why) {
        sink.leave_out({texture->location(), why + "; the light is left out"});
        return false;
    };
    if (texture->type != "bitmap" || file.empty()) return leave_out("a light projects bitmaps with a filename");
    const auto path = find_file(reading.context, texture->location(), file);
    if (!path) return leave_out(fmt::format("there is no picture {}", shortened(file)));
    std::optional<Image> picture = read_light_picture(*path, sink);
    if (!picture) return false;
    table.values = *std::move(picture);
    if (of_texture.text("filter_type", "bilinear", sink) == "nearest") table.filter = TableFilter::Nearest;
    if (of_texture.truth("raw", false, sink))
        sink.leave_out({texture->location(), "raw is left out; the picture's values are decoded as it says itself"});
    if (name == "irradiance") report_edges(*texture, table, sink); // a spot's edge hides that of its picture
    of_texture.ignore({"wrap_mode", "wrap_mode_u", "wrap_mode_v", "accel", "cache", "format", "mipmap"});
    of_texture.leave_out_unknown(sink);
    is_missing = false;
    return true;
}

/// Multiplies a picture by the fall-off of a spot.
void multiply_by_edge(float beam, float cutoff, IntensityTable& table) {
    Image& values = table.values;
    for (uint32_t row = 0; row < values.height; ++row) {
        for (uint32_t column = 0; column < values.width; ++column) {
            const float x = (2 * (static_cast<float>(column) + 0.5f) / static_cast<float>(values.width) - 1);
            const float y = (2 * (static_cast<float>(row) + 0.5f) / static_cast<float>(values.height) - 1);
            const float angle = atan(sqrt(square(x * table.half_width) + square(y * table.half_height)));
            const float edge = angle <= beam ? 1.0f : max((cutoff - angle) / (cutoff - beam), 0.0f);
            for (uint32_t channel = 0; channel < values.channels; ++channel) values.at(column, row)[channel] *= edge;
        }
    }
}

/// Enlarges a small picture, whose pixels would make the edge coarse.
Image enlarged(Image from, TableFilter filter) {
    constexpr uint32_t kLeast = 512;
    const uint32_t shorter = std::min(from.width, from.height), factor = (kLeast + shorter - 1) / shorter;
    if (factor <= 1 || from.pixels.size() * factor > (1u << 24) / factor) return from;
    Image to = {.width = from.width * factor, .height = from.height * factor, .channels = from.channels, .pixels = {}};
    to.pixels.resize(std::size_t(to.width) * to.height * to.channels);
    const auto coordinate = [&](uint32_t at, uint32_t size) {
        if (filter == TableFilter::Nearest) return static_cast<float>(at / factor);
        const float centre = (static_cast<float>(at) + 0.5f) / static_cast<float>(factor) - 0.5f;
        return clamp(centre, 0.0f, static_cast<float>(size - 1));
    };
    for (uint32_t row = 0; row < to.height; ++row) {
        const float y = coordinate(row, from.height);
        const auto above = static_cast<uint32_t>(y), below = std::min(above + 1, from.height - 1);
        for (uint32_t column = 0; column < to.width; ++column) {
            const float x = coordinate(column, from.width);
            const auto left = static_cast<uint32_t>(x), right = std::min(left + 1, from.width - 1);
            const float s = x - floor(x), t = y - floor(y);
            for (uint32_t channel = 0; channel < from.channels; ++channel) {
                const float upper = lerp(from.at(left, above)[channel], from.at(right, above)[channel], s);
                const float lower = lerp(from.at(left, below)[channel], from.at(right, below)[channel], s);
                to.at(column, row)[channel] = lerp(upper, lower, t);
            }
        }
    }
    return to;
}

} // namespace

bool set_spot(Object& emitter, const DoubleTransform& to_world, Reading& reading, Light& light) {
    Parameters& parameters = emitter.parameters;
    Sink& sink = reading.sink();
    const auto angle = [&](std::string_view name, double missing, double least, double most) {
        return usable_cone(parameters.number(name, missing, sink), least, most, name, emitter.location(), sink);
    };
    const double cutoff_deg = angle("cutoff_angle", 20, 0.1, kWidestCone);
    const double beam_deg = angle("beam_width", 0.75 * cutoff_deg, 0, cutoff_deg);
    const float cutoff = static_cast<float>(cutoff_deg) * (kPi / 180),
                beam = static_cast<float>(beam_deg) * (kPi / 180);
    leave_out_stretch(to_world, emitter.location(), sink);
    set_axes(kSpotAxes, to_world, light);
    IntensityTable picture;
    bool is_missing = false;
    if (find_picture(emitter, "texture", reading, picture, is_missing)) {
        picture.layout = TableLayout::Perspective;
        picture.values = enlarged(std::move(picture.values), picture.filter);
        picture.half_width = picture.half_height = tan(cutoff);
        multiply_by_edge(beam, cutoff, picture);
        set_table(std::move(picture), light);
    } else if (beam < cutoff) {
        set_table(make_round_table(
                      cutoff, [&](float at) { return at <= beam ? 1.0f : max((cutoff - at) / (cutoff - beam), 0.0f); }),
                  light);
    } else {
        light.kind = LightKind::Spot;
        light.cos_inner = cos(beam);
        light.cos_outer = min(cos(cutoff), light.cos_inner - kSharpestEdge);
    }
    return !is_missing;
}

bool set_projector(Object& emitter, const DoubleTransform& to_world, Reading& reading, Light& light) {
    Sink& sink = reading.sink();
    IntensityTable table;
    bool is_missing = false;
    light.intensity = grey(1);
    if (!find_picture(emitter, "irradiance", reading, table, is_missing)) {
        if (is_missing) return false;
        light.intensity = read_color(emitter, "irradiance", ColorUse::Light, grey(1), reading);
        table.values = {.width = 1, .height = 1, .channels = 1, .pixels = {1.0f}};
    }
    if (has_scale(to_world)) {
        sink.leave_out({emitter.location(), "the scale of a projector's to_world is left out; it turns, moves and "
                                            "mirrors"});
    }
    table.layout = TableLayout::PictureIrradiance;
    // Mitsuba's irradiance is of a plane whose radiance it would be: pi times what arrives at z = 1.
    light.intensity =
        kPi * static_cast<float>(std::max(emitter.parameters.number("scale", 1, sink), 0.0)) * light.intensity;
    set_view(tangent_across(emitter, static_cast<double>(table.values.width) / table.values.height, sink), table);
    set_axes(kProjectorAxes, to_world, light);
    set_table(std::move(table), light);
    return true;
}

} // namespace pertev::mitsuba
