#include "formats/described/described_medium.h"

#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>

namespace pertev::described {
namespace {

struct Substance {
    std::string_view name;
    Rgb sigma_s, sigma_a; // 1/mm
};
// Source: Jensen, Marschner, Levoy, Hanrahan, "A Practical Model for Subsurface Light Transport", SIGGRAPH 2001,
// fig. 5.
constexpr std::array<Substance, 12> kSubstances = {{{"Apple", {2.29f, 2.39f, 1.97f}, {0.0030f, 0.0034f, 0.046f}},
                                                    {"Chicken1", {0.15f, 0.21f, 0.38f}, {0.015f, 0.077f, 0.19f}},
                                                    {"Chicken2", {0.19f, 0.25f, 0.32f}, {0.018f, 0.088f, 0.20f}},
                                                    {"Cream", {7.38f, 5.47f, 3.15f}, {0.0002f, 0.0028f, 0.0163f}},
                                                    {"Ketchup", {0.18f, 0.07f, 0.03f}, {0.061f, 0.97f, 1.45f}},
                                                    {"Marble", {2.19f, 2.62f, 3.00f}, {0.0021f, 0.0041f, 0.0071f}},
                                                    {"Potato", {0.68f, 0.70f, 0.55f}, {0.0024f, 0.0090f, 0.12f}},
                                                    {"Skimmilk", {0.70f, 1.22f, 1.90f}, {0.0014f, 0.0025f, 0.0142f}},
                                                    {"Skin1", {0.74f, 0.88f, 1.01f}, {0.032f, 0.17f, 0.48f}},
                                                    {"Skin2", {1.09f, 1.59f, 1.79f}, {0.013f, 0.070f, 0.145f}},
                                                    {"Spectralon", {11.6f, 20.4f, 14.9f}, {0, 0, 0}},
                                                    {"Wholemilk", {2.55f, 3.21f, 3.77f}, {0.0011f, 0.0024f, 0.014f}}}};

using MediumNumber = std::optional<uint32_t>;

/// A shape that light enters, and the media on its sides; none is a vacuum.
struct Body {
    MediumNumber inside, outside;
    bool is_clear;
    const FileLocation* location;
};

/// Returns the medium outside of all bodies of the camera's medium, in which the camera then is. It is the camera's if
/// there are none, if their outsides differ, or if they lie in each other without an end.
MediumNumber medium_around(MediumNumber at_camera, const std::vector<Body>& bodies, Sink& sink) {
    if (!at_camera) return {};
    std::set<MediumNumber> passed;
    MediumNumber medium = at_camera;
    while (passed.insert(medium).second) {
        std::optional<MediumNumber> outside;
        for (const Body& body : bodies) {
            // Glass without a medium is no space that could hold the camera's body.
            if (body.inside != medium || body.outside == medium || (!medium && !body.is_clear)) continue;
            if (outside && *outside != body.outside) {
                sink.leave_out({*body.location, "the media outside of shapes that the camera's medium fills differ; it "
                                                "is taken to be around everything"});
                return at_camera;
            }
            outside = body.outside;
        }
        if (!outside) return medium;
        medium = *outside;
    }
    return at_camera;
}

} // namespace

MediumParameters usable_medium(MediumParameters medium, const FileLocation& location, Sink& sink) {
    constexpr float kMost = 0x1p40f;
    bool is_changed = false;
    for (Rgb* const color : {&medium.sigma_a, &medium.sigma_s}) {
        for (float* const x : {&color->r, &color->g, &color->b}) {
            if (*x >= 0 && *x <= kMost) continue;
            *x = *x > kMost ? kMost : 0.0f;
            is_changed = true;
        }
    }
    if (!(abs(medium.g) <= kMaxScatterAnisotropy)) {
        medium.g = pertev::is_finite(medium.g) ? copysign(kMaxScatterAnisotropy, medium.g) : 0.0f;
        is_changed = true;
    }
    if (is_changed) {
        sink.leave_out(
            {location, "numbers of a medium outside of their range are left out; the nearest ones are used"});
    }
    return medium;
}

std::optional<MediumParameters> find_substance(std::string_view name) {
    const auto* const found = std::ranges::find(kSubstances, name, &Substance::name);
    if (found == kSubstances.end()) return std::nullopt;
    return MediumParameters{.sigma_a = found->sigma_a, .sigma_s = found->sigma_s};
}

std::vector<std::string_view> names_of_substances() {
    std::vector<std::string_view> names;
    for (const Substance& substance : kSubstances) names.push_back(substance.name);
    return names;
}

bool is_entered(const Surface& surface) {
    const auto is_body = [](const Surface& part) {
        return part.is_nothing || part.material.encloses() || part.material.has_diffuse_transmission();
    };
    return is_body(surface) || std::ranges::any_of(surface.beneath, is_body);
}

void finish_media(std::optional<uint32_t> at_camera, Sink& sink, Parts& parts) {
    const auto usable = [&](MediumNumber number) {
        return number && parts.media[*number].is_there() ? number : std::nullopt;
    };
    std::vector<Body> bodies;
    std::set<MediumNumber> inside;
    std::erase_if(parts.placed, [&](const Placed& shape) {
        const Surface& surface = parts.surfaces[shape.surface];
        const bool is_clear = surface.is_nothing && !shape.area_light;
        const Body body = {usable(shape.medium), usable(shape.outside), is_clear, &parts.meshes[shape.mesh].location};
        if (is_clear && !body.inside && !body.outside) return true;
        if (is_clear || (!surface.is_nothing && is_entered(surface))) {
            bodies.push_back(body);
            inside.insert(body.inside);
        }
        return false;
    });
    at_camera = usable(at_camera);
    parts.around = medium_around(at_camera, bodies, sink);
    std::set<MediumNumber> named = {parts.around, at_camera, std::nullopt};
    for (const Placed& shape : parts.placed) {
        const MediumNumber outside = usable(shape.outside);
        if (inside.contains(outside) || !named.insert(outside).second) continue;
        sink.leave_out({parts.meshes[shape.mesh].location,
                        "the medium outside of a shape is left out, because it neither fills another shape nor is "
                        "that of the camera"});
    }
}

void fill_surface(const MediumParameters& medium, const FileLocation& location, Sink& sink, Surface& surface) {
    Material& material = surface.material;
    material.medium = medium;
    if (surface.is_nothing && max_component(material.emission) > 0) { // a clear boundary cannot emit
        material.medium = {};
        if (medium.is_there())
            sink.leave_out({location, "the medium inside of a shape is left out, because an invisible surface emits "
                                      "light there"});
    } else if (surface.is_nothing) {
        material.make_clear_boundary();
    } else if (medium.is_there() && !material.encloses()) {
        material.medium = {};
        sink.leave_out(
            {location, fmt::format("the medium inside of {} is left out, because its surface lets no light in",
                                   material.name.empty() ? "a shape" : material.name)});
    }
}

} // namespace pertev::described
