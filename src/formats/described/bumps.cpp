#include "formats/described/bumps.h"

#include <cmath>

#include "formats/obj/bump_normals.h"
#include "formats/obj/texel_values.h"
#include "image/srgb.h"
#include "math/portable_math.h"

namespace pertev::described {
namespace {

/// Returns the picture with linear values.
TextureImage linear_image(const TextureImage& from, bool is_srgb, float exponent) {
    if (from.rgba8.pixels.empty()) return from;
    TextureImage to;
    to.name = from.name;
    to.rgba_float = {.width = from.rgba8.width, .height = from.rgba8.height, .channels = 4, .pixels = {}};
    to.rgba_float.pixels.resize(from.rgba8.pixels.size());
    for (std::size_t i = 0; i < pixel_count(from); ++i) {
        for (std::size_t c = 0; c < 4; ++c) {
            float value = texel_value(from, i, c);
            if (c < 3 && is_srgb) value = srgb_decode(value);
            if (c < 3 && exponent != 1) value = pow(value, exponent);
            to.rgba_float.pixels[4 * i + c] = value;
        }
    }
    return to;
}

/// Returns an image of which each pixel is a square of many.
TextureImage enlarged(const TextureImage& from) {
    constexpr uint32_t kTimes = 32;
    const Image& image = from.rgba_float;
    TextureImage to;
    to.name = from.name;
    to.rgba_float = {.width = kTimes * image.width, .height = kTimes * image.height, .channels = 4, .pixels = {}};
    for (uint32_t y = 0; y < to.rgba_float.height; ++y) {
        for (uint32_t x = 0; x < to.rgba_float.width; ++x) {
            const float* const pixel = image.pixels.data() + 4 * (std::size_t(y / kTimes) * image.width + x / kTimes);
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

int32_t Bumps::normals_of(const TextureRef& heights, float exponent, int32_t made) {
    const auto [number, is_new] =
        numbers_.try_emplace({heights.image, made, heights.is_srgb, exponent, heights.wrap_s}, kNoImage);
    if (!is_new) return number->second;
    const TextureImage from = made >= 0 ? enlarged(made_[static_cast<std::size_t>(made)])
                                        : scene_.images[static_cast<std::size_t>(heights.image)];
    budget_.charge(from);
    TextureImage normals = normals_of_heights(linear_image(from, heights.is_srgb, exponent), 'm', heights.wrap_s);
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
    ref.image = normals_of(ref, heights.exponent, heights.made);
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
