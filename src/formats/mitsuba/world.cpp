#include "formats/mitsuba/world.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/assemble.h"
#include "formats/described/inner_boundaries.h"
#include "formats/described/make_surface.h"
#include "formats/described/mix_surfaces.h"
#include "formats/described/transforms.h"
#include "formats/mitsuba/backs.h"
#include "formats/mitsuba/emitters.h"

namespace pertev::mitsuba {

World::World(Context& context, Objects& objects) : context_(context), objects_(objects) {
    parts_.missing_coordinates = {Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}};
    Surface surface = make_surface(MaterialKind::Diffuse);
    surface.material.name = "default";
    surface.is_one_sided = true;
    parts_.surfaces.push_back(surface);
    if (context.is_old) return;
    surface.material.name = "default of emitters";
    surface.is_one_sided = false; // it is black
    surface.material.base_color = {0, 0, 0};
    parts_.surfaces.push_back(std::move(surface));
}

void World::add_instance(Object& instance) {
    const DoubleTransform to_world = transform_of(instance, "to_world", context_.sink);
    const std::vector<Object*> groups = objects_in(instance, "shape", reading_);
    instance.parameters.leave_out_unknown(context_.sink);
    if (groups.size() != 1 || groups.front()->type != "shapegroup")
        throw instance.parameters.error("an instance needs one shapegroup");
    for (Object* const shape : objects_in(*groups.front(), "shape", reading_)) {
        if (shape->type == "instance" || shape->type == "shapegroup")
            throw shape->parameters.error("a shapegroup in another one");
        add_shape(*shape, to_world);
    }
}

void World::add_shape(Object& shape, const DoubleTransform& world_from_group) {
    try {
        const Depth depth(reading_.depth, shape);
        if (++visited_ > 2 * most_placed_) // shapes that each merge two others multiply, though nothing is placed
            throw Error(ErrorCode::OverLimit, shape.location(), "shapes contain each other too often");
        if (shape.type == "shapegroup") return; // its instances show it
        if (shape.type == "instance") return add_instance(shape);
        if (shape.type == "merge") {
            for (Object* const part : objects_in(shape, "shape", reading_)) add_shape(*part, world_from_group);
            return;
        }
        place(shape, world_from_group);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        context_.sink.leave_out(error.remark().and_then("; the shape is left out"));
    }
}

/// Returns what the radiance of an emitter is multiplied by: opacity dims the light of a surface here, but not in
/// Mitsuba.
float World::over_opacity(const Surface& surface, const Object& emitter) {
    const Material& material = surface.material;
    if (surface.is_nothing || !surface.beneath.empty() || material.alpha_mode == AlphaMode::Opaque) return 1;
    if (!described::has_alpha_image(surface) && material.alpha > 0) return 1 / material.alpha;
    context_.sink.leave_out({emitter.location(), "the light of a surface whose opacity is a picture or 0 is dimmed by "
                                                 "it, though it is not in Mitsuba"});
    return 1;
}

void World::place(Object& shape, const DoubleTransform& world_from_group) {
    Sink& sink = context_.sink;
    if (parts_.placed.size() >= most_placed_)
        throw Error(ErrorCode::OverLimit, shape.location(),
                    fmt::format("more than {} instances, the limit for files of this size", most_placed_));
    const std::vector<Object*> bsdfs = objects_in(shape, "bsdf", reading_);
    const std::vector<Object*> emitters = objects_in(shape, "emitter", reading_);
    const auto leave_out_second = [&](const std::vector<Object*>& parts) {
        for (std::size_t i = 1; i < parts.size(); ++i) {
            sink.leave_out({parts[i]->location(),
                            fmt::format("{} is left out, because {} has another {}", parts[i]->parameters.what(),
                                        shape.parameters.what(), parts[i]->tag)});
        }
    };
    leave_out_second(bsdfs);
    leave_out_second(emitters);
    for (const Object* const child :
         objects_without_use(shape, {"bsdf", "emitter", "medium", "subsurface", "shape"}, reading_))
        sink.leave_out({child->location(),
                        fmt::format("{} is left out of {}", child->parameters.what(), shape.parameters.what())});
    Placed placed;
    if (!bsdfs.empty() && !context_.options.geometry_only) placed.surface = bsdfs_.surface_of(*bsdfs.front());
    if (!emitters.empty() && !context_.options.geometry_only) {
        Object& emitter = *emitters.front();
        const float factor = over_opacity(parts_.surfaces[placed.surface], emitter);
        const auto known = area_lights_.find({emitter.number, factor});
        if (known != area_lights_.end()) {
            placed.area_light = known->second;
        } else if (auto light = read_area_light(emitter, textures_, reading_)) {
            placed.area_light = static_cast<uint32_t>(parts_.area_lights.size());
            area_lights_[{emitter.number, factor}] = *placed.area_light;
            light->radiance = factor * light->radiance;
            parts_.area_lights.push_back(*std::move(light));
        }
        if (bsdfs.empty() && placed.area_light && !context_.is_old) placed.surface = 1;
        if (placed.area_light && parts_.surfaces[placed.surface].is_nothing)
            sink.leave_out({emitter.location(), fmt::format("what lies behind {} is left out: light passes an emitter "
                                                            "whose BSDF is null in Mitsuba, but not here",
                                                            shape.parameters.what())});
    }
    if (!objects_in(shape, "subsurface", reading_).empty())
        sink.leave_out({shape.location(), fmt::format("subsurface of {} is left out; a medium inside of it scatters "
                                                      "likewise",
                                                      shape.parameters.what())});
    const Media::OfShape media = context_.options.geometry_only ? Media::OfShape{} : media_.of_shape(shape);
    if (parts_.surfaces[placed.surface].is_nothing && !placed.area_light && !media.ends_medium) return;
    placed.medium = media.inside, placed.outside = media.outside;
    const Surface& surface = parts_.surfaces[placed.surface];
    const bool has_normal_map = surface.material.normal_texture.has_image() && !surface.has_heights;
    const auto read =
        shapes_.read(shape, {has_normal_map, determinant(world_from_group) < 0, surface.has_vertex_colors});
    if (!read) return;
    shape.parameters.ignore({"silhouette_sampling_weight", "flip_normals"});
    shape.parameters.leave_out_unknown(sink);
    placed.mesh = read->mesh;
    const std::string& file = parts_.meshes[read->mesh].file;
    placed.name = !shape.id.empty() ? shape.id
                  : file.empty()    ? shape.type
                                    : std::filesystem::path(file).stem().string();
    placed.world_from_mesh = compose(world_from_group, read->world_from);
    parts_.placed.push_back(std::move(placed));
}

/// Leaves out the black backs of surfaces, as far as they may show.
void World::leave_out_backs() {
    std::vector<DoubleVec3> sensors;
    for (Object* const sensor : view_.sensors)
        sensors.push_back(transform_of(*sensor, "to_world", context_.sink).translation);
    const VisibleBacks backs = find_visible_backs(parts_, sensors);
    if (backs.count == 0) return;
    const Placed& first = parts_.placed[backs.first];
    const std::string others =
        backs.count > 1 ? fmt::format(" and of {}", counted(backs.count - 1, "other shape")) : "";
    context_.sink.leave_out({parts_.meshes[first.mesh].location,
                             fmt::format("the black back of {}{} is left out; both faces reflect here, which only "
                                         "those of twosided BSDFs do in Mitsuba",
                                         shortened(first.name), others)});
}

Scene World::finish(uint64_t file_bytes) {
    most_placed_ = described::max_placed(file_bytes);
    for (const uint32_t number : std::vector<uint32_t>(objects_.top())) {
        Object& object = objects_.at(number);
        context_.sink.check_at(number);
        if (object.tag == "shape") {
            add_shape(object, {});
        } else if (object.tag == "emitter") {
            if (!context_.options.geometry_only) add_emitter(object, reading_);
        } else if (object.tag == "sensor") {
            view_.sensors.push_back(&object);
            media_.set_around(object);
        } else if (object.tag == "integrator") {
            view_.integrator = &object;
        }
    }
    shapes_.finish();
    if (!context_.options.geometry_only) leave_out_backs();
    described::add_inner_boundaries(parts_);
    media_.finish();
    Scene scene = assemble(std::move(parts_), scene_from_world(view_, context_.sink), file_bytes,
                           "an element such as <shape type=\"sphere\"/>", context_.loader, context_.sink);
    add_view(view_, reading_, scene);
    return scene;
}

} // namespace pertev::mitsuba
