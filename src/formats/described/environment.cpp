#include "formats/described/environment.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/limits.h"
#include "base/parallel_for.h"
#include "formats/described/transforms.h"
#include "formats/described/usable_values.h"
#include "image/read_image.h"
#include "math/double_pi.h"
#include "math/octahedron.h"
#include "math/portable_math.h"

namespace pertev::described {
namespace {

/// Returns where a panorama has the unit direction d.
Vec2 uv_of(PanoramaLayout layout, Vec3 d) {
    if (layout == PanoramaLayout::Octahedron) return octahedral_uv(d);
    const bool is_around_y = layout == PanoramaLayout::AroundY;
    const float turn = (is_around_y ? atan2(d.x, -d.z) : atan2(d.y, d.x)) / (2 * kPi);
    return {turn < 0 ? turn + 1 : turn, acos(clamp(is_around_y ? d.y : d.z, -1.0f, 1.0f)) / kPi};
}

Rgb pixel(const Image& image, uint32_t x, uint32_t y) {
    const float* const p = image.pixels.data() + std::size_t(image.channels) * (std::size_t(y) * image.width + x);
    return {p[0], p[1], p[2]};
}

/// Returns the picture at a point, bilinear. Columns go round a panorama; Mitsuba's first and last rows are the poles.
Rgb look_up(const Image& image, Vec2 uv, PanoramaLayout layout) {
    const bool wraps = layout != PanoramaLayout::Octahedron;
    const auto width = static_cast<float>(image.width), height = static_cast<float>(image.height);
    const float row_at = layout == PanoramaLayout::AroundY ? uv.y * (height - 1) : uv.y * height - 0.5f;
    const float x = uv.x * width - 0.5f, y = clamp(row_at, 0.0f, height - 1);
    const float left = floor(x), top = floor(y);
    const auto column = [&](float at) {
        const float turned = wraps ? (at < 0 ? at + width : (at >= width ? at - width : at)) : at;
        return static_cast<uint32_t>(clamp(turned, 0.0f, width - 1));
    };
    const auto row = [&](float at) { return static_cast<uint32_t>(min(at, height - 1)); };
    const Rgb above = lerp(pixel(image, column(left), row(top)), pixel(image, column(left + 1), row(top)), x - left);
    const Rgb below =
        lerp(pixel(image, column(left), row(top + 1)), pixel(image, column(left + 1), row(top + 1)), x - left);
    return lerp(above, below, y - top);
}

/// Returns how many rows our panorama of a picture has. Mitsuba's first and last rows lie at the poles, so as many rows
/// of ours would lie between them and blur an edge by up to 14 %. Each gets up to four, unless they take 100 MB.
uint32_t rows_for(const Image& picture, PanoramaLayout layout) {
    if (layout != PanoramaLayout::AroundY || picture.height < 2) return picture.height;
    constexpr uint64_t kMostPixels = uint64_t(1) << 23;
    const uint64_t pixels = uint64_t(picture.width) * picture.height;
    const uint32_t finer = 4 * pixels <= kMostPixels ? 4 : 2 * pixels <= kMostPixels ? 2 : 1;
    return finer > 1 ? finer * (picture.height - 1) : picture.height;
}

/// The direction of the middle of a panorama's pixel (scene/light.h).
Vec3 direction_at(uint32_t x, uint32_t y, uint32_t width, uint32_t height) {
    const float angle = 2 * kPi * ((static_cast<float>(x) + 0.5f) / static_cast<float>(width) - 0.5f);
    const float down = kPi * (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
    return {sin(down) * sin(angle), cos(down), -sin(down) * cos(angle)};
}

/// Sums luminance times the cosine to +z over the upper hemisphere of the light, by the panorama's rows.
double illuminance_of(const Image& panorama, const DoubleTransform& local_from_scene) {
    double sum = 0;
    for (uint32_t y = 0; y < panorama.height; ++y) {
        const double down = kPiDouble * (y + 0.5) / panorama.height;
        const auto height = static_cast<double>(sin(static_cast<float>(down)));
        const double area = height * (2 * kPiDouble / panorama.width) * (kPiDouble / panorama.height);
        for (uint32_t x = 0; x < panorama.width; ++x) {
            const double cosine =
                dot(local_from_scene.row2, to_double(direction_at(x, y, panorama.width, panorama.height)));
            if (cosine > 0) sum += cosine * area * static_cast<double>(luminance(pixel(panorama, x, y)));
        }
    }
    return sum;
}

} // namespace

std::optional<Environment> make_environment(const InfiniteLight& light, const DoubleTransform& local_from_scene,
                                            Sink& sink) {
    if (light.sky) {
        SunSky sky = *light.sky;
        const DoubleTransform scene_from_local = inverse(local_from_scene);
        for (Vec3* const d : {&sky.zenith, &sky.sun})
            *d = normalize_safely(to_float(transform_point(scene_from_local, to_double(*d))));
        Environment of_sky = make_sun_sky(sky, light.lumens_per_watt);
        of_sky.scale = light.scale;
        return of_sky;
    }
    Environment environment;
    environment.scale = light.scale;
    if (light.picture.empty()) {
        if (light.illuminance > 0) environment.scale = static_cast<float>(light.illuminance / kPiDouble) * light.scale;
        return environment;
    }
    const bool is_octahedron = light.layout == PanoramaLayout::Octahedron;
    Image from;
    try {
        from = read_image(light.picture, sink);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        sink.leave_out(error.remark().and_then("; the infinite light is left out"));
        return std::nullopt;
    }
    if (is_octahedron && from.width != from.height) {
        sink.leave_out(
            {light.location,
             "the picture of an infinite light is not square, as the equal-area octahedron is; the light is left out"});
        return std::nullopt;
    }
    Image& to = environment.image;
    to.height = rows_for(from, light.layout);
    to.width = std::max(is_octahedron ? 2 * from.width : from.width, 1u);
    to.channels = 3;
    to.pixels.resize(std::size_t(3) * to.width * to.height);
    parallel_for(to.height, 4, [&](uint64_t y) {
        for (uint32_t x = 0; x < to.width; ++x) {
            const DoubleVec3 d = to_double(direction_at(x, static_cast<uint32_t>(y), to.width, to.height));
            const Vec3 local = normalize(to_float(DoubleVec3{
                dot(local_from_scene.row0, d), dot(local_from_scene.row1, d), dot(local_from_scene.row2, d)}));
            const Vec2 uv = uv_of(light.layout, local);
            const Rgb color = look_up(from, uv, light.layout);
            float* const pixel = to.pixels.data() + 3 * (static_cast<std::size_t>(y) * to.width + x);
            pixel[0] = color.r, pixel[1] = color.g, pixel[2] = color.b;
        }
    });
    if (light.illuminance > 0) {
        const double own = illuminance_of(to, local_from_scene);
        if (own > 0) environment.scale = static_cast<float>(light.illuminance / own) * light.scale;
    }
    return environment;
}

} // namespace pertev::described
