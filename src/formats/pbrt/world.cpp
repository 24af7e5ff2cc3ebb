#include "formats/pbrt/world.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/assemble.h"
#include "formats/described/described_medium.h"
#include "formats/described/inner_boundaries.h"
#include "formats/described/light_tables.h"
#include "formats/described/transforms.h"
#include "formats/described/usable_values.h"
#include "formats/files/closest_name.h"
#include "formats/pbrt/media.h"

namespace pertev::pbrt {
namespace {

std::string alpha_key(const std::string& texture) { return "texture " + texture; }

} // namespace

World::World(const Context& context)
    : context_(context), textures_(context, parts_.made, parts_.combined), shapes_(context, parts_.meshes) {
    parts_.missing_coordinates = {Vec2{0, 1}, Vec2{1, 1}, Vec2{1, 0}}; // (0, 0), (1, 0) and (1, 1) with v upwards
    Surface grey_surface = make_surface(MaterialKind::Diffuse);
    grey_surface.material.name = "default";
    parts_.surfaces.push_back(std::move(grey_surface));
}

/// Returns the present transform; that at the end of the shutter's time is left out, and reported once.
DoubleTransform World::place(const FileLocation& from) {
    if (!(state.transforms[0] == state.transforms[1]) && !std::exchange(has_motion_, true)) {
        context_.sink.leave_out({from, "the motion between the transforms of StartTime and EndTime is left out"});
    }
    return state.transforms[0];
}

void World::add_texture(const std::string& name, const std::string& kind, const std::string& type,
                        Parameters& parameters) {
    if (context_.options.geometry_only) return;
    textures_.define(name, kind, type, state.transforms[0], parameters);
    alpha_numbers_.erase(alpha_key(name)); // shapes from here on have the new one
}

const Surface* World::find_surface(const std::string& name, const FileLocation& from) {
    if (const auto found = named_surfaces_.find(name); found != named_surfaces_.end())
        return &parts_.surfaces[found->second];
    if (name == "interface" || name.empty()) {
        static const Surface nothing = [] {
            Surface surface;
            surface.is_nothing = true;
            return surface;
        }();
        return &nothing;
    }
    context_.sink.leave_out({from, fmt::format("there is no material {}{}", shortened(name),
                                               did_you_mean(name, first_names(named_surfaces_)))});
    return nullptr;
}

uint32_t World::add_surface(const std::string& type, const std::string& name, Parameters& parameters) {
    if (context_.options.geometry_only) return 0;
    const FindMaterial find = [this](const std::string& other, const FileLocation& from) {
        return find_surface(other, from);
    };
    Surface surface = read_material({type, parameters, textures_, context_, find});
    if (surface.beneath.empty()) surface.material.name = name; // parts of a mixture have their own
    surface.material.origin = fmt::format("{}:{}", parameters.location().file, parameters.location().line);
    keep_usable(surface.material, parameters.location(), context_.sink);
    parts_.surfaces.push_back(std::move(surface));
    return static_cast<uint32_t>(parts_.surfaces.size() - 1);
}

void World::set_material(const std::string& type, Parameters& parameters) {
    state.surface = add_surface(type, type.empty() ? "interface" : type, parameters);
}

void World::make_named_material(const std::string& name, Parameters& parameters) {
    const std::string type = parameters.text("type", "", context_.sink);
    if (type.empty()) throw parameters.error(fmt::format("the material {} has no \"string type\"", shortened(name)));
    named_surfaces_.insert_or_assign(name, add_surface(type, name, parameters));
}

void World::set_named_material(const std::string& name, const FileLocation& from) {
    if (context_.options.geometry_only) return;
    state.surface = 0;
    if (const Surface* const found = find_surface(name, from)) {
        const auto number = named_surfaces_.find(name);
        if (number != named_surfaces_.end()) {
            state.surface = number->second;
        } else {
            parts_.surfaces.push_back(*found);
            state.surface = static_cast<uint32_t>(parts_.surfaces.size() - 1);
        }
    }
}

void World::set_area_light(const std::string& type, Parameters& parameters) {
    state.area_light.reset();
    if (context_.options.geometry_only) return;
    if (auto light = read_area_light(type, parameters, textures_, context_)) {
        state.area_light = static_cast<uint32_t>(parts_.area_lights.size());
        parts_.area_lights.push_back(*std::move(light));
    }
}

void World::add_light(const std::string& type, Parameters& parameters) {
    const DoubleTransform world_from_light = place(parameters.location());
    if (type == "infinite") {
        if (auto light = read_infinite_light(parameters, world_from_light, context_))
            parts_.infinite_lights.push_back(*std::move(light));
        return;
    }
    const DoubleVec3 from = parameters.vector("from", context_.sink).value_or(DoubleVec3{0, 0, 0});
    if (auto light = read_light(type, parameters, world_from_light, context_))
        described::add_light({*std::move(light), transform_point(world_from_light, from), parameters.location()},
                             parts_.lights);
}

std::optional<uint32_t> World::alpha_of(Parameters& parameters) {
    const Parameter* const found = parameters.find("alpha");
    parameters.ignore({"shadowalpha"}); // pbrt-v3's
    if (found == nullptr || context_.options.geometry_only) return std::nullopt;
    const std::string key =
        found->texts.empty() ? fmt::format("{}", found->numbers.front()) : alpha_key(found->texts.front());
    const TextureValue value = textures_.number(parameters, "alpha", 1);
    if (!value.has_image() && value.factor.r >= 1) return std::nullopt;
    const auto [number, is_new] = alpha_numbers_.try_emplace(key, static_cast<uint32_t>(parts_.alphas.size()));
    if (is_new) parts_.alphas.push_back(value);
    return number->second;
}

void World::add_shape(const std::string& type, Parameters& parameters, uint64_t file_bytes) {
    const uint64_t most = described::max_placed(file_bytes);
    if (++shape_count_ > most)
        throw Error(ErrorCode::OverLimit, parameters.location(),
                    fmt::format("more than {} shapes, the limit for files of this size", most));
    Placed placed;
    if (parts_.surfaces[state.surface].is_nothing && state.area_light)
        context_.sink.leave_out(
            {parameters.location(), "the light of a shape without a surface is left out, as pbrt does"});
    if (!fill(placed)) return;
    const auto read = shapes_.read(type, state.is_reversed, parameters);
    if (!read) return;
    placed.mesh = read->mesh;
    placed.surface = state.surface;
    placed.alpha = alpha_of(parameters);
    if (!parts_.surfaces[state.surface].is_nothing) placed.area_light = state.area_light;
    parameters.leave_out_unknown(context_.sink);
    const std::string& file = parts_.meshes[read->mesh].file;
    placed.name = file.empty() ? type : std::filesystem::path(file).stem().string();
    if (placed.name.ends_with(".ply")) placed.name.resize(placed.name.size() - 4);
    placed.world_from_mesh = compose(place(parameters.location()), read->from_mesh);
    if (open_object_ && placed.area_light) {
        context_.sink.leave_out({parameters.location(), "the light of a shape in an object is left out, as pbrt does"});
        placed.area_light.reset();
    }
    (open_object_ ? objects_[*open_object_] : parts_.placed).push_back(std::move(placed));
}

World::NamedMedium& World::medium_called(const std::string& name, const FileLocation& from) {
    const auto [medium, is_new] = media_.try_emplace(name);
    if (is_new) {
        medium->second = {static_cast<uint32_t>(parts_.media.size()), from, false};
        parts_.media.emplace_back();
    }
    return medium->second;
}

void World::make_named_medium(const std::string& name, Parameters& parameters) {
    NamedMedium& medium = medium_called(name, parameters.location());
    medium.is_defined = true;
    const std::string type = parameters.text("type", "", context_.sink);
    if (type != "homogeneous") {
        constexpr std::array<std::string_view, 6> kTypes = {"homogeneous", "cloud",   "nanovdb",
                                                            "uniformgrid", "rgbgrid", "heterogeneous"};
        const bool is_known = std::ranges::find(kTypes, type) != kTypes.end();
        throw parameters.error(fmt::format("the medium {} of the type {} is left out; it is a vacuum{}",
                                           shortened(name), shortened(type),
                                           is_known ? "" : did_you_mean(type, kTypes)));
    }
    parts_.media[medium.index] = read_medium(parameters, context_);
    parameters.leave_out_unknown(context_.sink);
}

void World::set_media(const std::string& inside, const std::string& outside, const FileLocation& location) {
    state.inside = inside, state.outside = outside;
    for (const std::string& name : {inside, outside}) {
        if (!name.empty()) (void)medium_called(name, location);
    }
}

/// Returns the index of a medium of this name; nothing for a vacuum.
std::optional<uint32_t> World::medium_index(const std::string& name) const {
    const auto medium = media_.find(name);
    return medium != media_.end() ? std::optional(medium->second.index) : std::nullopt;
}

/// Sets the media of a shape. Returns false if the shape is an interface between equal media, which is not there.
bool World::fill(Placed& placed) {
    const Surface& surface = parts_.surfaces[state.surface];
    if (context_.options.geometry_only || (state.inside == state.outside && surface.is_nothing))
        return !surface.is_nothing;
    // MediumInterface holds for later shapes too, so that opaque ones often have a medium inside without meaning it.
    if (described::is_entered(surface) || described::is_passed_straight(surface))
        placed.medium = medium_index(state.inside);
    if (state.inside != state.outside) placed.outside = medium_index(state.outside);
    return true;
}

/// Reports undefined media, and finds the medium around the whole scene.
void World::finish_media() {
    for (const auto& [name, medium] : media_) {
        if (medium.is_defined) continue;
        std::vector<std::string_view> known;
        for (const auto& [other, defined] : media_) {
            if (defined.is_defined) known.push_back(other);
        }
        context_.sink.leave_out({medium.from, fmt::format("there is no medium {}{}; it is a vacuum", shortened(name),
                                                          did_you_mean(name, known))});
    }
    described::finish_media(medium_index(around_), context_.sink, parts_);
}

void World::begin_object(const std::string& name, const FileLocation& from) {
    if (open_object_)
        throw Error(ErrorCode::BadInput, from,
                    fmt::format("the object {} begins inside of {}", shortened(name), shortened(*open_object_)));
    open_object_ = name;
    objects_[name].clear();
}

void World::end_object(const FileLocation& from) {
    if (!open_object_) throw Error(ErrorCode::BadInput, from, "ObjectEnd without ObjectBegin");
    open_object_.reset();
}

void World::add_instance(const std::string& name, const FileLocation& from, uint64_t file_bytes) {
    if (open_object_) throw Error(ErrorCode::BadInput, from, "an ObjectInstance within an object is left out");
    const auto object = objects_.find(name);
    if (object == objects_.end()) {
        throw Error(ErrorCode::BadInput, from,
                    fmt::format("there is no object {}{}", shortened(name), did_you_mean(name, first_names(objects_))));
    }
    const uint64_t most = described::max_placed(file_bytes);
    if (parts_.placed.size() + object->second.size() > most) {
        throw Error(ErrorCode::OverLimit, from,
                    fmt::format("more than {} instances, the limit for files of this size", most));
    }
    const DoubleTransform world_from_object = place(from);
    for (const Placed& shape : object->second) {
        parts_.placed.push_back(shape);
        parts_.placed.back().world_from_mesh = compose(world_from_object, shape.world_from_mesh);
    }
}

Scene World::finish(uint64_t file_bytes) {
    shapes_.finish();
    described::add_inner_boundaries(parts_);
    finish_media();
    Scene scene = assemble(std::move(parts_), scene_from_world(view), file_bytes,
                           "a statement such as Shape \"sphere\"", context_.loader, context_.sink);
    add_view(view, context_, scene);
    return scene;
}

} // namespace pertev::pbrt
