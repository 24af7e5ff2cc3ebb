#include "formats/described/combine_textures.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel_for.h"
#include "formats/described/surface.h"
#include "formats/obj/texel_values.h"

namespace pertev::described {
namespace {

constexpr uint32_t kMostSide = 4096; // pixels, unless a part is larger
constexpr uint32_t kLeastSide = 512; // pixels, where sharp checks meet smooth images
constexpr int kMostPeriods = 64;     // along one side

bool has_same_mapping(const TextureValue& a, const TextureValue& b) {
    return a.mapping == b.mapping || (a.mapping && b.mapping && *a.mapping == *b.mapping);
}

/// An axis of the coordinates of a texture, which are scale * coordinate + offset.
struct Axis {
    float scale, offset;
    Wrap wrap;
    bool operator==(const Axis&) const = default;
};
Axis axis_of(const TextureRef& ref, int axis) {
    return axis == 0 ? Axis{ref.m00, ref.m02, ref.wrap_s} : Axis{ref.m11, ref.m12, ref.wrap_t};
}

/// Returns whether `scale` is a whole number of times `of`, up to rounding, and not too large.
bool is_multiple(float scale, float of) {
    const float times = scale / of, nearest = floor(times + 0.5f);
    return nearest != 0 && abs(nearest) <= kMostPeriods && abs(times - nearest) <= 1e-4f * abs(nearest);
}

/// Returns the axis along which one image shows all of `axes`: one of all their borders, or a common period.
std::optional<Axis> common_axis(const std::vector<Axis>& axes) {
    if (std::ranges::all_of(axes, [&](const Axis& axis) { return axis == axes.front(); })) return axes.front();
    if (std::ranges::any_of(axes, [](const Axis& axis) { return axis.wrap != Wrap::Repeat || axis.scale == 0; }))
        return std::nullopt;
    for (int parts = 1; parts <= 16; ++parts) {
        const float scale = axes.front().scale / static_cast<float>(parts);
        if (std::ranges::all_of(axes, [&](const Axis& axis) { return is_multiple(axis.scale, scale); }))
            return Axis{scale, axes.front().offset, Wrap::Repeat};
    }
    return std::nullopt;
}

/// A part with its decoded image.
struct Part {
    const TextureValue& value;
    const TextureImage* image = nullptr; // null: it is a constant
    uint32_t width = 1, height = 1;
    Axis across = {1, 0, Wrap::Repeat}, down = {1, 0, Wrap::Repeat}; // from the coordinates of the combined image

    bool is_sharp() const { return image != nullptr && value.ref.filter == TextureFilter::Nearest; }
};

Part make_part(const TextureValue& value, const TextureImage* image, const TextureRef& place) {
    Part part{.value = value};
    if (image == nullptr || pixel_count(*image) == 0) return part;
    part.image = image;
    part.width = max(image->rgba8.width, image->rgba_float.width);
    part.height = max(image->rgba8.height, image->rgba_float.height);
    const auto relative = [&](int axis) {
        const Axis own = axis_of(value.ref, axis), of = axis_of(place, axis);
        const float scale = own == of ? 1.0f : floor(own.scale / of.scale + 0.5f);
        return Axis{scale, own == of ? 0.0f : own.offset - scale * of.offset, own.wrap};
    };
    part.across = relative(0), part.down = relative(1);
    return part;
}

/// Texels farther away than this are as good as any, because no coordinate says which is meant.
int64_t to_index(double texel) { return static_cast<int64_t>(std::clamp(texel, -0x1p52, 0x1p52)); }

uint32_t wrapped(int64_t i, uint32_t size, Wrap wrap) {
    const int64_t n = size;
    if (wrap == Wrap::ClampToEdge) return static_cast<uint32_t>(std::clamp<int64_t>(i, 0, n - 1));
    const int64_t period = wrap == Wrap::Repeat ? n : 2 * n, k = ((i % period) + period) % period;
    return static_cast<uint32_t>(k < n ? k : 2 * n - 1 - k);
}

/// The value of a part at coordinates of the combined image.
Rgb value_at(const Part& part, double s, double t) {
    const TextureValue& value = part.value;
    if (part.image == nullptr) return value.has_image() ? value.offset + value.factor : value.factor;
    const ImageChange change{.exponent = value.exponent, .grey_of = value.grey_of};
    const bool decodes = value.ref.is_srgb && !part.image->rgba8.pixels.empty();
    const double x = (static_cast<double>(part.across.scale) * s + static_cast<double>(part.across.offset)) *
                     part.width,
                 y = (static_cast<double>(part.down.scale) * t + static_cast<double>(part.down.offset)) * part.height;
    const auto texel = [&](double column, double row) {
        const uint32_t i = wrapped(to_index(column), part.width, part.across.wrap),
                       k = wrapped(to_index(row), part.height, part.down.wrap);
        const auto c = linear_texel(*part.image, std::size_t{k} * part.width + i, change, decodes);
        return Rgb{c[0], c[1], c[2]};
    };
    if (part.is_sharp()) return value.offset + value.factor * texel(std::floor(x), std::floor(y));
    const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
    const auto u = static_cast<float>(x - 0.5 - left), v = static_cast<float>(y - 0.5 - top);
    Rgb sum = {};
    for (int row = 0; row < 2; ++row) {
        for (int column = 0; column < 2; ++column) {
            const float weight = (column == 0 ? 1 - u : u) * (row == 0 ? 1 - v : v);
            if (weight > 1e-5f) sum += weight * texel(left + column, top + row);
        }
    }
    return value.offset + value.factor * sum;
}

/// The pixels of the combined image along one side, of which the parts have so many, repeated so often.
uint32_t side_of(const std::vector<Part>& parts, uint32_t Part::*size, Axis Part::*axis) {
    uint64_t smooth = 1, sharp = 1, most = kMostSide;
    bool has_smooth = false;
    for (const Part& part : parts) {
        if (part.image == nullptr) continue;
        most = std::max<uint64_t>(most, part.*size);
        const uint64_t pixels = static_cast<uint64_t>(abs((part.*axis).scale)) * (part.*size);
        if (part.is_sharp()) {
            sharp = std::min<uint64_t>(std::lcm(sharp, pixels), kMostSide);
        } else {
            smooth = std::max(smooth, pixels), has_smooth = true;
        }
    }
    if (sharp == 1) return static_cast<uint32_t>(std::min(smooth, most));
    const uint64_t wanted = has_smooth ? std::max<uint64_t>(smooth, kLeastSide) : sharp;
    const uint64_t times = std::max<uint64_t>(std::min((wanted + sharp - 1) / sharp, kMostSide / sharp), 1);
    return static_cast<uint32_t>(times * sharp);
}

TextureImage image_of(const CombinedTexture& of, const std::vector<Part>& parts, ImageBudget& budget) {
    TextureImage image;
    image.name = "combined";
    const uint32_t width = side_of(parts, &Part::width, &Part::across),
                   height = side_of(parts, &Part::height, &Part::down);
    image.rgba_float = {.width = width, .height = height, .channels = 4, .pixels = {}};
    image.rgba_float.pixels.resize(4 * std::size_t{width} * height);
    budget.charge(image);
    parallel_for(height, 16, [&](uint64_t row) {
        float* to = image.rgba_float.pixels.data() + 4 * row * width;
        const double t = (static_cast<double>(row) + 0.5) / height;
        for (uint32_t column = 0; column < width; ++column, to += 4) {
            const double s = (static_cast<double>(column) + 0.5) / width;
            const Rgb a = value_at(parts[0], s, t), b = value_at(parts[1], s, t);
            const Rgb c = of.is_product ? a * b : a + (b - a) * value_at(parts[2], s, t);
            to[0] = max(c.r, 0.0f), to[1] = max(c.g, 0.0f), to[2] = max(c.b, 0.0f), to[3] = 1;
        }
    });
    return image;
}

} // namespace

std::optional<TextureValue> combine_textures(const TextureValue& first, const TextureValue& second,
                                             const std::optional<TextureValue>& amount, std::vector<TextureImage>& made,
                                             std::vector<CombinedTexture>& combined) {
    CombinedTexture of{
        .is_product = !amount, .parts = {first, second, amount.value_or(constant({1, 1, 1}))}, .place = {}};
    std::vector<const TextureValue*> images;
    for (const TextureValue& part : of.parts) {
        if (part.by_normal || part.is_of_vertices || part.is_framed) return std::nullopt;
        if (part.has_image()) images.push_back(&part);
    }
    if (images.empty()) return std::nullopt;
    std::vector<Axis> across, down;
    bool is_sharp = true;
    for (const TextureValue* const part : images) {
        if (!has_same_mapping(*part, *images.front()) || part->ref.m01 != 0 || part->ref.m10 != 0) return std::nullopt;
        across.push_back(axis_of(part->ref, 0)), down.push_back(axis_of(part->ref, 1));
        is_sharp = is_sharp && part->ref.filter == TextureFilter::Nearest;
    }
    const auto s = common_axis(across), t = common_axis(down);
    if (!s || !t) return std::nullopt;
    of.place.m00 = s->scale, of.place.m02 = s->offset, of.place.wrap_s = s->wrap;
    of.place.m11 = t->scale, of.place.m12 = t->offset, of.place.wrap_t = t->wrap;
    of.place.filter = is_sharp ? TextureFilter::Nearest : TextureFilter::Linear;
    of.made = static_cast<uint32_t>(made.size());
    TextureValue value;
    value.ref = of.place;
    value.made = static_cast<int32_t>(of.made);
    value.ignores_alpha = true;
    value.mapping = images.front()->mapping;
    made.emplace_back();
    combined.push_back(std::move(of));
    return value;
}

std::size_t request_images(const std::vector<CombinedTexture>& combined, Scene& scene) {
    const std::size_t before = scene.materials.size();
    for (const CombinedTexture& of : combined) {
        for (const TextureValue& part : of.parts) {
            Material material;
            material.base_color_texture = part.ref;
            scene.materials.push_back(std::move(material));
        }
    }
    return scene.materials.size() - before;
}

void make_combined(std::vector<CombinedTexture>& combined, std::size_t count, ImageBudget& budget,
                   std::vector<TextureImage>& made, Scene& scene) {
    const std::size_t first = scene.materials.size() - count;
    for (std::size_t i = 0; i < combined.size(); ++i) {
        std::vector<Part> parts;
        for (std::size_t k = 0; k < combined[i].parts.size(); ++k) {
            const TextureValue& value = combined[i].parts[k];
            const TextureRef& loaded = scene.materials[first + combined[i].parts.size() * i + k].base_color_texture;
            const TextureImage* const image = value.made >= 0 ? &made[static_cast<std::size_t>(value.made)]
                                              : loaded.has_image()
                                                  ? &scene.images[static_cast<std::size_t>(loaded.image)]
                                                  : nullptr;
            parts.push_back(make_part(value, image, combined[i].place));
        }
        made[combined[i].made] = image_of(combined[i], parts, budget);
    }
    scene.materials.resize(first);
}

} // namespace pertev::described
