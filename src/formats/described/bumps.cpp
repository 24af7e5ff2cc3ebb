#include "formats/described/bumps.h"

#include <cmath>

#include "formats/described/make_texture.h"
#include "formats/obj/bump_normals.h"
#include "formats/obj/texel_values.h"
#include "math/portable_math.h"

namespace pertev::described {
namespace {

/// Returns the picture with linear values.
TextureImage linear_image(const TextureImage& from, ImageChange change, bool is_srgb) {
    const bool is_bytes = !from.rgba8.pixels.empty();
    if (!has_colors(from)) change.grey_of = GreyOf::Channels;
    if (!is_bytes) {
        if (change.grey_of == GreyOf::Channels) return from;
        change.exponent = 1;
    }
    TextureImage to;
    to.name = from.name;
    to.rgba_float = {.width = max(from.rgba8.width, from.rgba_float.width),
                     .height = max(from.rgba8.height, from.rgba_float.height),
                     .channels = 4,
                     .pixels = {}};
    to.rgba_float.pixels.reserve(4 * pixel_count(from));
    for (std::size_t i = 0; i < pixel_count(from); ++i) {
        for (const float value : linear_texel(from, i, change, is_bytes && is_srgb))
            to.rgba_float.pixels.push_back(value);
        to.rgba_float.pixels.push_back(texel_value(from, i, 3));
    }
    return to;
}

/// Returns an image of which each pixel is a square of many, if it is as small as checks are.
TextureImage enlarged(const TextureImage& from) {
    const Image& image = from.rgba_float;
    const uint32_t times = image.width <= 2 && image.height <= 2 ? 32 : 1;
    TextureImage to;
    to.name = from.name;
    to.rgba_float = {.width = times * image.width, .height = times * image.height, .channels = 4, .pixels = {}};
    for (uint32_t y = 0; y < to.rgba_float.height; ++y) {
        for (uint32_t x = 0; x < to.rgba_float.width; ++x) {
            const float* const pixel = image.pixels.data() + 4 * (std::size_t(y / times) * image.width + x / times);
            to.rgba_float.pixels.insert(to.rgba_float.pixels.end(), pixel, pixel + 4);
        }
    }
    return to;
}

/// Returns the area that the triangles cover in texture coordinates.
double texture_area(const Mesh& mesh) {
    double sum = 0;
    for (std::size_t i = 0; i + 2 < mesh.indices.size() && !mesh.uv[0].empty(); i += 3) {
        const Vec2 a = mesh.uv[0][mesh.indices[i]], b = mesh.uv[0][mesh.indices[i + 1]] - a,
                   c = mesh.uv[0][mesh.indices[i + 2]] - a;
        sum += 0.5 * std::abs(static_cast<double>(b.x * c.y - b.y * c.x));
    }
    return sum;
}

} // namespace

double world_area(const Mesh& mesh, const DoubleTransform& world_from_mesh) {
    double sum = 0;
    const auto corner = [&](std::size_t i) {
        return transform_point(world_from_mesh, to_double(mesh.positions[mesh.indices[i]]));
    };
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const DoubleVec3 a = corner(i), across = cross(corner(i + 1) - a, corner(i + 2) - a);
        sum += 0.5 * std::sqrt(dot(across, across));
    }
    return sum;
}

int32_t Bumps::normals_of(const TextureRef& ref, const TextureValue& heights) {
    ImageChange change;
    change.exponent = heights.exponent;
    // The normals are those of the luminance anyway.
    change.grey_of = heights.grey_of == GreyOf::Luminance ? GreyOf::Channels : heights.grey_of;
    const auto [number, is_new] =
        numbers_.try_emplace({ref.image, heights.made, ref.is_srgb, change, ref.wrap_s}, kNoImage);
    if (!is_new) return number->second;
    const TextureImage from = heights.made >= 0 ? enlarged(made_[static_cast<std::size_t>(heights.made)])
                                                : scene_.images[static_cast<std::size_t>(ref.image)];
    budget_.charge(from);
    TextureImage normals = normals_of_heights(linear_image(from, change, ref.is_srgb), 'm', ref.wrap_s);
    number->second = static_cast<int32_t>(scene_.images.size());
    scene_.images.push_back(std::move(normals));
    return number->second;
}

void Bumps::set(const TextureValue& heights, const Mesh& mesh, const DoubleTransform& world_from_mesh,
                Material& material) {
    TextureRef& ref = material.normal_texture;
    if (!ref.has_image() && heights.made < 0) return;
    if (heights.made >= 0) ref.filter = TextureFilter::Linear;
    const double repeats = static_cast<double>(abs(ref.m00 * ref.m11));
    const double covered = texture_area(mesh) * repeats, area = world_area(mesh, world_from_mesh);
    if (!(covered > 0 && area > 0)) {
        ref = {};
        return;
    }
    ref.image = normals_of(ref, heights);
    ref.is_srgb = false;
    const Image& normals = scene_.images[static_cast<std::size_t>(ref.image)].rgba_float;
    const double width = normals.width, height = normals.height;
    // Metres of the whole picture; normals_of_heights() takes white as kBumpHeight of its longer side.
    const double side = std::sqrt(area / covered);
    const double slope = static_cast<double>(heights.factor.r) * std::sqrt(width * height) / side;
    const double usual = static_cast<double>(kBumpHeight) * std::max(width, height);
    material.normal_scale = clamp(static_cast<float>(slope / usual), -0x1p10f, 0x1p10f);
}

} // namespace pertev::described
