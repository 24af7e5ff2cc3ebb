#include <algorithm>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/make_surface.h"
#include "formats/mitsuba/bsdfs.h"
#include "formats/spectra/named_spectra.h"
#include "math/portable_math.h"

namespace pertev::mitsuba {
namespace {

using M = MaterialParameters;

Rgb usable_index(Rgb index, float least) {
    const auto usable = [&](float x) { return clamp(x, least, 0x1p10f); };
    return {usable(index.r), usable(index.g), usable(index.b)};
}

} // namespace

Surface Bsdfs::conductor(Object& bsdf) {
    Sink& sink = reading_.sink();
    Parameters& parameters = bsdf.parameters;
    Surface surface = make_surface(MaterialKind::Conductor);
    if (bsdf.type == "roughconductor") read_roughness(bsdf, surface);
    const TextureValue tint = color(bsdf, "specular_reflectance", 1);
    const bool has_index = parameters.contains("eta") || parameters.contains("k");
    std::string name = parameters.text("material", has_index ? "" : reading_.context.is_old ? "Cu" : "none", sink);
    if (name == "none") { // a mirror, which has the tint alone
        set_mirror(surface, tint);
        return surface;
    }
    ComplexIndex index = find_metal_index("Cu").value_or(ComplexIndex{});
    if (!name.empty()) {
        if (const std::size_t palik = name.find('_'); palik != std::string::npos) name.resize(palik);
        const auto found = find_metal_index(name);
        if (found) index = *found;
        if (!found)
            sink.leave_out(
                {bsdf.location(), fmt::format("there are no data of the metal {}; copper is used", shortened(name))});
    }
    const float outside = parameters.contains("ext_eta") ? ior_of(bsdf, "ext_eta", 1) : 1.0f;
    const float scale = outside > 0 ? 1 / outside : 1.0f;
    surface.material.eta =
        usable_index(scale * read_color(bsdf, "eta", ColorUse::Index, index.eta, reading_), 0x1p-10f);
    surface.material.k = usable_index(scale * read_color(bsdf, "k", ColorUse::Index, index.k, reading_), 0);
    if (tint.has_image() || !(tint.factor == grey(1)))
        set_color(surface, &M::specular_color, &M::specular_color_texture, tint);
    return surface;
}

} // namespace pertev::mitsuba
