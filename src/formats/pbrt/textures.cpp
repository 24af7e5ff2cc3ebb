#include "formats/pbrt/textures.h"

#include <array>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/make_texture.h"
#include "formats/described/transforms.h"
#include "formats/files/closest_name.h"
#include "formats/files/parse_number.h"
#include "formats/pbrt/colors.h"
#include "math/scalar.h"

namespace pertev::pbrt {
void Textures::define(const std::string& name, const std::string& kind, const std::string& type,
                      const DoubleTransform& world_from_texture, Parameters& parameters) {
    const bool is_color = kind == "spectrum" || kind == "color";
    if (!is_color && kind != "float") {
        context_.sink.leave_out(
            {parameters.location(), fmt::format("the texture {} of {} is left out; expected float or spectrum",
                                                shortened(name), shortened(kind))});
        return;
    }
    textures_.insert_or_assign(name, value_of(type, is_color, world_from_texture, parameters));
    parameters.leave_out_unknown(context_.sink);
}

TextureValue Textures::value_of(const std::string& type, bool is_color, const DoubleTransform& world_from_texture,
                                Parameters& parameters) {
    if (type == "imagemap") return image_map(world_from_texture, parameters);
    if (type == "constant") return part(parameters, "value", is_color, 1);
    if (type == "checkerboard") return checkerboard(is_color, world_from_texture, parameters);
    if (type == "scale") {
        const bool is_version_3 = parameters.contains("tex1") || parameters.contains("tex2");
        const TextureValue a = part(parameters, is_version_3 ? "tex1" : "tex", is_color, 1);
        const TextureValue b = part(parameters, is_version_3 ? "tex2" : "scale", is_color, 1);
        if (a.has_image() && b.has_image())
            if (const auto both = described::combine_textures(a, b, std::nullopt, made_, combined_)) return *both;
        if (a.varies() && b.varies())
            context_.sink.leave_out(
                {parameters.location(), "the second of two textures that vary is left out of a product"});
        return product(a, b);
    }
    if (type == "directionmix") return direction_mix(is_color, world_from_texture, parameters);
    if (type == "mix") {
        const TextureValue a = part(parameters, "tex1", is_color, 0), b = part(parameters, "tex2", is_color, 1);
        return mixture(a, b, part(parameters, "amount", false, 0.5f), parameters);
    }
    constexpr std::array<std::string_view, 6> kKnown = {"imagemap", "constant", "checkerboard",
                                                        "scale",    "mix",      "directionmix"};
    constexpr std::array<std::string_view, 9> kOthers = {"bilerp", "dots",  "fbm",      "marble", "ptex",
                                                         "uv",     "windy", "wrinkled", "brick"};
    const bool is_known = std::ranges::find(kOthers, type) != kOthers.end();
    context_.sink.leave_out(
        {parameters.location(), fmt::format("textures of the type {} are left out; the value is 0.5{}", shortened(type),
                                            is_known ? "" : did_you_mean(type, kKnown))});
    parameters = Parameters(parameters.location(), parameters.what()); // nothing of it is unknown
    return constant(grey(0.5f));
}

TextureValue Textures::direction_mix(bool is_color, const DoubleTransform& world_from_texture, Parameters& parameters) {
    const TextureValue first = part(parameters, "tex1", is_color, 0), second = part(parameters, "tex2", is_color, 1);
    const DoubleVec3 stated = parameters.vector("dir", context_.sink).value_or(DoubleVec3{0, 1, 0});
    DoubleTransform turned = world_from_texture;
    turned.translation = {0, 0, 0};
    const DoubleVec3 direction = transform_point(turned, stated);
    TextureValue value = mixture(first, second, constant(grey(0.5f)), parameters);
    const double length = std::sqrt(dot(direction, direction));
    const bool are_numbers = !first.has_image() && !second.has_image() && !first.by_normal && !second.by_normal;
    if (are_numbers && length > 0 && std::isfinite(length)) {
        value.by_normal = std::make_shared<NormalMix>(
            NormalMix{{direction.x / length, direction.y / length, direction.z / length}, first.factor, second.factor});
    } else {
        context_.sink.leave_out({parameters.location(),
                                 "the direction of a directionmix is left out, because it mixes more than two colours "
                                 "or has no length; both are mixed evenly"});
    }
    return value;
}

TextureValue Textures::part(Parameters& parameters, std::string_view name, bool is_color, float missing) {
    const Parameter* const found = parameters.find(name);
    if (!is_color || found == nullptr) return number(parameters, name, missing);
    if (found->type == ParameterType::Texture) return look_up(parameters, *found, grey(missing));
    // A product may have a factor above 1.
    const bool is_plain = found->type == ParameterType::Rgb || found->type == ParameterType::Float;
    return constant((is_plain ? plain_color(parameters, name, context_) : reflectance(parameters, name, context_))
                        .value_or(grey(missing)));
}

void Textures::read_mapping(const DoubleTransform& world_from_texture, Parameters& parameters, TextureValue& value) {
    Sink& sink = context_.sink;
    TextureRef& ref = value.ref;
    constexpr std::array<std::string_view, 4> kMappings = {"uv", "planar", "spherical", "cylindrical"};
    const std::string name = parameters.text("mapping", "uv", sink);
    const auto known = std::ranges::find(kMappings, name);
    if (known == kMappings.end())
        sink.leave_out({parameters.location(), fmt::format("the mapping {} is left out; uv is used{}", shortened(name),
                                                           did_you_mean(name, kMappings))});
    if (known != kMappings.end() && name != "uv") {
        TextureMapping mapping;
        mapping.kind = static_cast<MappingKind>(known - kMappings.begin() - 1);
        const bool is_planar = mapping.kind == MappingKind::Planar;
        // pbrt-v3 has planes in the world.
        if (!is_planar || !context_.is_version_3) mapping.texture_from_world = inverse(world_from_texture);
        if (is_planar) {
            mapping.u_axis = parameters.vector("v1", sink).value_or(mapping.u_axis);
            mapping.v_axis = parameters.vector("v2", sink).value_or(mapping.v_axis);
            mapping.u_offset = parameters.number("udelta", 0, sink);
            mapping.v_offset = parameters.number("vdelta", 0, sink);
        }
        parameters.ignore({"uscale", "vscale", "udelta", "vdelta"});
        // At the seam coordinates go on beyond 1, where pbrt's begin at 0 again.
        if (mapping.kind == MappingKind::Spherical) ref.wrap_t = Wrap::Repeat;
        if (mapping.kind == MappingKind::Cylindrical) ref.wrap_s = Wrap::Repeat;
        if (is_finite(mapping.texture_from_world)) {
            value.mapping = std::make_shared<const TextureMapping>(mapping);
            return;
        }
        sink.leave_out(
            {parameters.location(), "a mapping is left out, because its transform has no inverse; uv is used"});
    }
    const auto u_scale = static_cast<float>(parameters.number("uscale", 1, sink));
    const auto v_scale = static_cast<float>(parameters.number("vscale", 1, sink));
    const auto u_delta = static_cast<float>(parameters.number("udelta", 0, sink));
    const auto v_delta = static_cast<float>(parameters.number("vdelta", 0, sink));
    // pbrt's v points up and the scene's down: 1 - (v_scale (1 - v) + v_delta).
    ref.m00 = u_scale, ref.m02 = u_delta;
    ref.m11 = v_scale, ref.m12 = 1 - v_scale - v_delta;
}

TextureValue Textures::image_file(const FileLocation& from, const std::string& name) {
    TextureValue value;
    try {
        value.ref.image = context_.loader.add_file(base_of(context_, from, name), name);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        context_.sink.leave_out(error.remark().and_then("; only its factor is used"));
    }
    value.ref.is_srgb = true;
    return value;
}

TextureValue Textures::image_map(const DoubleTransform& world_from_texture, Parameters& parameters) {
    Sink& sink = context_.sink;
    const std::string name = parameters.text("filename", "", sink);
    if (name.empty()) {
        sink.leave_out({parameters.location(), "an imagemap has no \"string filename\""});
        return constant(grey(0.5f));
    }
    TextureValue value = image_file(parameters.location(), name);
    if (!value.has_image()) value.factor = grey(0.5f);
    const std::string wrap = parameters.text("wrap", "repeat", sink);
    if (wrap == "black" || wrap == "clamp") {
        value.ref.wrap_s = value.ref.wrap_t = Wrap::ClampToEdge;
        value.is_framed = wrap == "black" && value.has_image();
    } else if (wrap != "repeat") {
        sink.leave_out({parameters.location(),
                        fmt::format("the wrap {} is left out; expected repeat, black or clamp", shortened(wrap))});
    }
    if (parameters.text("filter", "", sink) == "point") value.ref.filter = TextureFilter::Nearest;
    std::string encoding = parameters.text("encoding", "sRGB", sink);
    if (!parameters.truth("gamma", true, sink)) encoding = "linear"; // pbrt-v3
    if (encoding == "linear") {
        value.ref.is_srgb = false;
    } else if (encoding.starts_with("gamma ")) {
        const auto exponent = parse_whole_float(std::string_view(encoding).substr(6));
        value.ref.is_srgb = false;
        value.exponent = exponent && *exponent > 0 ? *exponent : 1.0f;
    } else if (encoding != "sRGB") {
        sink.leave_out(
            {parameters.location(),
             fmt::format("the encoding {} is left out; expected sRGB, linear or gamma NUMBER", shortened(encoding))});
    }
    read_mapping(world_from_texture, parameters, value);
    const auto scale = static_cast<float>(parameters.number("scale", 1, sink));
    value = value.scaled(grey(scale));
    if (parameters.truth("invert", false, sink)) {
        value.offset = grey(1);
        value.factor = (value.has_image() ? Rgb{} : value.offset) - value.factor;
    }
    parameters.ignore({"maxanisotropy", "trilinear"});
    return value;
}

TextureValue Textures::checkerboard(bool is_color, const DoubleTransform& world_from_texture, Parameters& parameters) {
    const TextureValue even = part(parameters, "tex1", is_color, 1), odd = part(parameters, "tex2", is_color, 0);
    parameters.ignore({"aamode"});
    TextureValue value;
    read_mapping(world_from_texture, parameters, value);
    if (parameters.integer("dimension", 2, context_.sink) != 2) {
        context_.sink.leave_out(
            {parameters.location(), "a checkerboard of three dimensions is left out; its mean is used"});
        return mixture(even, odd, constant(grey(0.5f)), parameters);
    }
    // The image covers two checks each way: half the coordinates, which begin at the lower left corner.
    TextureRef& ref = value.ref;
    ref.m00 *= 0.5f, ref.m02 *= 0.5f;
    ref.m11 *= 0.5f, ref.m12 = 0.5f + 0.5f * ref.m12;
    ref.filter = TextureFilter::Nearest;
    value.made = static_cast<int32_t>(made_.size());
    if (even.has_image() || odd.has_image()) {
        made_.push_back(described::checks_of(grey(0), grey(1)));
        if (const auto all = described::combine_textures(even, odd, value, made_, combined_)) return *all;
        context_.sink.leave_out({parameters.location(), "a checkerboard of images is left out; its mean is used"});
        return mixture(even, odd, constant(grey(0.5f)), parameters);
    }
    made_.push_back(checks_of(even.factor, odd.factor));
    return value;
}

TextureValue Textures::mixture(const TextureValue& a, const TextureValue& b, const TextureValue& amount,
                               const Parameters& parameters) {
    const Rgb share_of_b = amount.has_image() ? grey(0.5f) : amount.factor;
    if (share_of_b == grey(0)) return a;
    if (share_of_b == grey(1)) return b;
    const int images = int(a.has_image()) + int(b.has_image()) + int(amount.has_image());
    const auto left_out = [&](const char* what) { context_.sink.leave_out({parameters.location(), what}); };
    if (a.by_normal || b.by_normal || amount.by_normal)
        left_out("the direction of a directionmix in a mixture is left out");
    if (images == 0) return constant(lerp(a.factor, b.factor, amount.factor.g));
    if (amount.has_image() && images == 1) {
        TextureValue value = amount.scaled(b.factor - a.factor);
        value.offset += a.factor;
        return value;
    }
    if (images > 1)
        if (const auto all = described::combine_textures(a, b, amount, made_, combined_)) return *all;
    const float share = amount.has_image() ? 0.5f : clamp(amount.factor.g, 0.0f, 1.0f);
    if (amount.has_image())
        left_out("the image that mixes two textures is left out beside theirs; they are mixed evenly");
    if (a.has_image() && b.has_image()) {
        if (share > 0 && share < 1) left_out("of a mixture of two images the one with the smaller share is left out");
        return share < 0.5f ? a : b;
    }
    const TextureValue& image = a.has_image() ? a : b;
    const float of_image = a.has_image() ? 1 - share : share;
    TextureValue value = image.scaled(grey(of_image));
    value.offset += (1 - of_image) * (a.has_image() ? b.factor : a.factor);
    return value;
}

TextureValue Textures::look_up(const Parameters& parameters, const Parameter& parameter, Rgb missing) {
    const std::string& name = parameter.texts.front();
    if (const auto found = textures_.find(name); found != textures_.end()) {
        took_by_normal_ += found->second.by_normal ? 1 : 0;
        return found->second;
    }
    if (!context_.options.geometry_only) {
        context_.sink.leave_out(
            {parameters.location_of(parameter),
             fmt::format("there is no texture {} for \"{}\" of {}{}", shortened(name), parameter.name,
                         parameters.what(), did_you_mean(name, first_names(textures_)))});
    }
    return constant(missing);
}

TextureValue Textures::color(Parameters& parameters, std::string_view name, Rgb missing) {
    const Parameter* const found = parameters.find(name);
    if (found == nullptr || found->type != ParameterType::Texture)
        return constant(reflectance(parameters, name, context_).value_or(missing));
    TextureValue value = look_up(parameters, *found, missing);
    const Rgb c = value.factor;
    if (!value.has_image()) value.factor = {clamp(c.r, 0.0f, 1.0f), clamp(c.g, 0.0f, 1.0f), clamp(c.b, 0.0f, 1.0f)};
    return value;
}

TextureValue Textures::number(Parameters& parameters, std::string_view name, float missing) {
    const Parameter* const found = parameters.find(name);
    if (found != nullptr && found->type == ParameterType::Texture) {
        TextureValue value = as_number(look_up(parameters, *found, grey(missing)),
                                       context_.is_version_3 ? GreyOf::EncodedLuminance : GreyOf::Mean);
        value.ignores_alpha = context_.is_version_3;
        return value;
    }
    return constant(grey(static_cast<float>(parameters.number(name, static_cast<double>(missing), context_.sink))));
}

} // namespace pertev::pbrt
