#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/lower_case.h"
#include "base/message_text.h"
#include "formats/described/transforms.h"
#include "formats/files/closest_name.h"
#include "formats/pbrt/statements.h"

namespace pertev::pbrt {
namespace {

struct NamedSpace {
    std::string_view name;
    ColorPrimaries primaries;
};
constexpr std::array<NamedSpace, 4> kSpaces = {
    {{"srgb", kRec709},
     {"dci-p3", {{0.68, 0.32}, {0.265, 0.69}, {0.15, 0.06}, {0.31271, 0.32902}}},
     {"rec2020", {{0.708, 0.292}, {0.17, 0.797}, {0.131, 0.046}, {0.3127, 0.329}}},
     {"aces2065-1", {{0.7347, 0.2653}, {0, 1}, {0.0001, -0.077}, {0.32168, 0.33767}}}}};

const std::initializer_list<std::string_view> kOptions = {"disablepixeljitter",
                                                          "disabletexturefiltering",
                                                          "disablewavelengthjitter",
                                                          "displacementedgescale",
                                                          "forcediffuse",
                                                          "msereferenceimage",
                                                          "msereferenceout",
                                                          "pixelstats",
                                                          "rendercoordsys",
                                                          "seed",
                                                          "wavefront"};

} // namespace

ViewStatement Statements::take_view(Tokens& tokens, const FileLocation& location, std::string_view what) {
    std::string type = take_text(tokens, location);
    Parameters parameters = take_parameters(tokens, location, fmt::format("the {} {}", what, shortened(type)));
    return {std::move(type), std::move(parameters)};
}

void Statements::camera(Tokens& tokens, const FileLocation& location) {
    world_.view.camera = take_view(tokens, location, "camera");
    world_.view.camera_from_world = world_.state.transforms[0];
    world_.set_camera_medium();
    if (!(world_.state.transforms[0] == world_.state.transforms[1]))
        context_.sink.leave_out({location, "the motion of the camera is left out"});
    world_.coordinate_systems["camera"] = {inverse(world_.state.transforms[0]), inverse(world_.state.transforms[1])};
}

void Statements::film(Tokens& tokens, const FileLocation& location) {
    world_.view.film = take_view(tokens, location, "film");
}

void Statements::sampler(Tokens& tokens, const FileLocation& location) {
    world_.view.sampler = take_view(tokens, location, "sampler");
}

void Statements::integrator(Tokens& tokens, const FileLocation& location) {
    world_.view.integrator = take_view(tokens, location, "integrator");
}

void Statements::pixel_filter(Tokens& tokens, const FileLocation& location) {
    world_.view.filter = take_view(tokens, location, "filter");
}

void Statements::accelerator(Tokens& tokens, const FileLocation& location) {
    ViewStatement stated = take_view(tokens, location, "accelerator");
    constexpr std::array<std::string_view, 3> kTypes = {"bvh", "kdtree", "grid"};
    leave_out_unknown_type(stated, "accelerator", kTypes, context_.sink);
    stated.parameters.ignore(
        {"maxnodeprims", "splitmethod", "intersectcost", "traversalcost", "emptybonus", "maxprims", "maxdepth"});
    stated.parameters.leave_out_unknown(context_.sink);
}

void Statements::option(Tokens& tokens, const FileLocation& location) { // about how pbrt renders
    Parameters parameters = take_parameters(tokens, location, "an option");
    parameters.ignore(kOptions);
    for (const Parameter& parameter : parameters.all()) { // pbrt-v4 compares without case, _ and -
        std::string name = lower_case(parameter.name);
        std::erase_if(name, [](char c) { return c == '_' || c == '-'; });
        if (std::ranges::find(kOptions, name) != kOptions.end()) parameters.look_up(parameter.name);
    }
    parameters.leave_out_unknown(context_.sink);
}

void Statements::color_space(Tokens& tokens, const FileLocation& location) {
    const std::string name = take_text(tokens, location);
    const auto* const found = std::ranges::find(kSpaces, lower_case(name), &NamedSpace::name);
    if (found == kSpaces.end()) {
        std::vector<std::string_view> known;
        for (const NamedSpace& space : kSpaces) known.push_back(space.name);
        throw Error(ErrorCode::BadInput, location,
                    fmt::format("there is no colour space {}{}", shortened(name), did_you_mean(name, known)));
    }
    world_.state.color_space = is_rec709(found->primaries) ? std::nullopt : rec709_from(found->primaries);
}

void Statements::attribute(Tokens& tokens, const FileLocation& location) {
    const std::string target = take_text(tokens, location);
    constexpr std::array<std::string_view, 5> kTargets = {"shape", "light", "material", "medium", "texture"};
    Parameters parameters = take_parameters(tokens, location, fmt::format("the attribute of {}", shortened(target)));
    if (std::ranges::find(kTargets, target) == kTargets.end())
        throw Error(ErrorCode::BadInput, location,
                    fmt::format("there are no attributes of {}{}", shortened(target), did_you_mean(target, kTargets)));
    std::map<std::string, Parameters> all;
    if (world_.state.attributes) all = *world_.state.attributes;
    if (const auto before = all.find(target); before != all.end()) parameters.add_missing(before->second);
    constexpr std::size_t kMostBytes = 4096; // each statement copies them, and a shape may keep them
    if (parameters.bytes() > kMostBytes)
        throw Error(ErrorCode::BadInput, location,
                    fmt::format("the attributes of {} take over {} bytes", target, kMostBytes));
    all.insert_or_assign(target, std::move(parameters));
    world_.state.attributes = std::make_shared<const std::map<std::string, Parameters>>(std::move(all));
}

void Statements::texture(Tokens& tokens, const FileLocation& location) {
    const std::string name = take_text(tokens, location), kind = take_text(tokens, location),
                      type = take_text(tokens, location);
    Parameters parameters =
        take_parameters(tokens, location, fmt::format("the texture {}", shortened(name)), "texture");
    world_.add_texture(name, kind, type, parameters);
}

void Statements::material(Tokens& tokens, const FileLocation& location) {
    const std::string type = take_text(tokens, location);
    Parameters parameters =
        take_parameters(tokens, location, fmt::format("the material {}", shortened(type)), "material");
    world_.set_material(type, parameters);
}

void Statements::make_named_material(Tokens& tokens, const FileLocation& location) {
    const std::string name = take_text(tokens, location);
    Parameters parameters =
        take_parameters(tokens, location, fmt::format("the material {}", shortened(name)), "material");
    world_.make_named_material(name, parameters);
}

void Statements::named_material(Tokens& tokens, const FileLocation& location) {
    world_.set_named_material(take_text(tokens, location), location);
}

void Statements::medium(Tokens& tokens, const FileLocation& location) {
    const std::string name = take_text(tokens, location);
    Parameters parameters = take_parameters(tokens, location, fmt::format("the medium {}", shortened(name)), "medium");
    world_.make_named_medium(name, parameters);
}

void Statements::medium_interface(Tokens& tokens, const FileLocation& location) {
    const std::string inside = take_text(tokens, location);
    const bool has_outside = tokens.peek().kind == TokenKind::Quoted;
    world_.set_media(inside, has_outside ? take_text(tokens, location) : inside, location);
}

void Statements::light(Tokens& tokens, const FileLocation& location) {
    const std::string type = take_text(tokens, location);
    Parameters parameters = take_parameters(tokens, location, fmt::format("the light {}", shortened(type)), "light");
    world_.add_light(type, parameters);
}

void Statements::area_light(Tokens& tokens, const FileLocation& location) {
    const std::string type = take_text(tokens, location);
    Parameters parameters =
        take_parameters(tokens, location, fmt::format("the area light {}", shortened(type)), "light");
    world_.set_area_light(type, parameters);
}

void Statements::shape(Tokens& tokens, const FileLocation& location) {
    const std::string type = take_text(tokens, location);
    Parameters parameters = take_parameters(tokens, location, fmt::format("the shape {}", shortened(type)), "shape");
    world_.add_shape(type, parameters, bytes_);
}

} // namespace pertev::pbrt
