#include "formats/gltf/image_based_light.h"

#include <algorithm>
#include <array>
#include <variant>

#include <fmt/format.h>

#include "base/parallel_for.h"
#include "formats/gltf/attached_bytes.h"
#include "formats/gltf/leave_out.h"
#include "image/decode_image.h"
#include "image/srgb.h"
#include "math/portable_math.h"
#include "math/vec3.h"

namespace pertev::gltf {
namespace {

constexpr const char* kName = "EXT_lights_image_based";
constexpr uint32_t kMaxFace = 2048;

/// A face of the cubemap, linear.
struct Face {
    uint32_t size = 0;
    std::vector<Rgb> pixels;

    Rgb at(int x, int y) const {
        const int last = static_cast<int>(size) - 1;
        return pixels[static_cast<std::size_t>(std::clamp(y, 0, last)) * size +
                      static_cast<std::size_t>(std::clamp(x, 0, last))];
    }
};
using Cube = std::array<Face, 6>; // +x, -x, +y, -y, +z, -z

Image decode_encoded(const Document& document, Buffers& buffers, const FileAccess& access, const JsonValue& image,
                     Sink& sink) {
    std::vector<std::byte> owned;
    const std::span<const std::byte> bytes = attached_bytes(document, buffers, access, image, owned, sink);
    std::variant<Rgba8Image, Image> decoded = decode_image(bytes, text_of(image.location()), sink);
    const Rgba8Image* rgba = std::get_if<Rgba8Image>(&decoded);
    if (rgba == nullptr) throw image.error("a face of 8 bits per channel is expected");
    Image linear{rgba->width, rgba->height, 3, std::vector<float>(rgba->pixels.size() / 4 * 3)};
    for (std::size_t i = 0; i < rgba->pixels.size() / 4; ++i) {
        const uint8_t* pixel = rgba->pixels.data() + 4 * i;
        // RGBD: alpha divides the colours. Pictures without it have 255.
        const float divisor = static_cast<float>(std::max(pixel[3], uint8_t(1))) / 255;
        for (std::size_t c = 0; c < 3; ++c) {
            linear.pixels[3 * i + c] = srgb_decode(static_cast<float>(pixel[c]) / 255) / divisor;
        }
    }
    return linear;
}

Cube read_cube(const Document& document, Buffers& buffers, const FileAccess& access, const JsonValue& light,
               Sink& sink) {
    const std::vector<JsonValue> levels = light.elements_of("specularImages");
    const std::vector<JsonValue> faces = levels.empty() ? std::vector<JsonValue>() : levels[0].elements();
    Cube cube;
    if (faces.size() != cube.size()) {
        throw light.error(fmt::format("\"specularImages\" begins with {} faces; expected 6", faces.size()));
    }
    for (std::size_t i = 0; i < cube.size(); ++i) {
        const JsonValue& image = document.table("images")[document.index_into("images", faces[i])];
        const Image picture = decode_encoded(document, buffers, access, image, sink);
        if (picture.width != picture.height || picture.width > kMaxFace) {
            throw faces[i].error(fmt::format("a face of {}x{} pixels; expected a square of at most {}", picture.width,
                                             picture.height, kMaxFace));
        }
        cube[i].size = picture.width;
        for (std::size_t p = 0; p < picture.pixels.size(); p += 3) {
            cube[i].pixels.push_back({picture.pixels[p], picture.pixels[p + 1], picture.pixels[p + 2]});
        }
    }
    return cube;
}

/// Radiance from `d`. Each face shows what a viewer inside sees, because the extension mirrors the usual ones.
Rgb radiance_from(const Cube& cube, Vec3 d) {
    const Vec3 size = abs(d);
    std::size_t face;
    float right, down, ahead;
    if (size.x >= size.y && size.x >= size.z) {
        face = d.x > 0 ? 0 : 1;
        right = d.x > 0 ? d.z : -d.z, down = -d.y, ahead = size.x;
    } else if (size.y >= size.z) {
        face = d.y > 0 ? 2 : 3;
        right = -d.x, down = d.y > 0 ? d.z : -d.z, ahead = size.y;
    } else {
        face = d.z > 0 ? 4 : 5;
        right = d.z > 0 ? -d.x : d.x, down = -d.y, ahead = size.z;
    }
    const Face& picture = cube[face];
    const auto side = static_cast<float>(picture.size);
    const float x = 0.5f * (right / ahead + 1) * side - 0.5f, y = 0.5f * (down / ahead + 1) * side - 0.5f;
    const float x0 = floor(x), y0 = floor(y);
    const int ix = static_cast<int>(x0), iy = static_cast<int>(y0);
    const Rgb above = lerp(picture.at(ix, iy), picture.at(ix + 1, iy), x - x0),
              below = lerp(picture.at(ix, iy + 1), picture.at(ix + 1, iy + 1), x - x0);
    return lerp(above, below, y - y0);
}

/// Turns `v` back by a unit quaternion.
Vec3 rotate_back(const std::array<float, 4>& q, Vec3 v) {
    const Vec3 axis = {-q[0], -q[1], -q[2]};
    return v + 2.0f * cross(axis, cross(axis, v) + q[3] * v);
}

Image panorama_of(const Cube& cube, const std::array<float, 4>& rotation) {
    uint32_t most = 1;
    for (const Face& face : cube) most = std::max(most, face.size);
    Image image{4 * most, 2 * most, 3, std::vector<float>(std::size_t(24) * most * most)};
    parallel_for(image.height, 1, [&](uint64_t row) {
        const float polar = kPi * (static_cast<float>(row) + 0.5f) / static_cast<float>(image.height);
        for (uint32_t column = 0; column < image.width; ++column) {
            const float turn = 2 * kPi * ((static_cast<float>(column) + 0.5f) / static_cast<float>(image.width) - 0.5f);
            const Vec3 d = {sin(polar) * sin(turn), cos(polar), -sin(polar) * cos(turn)};
            const Rgb radiance = radiance_from(cube, rotate_back(rotation, d));
            float* pixel = image.at(column, static_cast<uint32_t>(row));
            pixel[0] = radiance.r, pixel[1] = radiance.g, pixel[2] = radiance.b;
        }
    });
    return image;
}

} // namespace

void read_image_based_light(const Document& document, Buffers& buffers, const FileAccess& access, Scene& scene,
                            Sink& sink) {
    const std::vector<JsonValue>& scenes = document.table("scenes");
    if (scene.file_scene >= scenes.size()) return;
    read_or_leave_out(fmt::format("the environment of {}", scenes[scene.file_scene].pointer()), sink, [&] {
        const std::optional<JsonValue> use = scenes[scene.file_scene].extension(kName),
                                       all = document.root().extension(kName);
        if (!use || !all) return;
        const JsonValue reference = use->at("light");
        const std::vector<JsonValue> lights = all->elements_of("lights");
        const uint64_t index = reference.to_unsigned();
        if (index >= lights.size()) {
            throw reference.error(fmt::format("{}; there are {} lights", index, lights.size()));
        }
        const JsonValue& light = lights[index];
        std::array<float, 4> rotation = light.floats_or<4>("rotation", {0, 0, 0, 1});
        float length2 = 0;
        for (const float x : rotation) length2 += x * x;
        if (!(length2 > 0)) throw light.at("rotation").error("expected a unit quaternion");
        for (float& x : rotation) x /= sqrt(length2);
        Environment environment;
        environment.scale = grey(std::max(light.float_or("intensity", 1), 0.0f));
        environment.image = panorama_of(read_cube(document, buffers, access, light, sink), rotation);
        scene.environment = std::move(environment);
    });
}

} // namespace pertev::gltf
