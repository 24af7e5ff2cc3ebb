// EXT_lights_image_based: the cubemap's faces look where the extension says, at the file's intensity and rotation.

#include <array>

#include <doctest/doctest.h>

#include "image/srgb.h"
#include "image/write_png.h"
#include "math/portable_math.h"
#include "tests/support/gltf_builder.h"

using namespace pertev;

namespace image_based_light_test { // test files are compiled together

/// Pictures of 2x2 pixels for +x, -x, +y, -y, +z, -z: face i has red 40 i + 20; its right half has green 200, its upper
/// half blue 100.
std::string faces() {
    std::string images;
    for (int i = 0; i < 6; ++i) {
        Rgba8Image face{2, 2, {}};
        for (int pixel = 0; pixel < 4; ++pixel) {
            for (const int value : {40 * i + 20, pixel % 2 == 1 ? 200 : 0, pixel < 2 ? 100 : 0, 255}) {
                face.pixels.push_back(static_cast<uint8_t>(value));
            }
        }
        images += (i > 0 ? "," : "") + std::string(R"({"uri":"data:image/png;base64,)") +
                  test::base64(encode_png(face)) + R"("})";
    }
    return images;
}

Scene read(const std::string& light, Messages& messages, const std::string& use = R"("light":0)") {
    test::GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    return test::read_gltf_text(
        builder.json(R"("images":[)" + faces() + R"(],"extensionsUsed":["EXT_lights_image_based"],"extensions":)" +
                     R"({"EXT_lights_image_based":{"lights":[{)" + light +
                     R"(}]}},"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],)" +
                     R"("scene":0,"scenes":[{"nodes":[0],"extensions":{"EXT_lights_image_based":{)" + use + "}}}]"),
        messages);
}

/// Returns the radiance that the panorama has from a direction: its nearest pixel.
Rgb radiance(const Environment& environment, double x, double y, double z) {
    const Image& image = environment.image;
    const double length = std::sqrt(x * x + y * y + z * z), pi = 3.141592653589793;
    const double column = (std::atan2(x, -z) / (2 * pi) + 0.5) * image.width,
                 row = std::acos(y / length) / pi * image.height;
    const float* p = image.at(std::min(static_cast<uint32_t>(column), image.width - 1),
                              std::min(static_cast<uint32_t>(row), image.height - 1));
    return {p[0], p[1], p[2]};
}

const std::string kFaces = R"("specularImages":[[0,1,2,3,4,5]],"specularImageSize":2,"irradianceCoefficients":[])";

TEST_CASE("an image-based light shows its faces from inside, with the viewer's right and up") {
    Messages messages;
    const Scene scene = read(kFaces + R"(,"intensity":3)", messages);
    CHECK(messages.left_out().empty());
    REQUIRE(scene.environment);
    CHECK(scene.environment->scale == grey(3));
    struct Look {
        double x, y, z;
        int face;
        bool is_right, is_up;
    };
    for (const Look& look : {Look{1, 0.6, 0.6, 0, true, true},
                             {1, -0.6, -0.6, 0, false, false},
                             {-1, 0.6, -0.6, 1, true, true},
                             {-1, 0.6, 0.6, 1, false, true},
                             {-0.6, 0.6, 1, 4, true, true},
                             {0.6, -0.6, 1, 4, false, false},
                             {0.6, 0.6, -1, 5, true, true},
                             {-0.6, -0.6, -1, 5, false, false},
                             {0.5, 1, 0.5, 2, false, false},
                             {-0.5, 1, -0.5, 2, true, true},
                             {0.5, -1, 0.5, 3, false, true},
                             {-0.5, -1, -0.5, 3, true, false}}) {
        CAPTURE(look.x);
        CAPTURE(look.y);
        CAPTURE(look.z);
        const Rgb seen = radiance(*scene.environment, look.x, look.y, look.z);
        CHECK(seen.r == doctest::Approx(srgb_decode(static_cast<float>(40 * look.face + 20) / 255)));
        CHECK((seen.g > 0.5f * srgb_decode(200.0f / 255)) == look.is_right);
        CHECK((seen.b > 0.5f * srgb_decode(100.0f / 255)) == look.is_up);
    }
}

TEST_CASE("an image-based light is turned by its quaternion, and one that cannot be read is left out") {
    Messages messages;
    const Scene turned = read(kFaces + R"(,"rotation":[0,0.70710678,0,0.70710678])", messages); // +z becomes +x
    REQUIRE(turned.environment);
    CHECK(radiance(*turned.environment, 1, 0.1, 0.1).r == doctest::Approx(srgb_decode(180.0f / 255)));
    CHECK(messages.left_out().empty());
    CHECK_FALSE(read(kFaces, messages, "").environment.has_value());
    for (const std::string& bad :
         {std::string(R"("specularImages":[[0,1,2]])"), std::string(R"("specularImages":[])"),
          std::string(R"("specularImages":[[0,1,2,3,4,9]])"), kFaces + R"(,"rotation":[0,0,0,0])"}) {
        Messages left;
        CHECK_FALSE(read(bad, left).environment.has_value());
        CHECK(left.left_out().size() == 1);
    }
}

} // namespace image_based_light_test
