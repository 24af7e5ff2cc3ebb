#include "formats/mitsuba/textures.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/make_texture.h"
#include "formats/files/closest_name.h"

namespace pertev::mitsuba {

TextureValue Textures::value_of(Object& texture, ColorUse use) {
    auto known = known_.find({texture.number, use});
    if (known == known_.end()) known = known_.emplace(std::pair{texture.number, use}, read(texture, use)).first;
    took_vertex_colors_ = took_vertex_colors_ || known->second.is_of_vertices;
    return known->second;
}

/// Returns the texture that another one of the type scale multiplies, under whatever name; null if it has none.
Object* Textures::scaled_by(Object& texture) {
    if (Object* const found = child_of(texture, "texture", reading_)) return found;
    for (const Parameter& parameter : texture.parameters.all()) {
        if (parameter.type != ParameterType::Texture || parameter.name == "scale" || parameter.name == "value")
            continue;
        Object* const found = reading_.object_of(texture, parameter);
        if (found == nullptr || found->tag != "texture") continue;
        texture.parameters.look_up(parameter.name);
        return found;
    }
    return nullptr;
}

TextureValue Textures::read(Object& texture, ColorUse use) {
    const Depth depth(reading_.depth, texture);
    Parameters& parameters = texture.parameters;
    Sink& sink = reading_.sink();
    TextureValue value;
    constexpr std::array<std::string_view, 4> kKnown = {"bitmap", "checkerboard", "scale", "mesh_attribute"};
    constexpr std::array<std::string_view, 5> kOthers = {"gridtexture", "curvature", "wireframe", "volume",
                                                         "vertexcolors"};
    if (texture.type == "bitmap") {
        value = bitmap(texture);
    } else if (texture.type == "checkerboard") {
        value = checkerboard(texture, use);
    } else if (texture.type == "scale") {
        Object* const inner = scaled_by(texture);
        const TextureValue factor = color(texture, "scale", ColorUse::Index, grey(1));
        value = product(inner != nullptr ? value_of(*inner, use) : color(texture, "value", use, grey(0.5f)), factor);
    } else if (texture.type == "mesh_attribute" && parameters.text("name", "", sink) == "vertex_color") {
        value = constant(grey(static_cast<float>(parameters.number("scale", 1, sink))));
        value.is_of_vertices = use != ColorUse::Index;
        if (!value.is_of_vertices)
            sink.leave_out({texture.location(), "colours of vertices are those of surfaces, not their weights, "
                                                "opacities or other numbers; the factor is used"});
    } else {
        const bool is_known = std::ranges::find(kOthers, texture.type) != kOthers.end() || texture.type == kKnown[3];
        sink.leave_out({texture.location(),
                        fmt::format("textures of the type {} are left out; the value is 0.5{}", shortened(texture.type),
                                    is_known ? "" : did_you_mean(texture.type, kKnown))});
        parameters = Parameters(texture.location(), parameters.what()); // nothing of it is unknown
        value = constant(grey(0.5f));
    }
    parameters.leave_out_unknown(sink);
    return value;
}

void Textures::read_placing(Object& texture, TextureRef& ref) {
    Sink& sink = reading_.sink();
    Parameters& parameters = texture.parameters;
    const DoubleTransform to_uv = transform_of(texture, "to_uv", sink);
    const auto number = [&](const char* name, double missing) {
        return static_cast<float>(parameters.number(name, missing, sink));
    };
    // Mitsuba 0.6 has them in place of to_uv.
    const float u_scale = number("uscale", 1), v_scale = number("vscale", 1);
    const float u_offset = number("uoffset", 0), v_offset = number("voffset", 0);
    ref.m00 = u_scale * static_cast<float>(to_uv.row0.x);
    ref.m01 = u_scale * static_cast<float>(to_uv.row0.y);
    ref.m02 = u_scale * static_cast<float>(to_uv.translation.x) + u_offset;
    ref.m10 = v_scale * static_cast<float>(to_uv.row1.x);
    ref.m11 = v_scale * static_cast<float>(to_uv.row1.y);
    ref.m12 = v_scale * static_cast<float>(to_uv.translation.y) + v_offset;
}

TextureValue Textures::bitmap(Object& texture) {
    Sink& sink = reading_.sink();
    Parameters& parameters = texture.parameters;
    TextureValue value;
    const std::string name = parameters.text("filename", "", sink);
    try {
        if (name.empty()) throw parameters.error("a bitmap has no filename");
        const FoundName found = locate(reading_.context, texture.location(), name);
        value.ref.image = reading_.context.loader.add_file(found.from, found.reference);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        sink.leave_out(error.remark().and_then("; the texture's value is 0.5"));
    }
    if (!value.has_image()) value.factor = grey(0.5f);
    const std::string filter = parameters.text("filter_type", "bilinear", sink);
    if (filter == "nearest") value.ref.filter = TextureFilter::Nearest;
    const std::string wrap = parameters.text("wrap_mode", "repeat", sink);
    const std::string wrap_v = parameters.text("wrap_mode_v", wrap, sink),
                      wrap_u = parameters.text("wrap_mode_u", wrap, sink);
    const auto wrap_of = [&](const std::string& mode) {
        if (mode == "repeat") return Wrap::Repeat;
        if (mode == "mirror") return Wrap::MirroredRepeat;
        if (mode != "clamp")
            sink.leave_out(
                {texture.location(), fmt::format("the wrap mode {} is left out; the edge continues", shortened(mode))});
        return Wrap::ClampToEdge;
    };
    value.ref.wrap_s = wrap_of(wrap_u);
    value.ref.wrap_t = wrap_of(wrap_v);
    value.ref.is_srgb = !parameters.truth("raw", false, sink);
    value.ignores_alpha = true;
    const double gamma = parameters.number("gamma", -1, sink); // Mitsuba 0.6 has it; -1 is the file's own
    if (gamma > 0) {
        value.ref.is_srgb = false;
        value.exponent = static_cast<float>(gamma);
    }
    if (parameters.has("channel")) parameters.leave_out({"channel"}, "the first one counts", sink);
    parameters.ignore({"accel", "cache", "max_anisotropy", "format", "mipmap"});
    read_placing(texture, value.ref);
    return value;
}

TextureValue Textures::checkerboard(Object& texture, ColorUse use) {
    TextureValue first = color(texture, "color0", use, grey(0.4f)), second = color(texture, "color1", use, grey(0.2f));
    if (use == ColorUse::Index) {
        first = number_of(first), second = number_of(second);
        if (!reading_.context.is_old) std::swap(first, second); // Mitsuba 3 exchanges the checks of numbers
    }
    TextureValue value;
    read_placing(texture, value.ref);
    if (first.has_image() || second.has_image()) {
        reading_.sink().leave_out({texture.location(), "a checkerboard of images is left out; its mean is used"});
        return constant(0.5f * (first.factor + second.factor));
    }
    value.ref.filter = TextureFilter::Nearest;
    value.made = static_cast<int32_t>(reading_.parts.made.size());
    reading_.parts.made.push_back(checks_of(second.factor, first.factor));
    return value;
}

TextureValue Textures::color(Object& object, std::string_view name, ColorUse use, Rgb missing) {
    const Parameter* const found = object.parameters.find(name);
    if (found == nullptr) return constant(missing);
    if (found->type == ParameterType::Texture) {
        Object* const inner = reading_.object_of(object, *found);
        if (inner == nullptr) return constant(missing);
        if (inner->tag == "texture") return value_of(*inner, use);
    }
    return constant(color_of(object, *found, use, reading_).value_or(missing));
}

TextureValue Textures::number_of(const TextureValue& value) const {
    return as_number(value, reading_.context.is_old ? GreyOf::Mean : GreyOf::Luminance);
}

TextureValue Textures::number(Object& object, std::string_view name, float missing) {
    return number_of(color(object, name, ColorUse::Index, grey(missing)));
}

} // namespace pertev::mitsuba
