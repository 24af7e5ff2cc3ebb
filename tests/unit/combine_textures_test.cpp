// Textures of pbrt that are made of several images become one image (formats/described/combine_textures.h).

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "formats/read_scene.h"
#include "image/write_image.h"
#include "math/scalar.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace {

struct CombinedScene {
    Scene scene;
    Material material;
    std::vector<std::string> left_out;

    /// The colour of the nearest pixel at texture coordinates with v upwards.
    float at(float u, float v) const {
        const TextureRef& ref = material.base_color_texture;
        const Image& image = scene.images.at(static_cast<std::size_t>(ref.image)).rgba_float;
        const float x = ref.m00 * u + ref.m02, y = ref.m11 * (1 - v) + ref.m12;
        const auto column = static_cast<uint32_t>((x - floor(x)) * float(image.width)),
                   row = static_cast<uint32_t>((y - floor(y)) * float(image.height));
        return material.base_color.r * image.pixels.at(4 * (std::size_t(row) * image.width + column));
    }
};

Image row_picture(std::vector<float> values) {
    Image image{.width = static_cast<uint32_t>(values.size()), .height = 1, .channels = 3, .pixels = {}};
    for (const float value : values) image.pixels.insert(image.pixels.end(), 3, value);
    return image;
}

std::string texture_of_image(const char* name, const std::string& more = "") {
    return fmt::format("Texture \"{0}\" \"spectrum\" \"imagemap\" \"string filename\" \"{0}.exr\" {1}\n", name, more);
}

/// Reads a square whose reflectance is the texture t, beside the pictures a.exr (0.25 and 0.5 along u), b.exr (0.2,
/// 0.4, 0.6 and 0.8) and c.exr (0 and 1).
CombinedScene read_combined(const std::string& textures) {
    const auto folder = test::scratch_folder();
    write_image(folder / "a.exr", row_picture({0.25f, 0.5f}));
    write_image(folder / "b.exr", row_picture({0.2f, 0.4f, 0.6f, 0.8f}));
    write_image(folder / "c.exr", row_picture({0, 1}));
    Messages messages;
    CombinedScene read;
    read.scene = read_scene(
        test::write_text(folder / "scene.pbrt", "WorldBegin\n" + textures +
                                                    "Material \"diffuse\" \"texture reflectance\" \"t\"\nShape "
                                                    "\"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]\n"),
        {}, messages);
    read.left_out = messages.left_out();
    read.material = read.scene.materials.at(read.scene.instances.at(0).material);
    return read;
}

} // namespace

TEST_CASE("pbrt: the product of two images is an image") {
    const CombinedScene same =
        read_combined(texture_of_image("a") + texture_of_image("c", "\"bool invert\" true") +
                      "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"a\" \"texture scale\" \"c\"\n");
    CHECK(same.left_out == std::vector<std::string>{});
    CHECK(same.at(0.2f, 0.5f) == doctest::Approx(0.25));
    CHECK(same.at(0.8f, 0.5f) == 0);
    // Twice and three times repeated images have a common period.
    const CombinedScene periods =
        read_combined(texture_of_image("a", "\"float uscale\" 2 \"string filter\" \"point\"") +
                      texture_of_image("c", "\"float uscale\" 3 \"string filter\" \"point\" \"float scale\" .5") +
                      "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"a\" \"texture scale\" \"c\"\n");
    CHECK(periods.left_out == std::vector<std::string>{});
    for (const float u : {0.03f, 0.21f, 0.36f, 0.47f, 0.58f, 0.73f, 0.9f}) {
        CAPTURE(u);
        const auto half = [u](float times) { return times * u - floor(times * u) >= 0.5f; };
        CHECK(periods.at(u, 0.5f) == doctest::Approx((half(2) ? 0.5 : 0.25) * (half(3) ? 0.5 : 0)));
    }
}

TEST_CASE("pbrt: a mixture of images by a number or an image is an image") {
    const std::string images = texture_of_image("a") + texture_of_image("b");
    const CombinedScene even =
        read_combined(images + "Texture \"t\" \"spectrum\" \"mix\" \"texture tex1\" \"a\" \"texture tex2\" "
                               "\"b\" \"float amount\" .25\n");
    CHECK(even.left_out == std::vector<std::string>{});
    CHECK(even.at(0.1f, 0.5f) == doctest::Approx(0.75 * 0.3125 + 0.25 * 0.2)); // a is halfway to its other end
    CHECK(even.at(0.4f, 0.5f) == doctest::Approx(0.75 * 0.3125 + 0.25 * 0.4));
    const CombinedScene by_image = read_combined(
        images +
        "Texture \"c\" \"float\" \"imagemap\" \"string filename\" \"c.exr\" \"string filter\" \"point\"\nTexture "
        "\"t\" \"spectrum\" \"mix\" \"texture tex1\" \"a\" \"texture tex2\" \"b\" \"texture amount\" \"c\"\n");
    CHECK(by_image.left_out == std::vector<std::string>{});
    CHECK(by_image.at(0.25f, 0.5f) == doctest::Approx(0.25).epsilon(2e-2));
    CHECK(by_image.at(0.625f, 0.5f) == doctest::Approx(0.6).epsilon(2e-2));
    // None or all of the second is one of the images as it is.
    for (const auto& [amount, width] : {std::pair("0", 2u), std::pair("1", 4u)}) {
        const CombinedScene whole = read_combined(images +
                                                  "Texture \"t\" \"spectrum\" \"mix\" \"texture tex1\" \"a\" "
                                                  "\"texture tex2\" \"b\" \"float amount\" " +
                                                  amount + "\n");
        CHECK(whole.left_out == std::vector<std::string>{});
        const auto image = static_cast<std::size_t>(whole.material.base_color_texture.image);
        CHECK(whole.scene.images.at(image).rgba_float.width == width);
    }
}

TEST_CASE("pbrt: checks of an image and a colour are an image") {
    const CombinedScene checks =
        read_combined(texture_of_image("b") +
                      "Texture \"t\" \"spectrum\" \"checkerboard\" \"texture tex1\" \"b\" \"rgb tex2\" [.9 .9 .9] "
                      "\"float uscale\" 4 \"float vscale\" 2\n");
    CHECK(checks.left_out == std::vector<std::string>{});
    // The check at the origin has the first one.
    CHECK(checks.at(0.125f, 0.25f) == doctest::Approx(0.2).epsilon(2e-2));
    CHECK(checks.at(0.375f, 0.25f) == doctest::Approx(0.9));
    CHECK(checks.at(0.625f, 0.25f) == doctest::Approx(0.6).epsilon(2e-2));
    CHECK(checks.at(0.125f, 0.75f) == doctest::Approx(0.9));
    CHECK(checks.at(0.375f, 0.75f) == doctest::Approx(0.4).epsilon(2e-2));
}

TEST_CASE("pbrt: what one image cannot combine is named") {
    const auto product = [](const char* of_c) {
        return read_combined(texture_of_image("a") + texture_of_image("c", of_c) +
                             "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"a\" \"texture scale\" \"c\"\n")
            .left_out.size();
    };
    CHECK(product("") == 0);
    CHECK(product("\"string mapping\" \"planar\"") == 1);
    CHECK(product("\"string wrap\" \"clamp\"") == 1);
    CHECK(product("\"float uscale\" 1.2345") == 1);
}

TEST_CASE("pbrt: beyond an image with the wrap black, texels are black") {
    const auto at = [](const CombinedScene& scene, float u) {
        const TextureRef& ref = scene.material.base_color_texture;
        const Image& image = scene.scene.images.at(static_cast<std::size_t>(ref.image)).rgba_float;
        CHECK(ref.wrap_s == Wrap::ClampToEdge);
        CHECK(image.pixels[3] == 1);
        const float x = (ref.m00 * u + ref.m02) * float(image.width),
                    y = (ref.m11 * 0.5f + ref.m12) * float(image.height);
        const auto column = static_cast<std::size_t>(clamp(x, 0.0f, float(image.width) - 1));
        return scene.material.base_color.r * image.pixels.at(4 * (static_cast<std::size_t>(y) * image.width + column));
    };
    // The picture is in the middle third.
    const std::string framed = texture_of_image(
        "b", "\"string wrap\" \"black\" \"float uscale\" 3 \"float udelta\" -1 \"float vscale\" 3 \"float vdelta\" -1");
    const std::string as_t = "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"b\" \"float scale\" 1\n";
    const CombinedScene plain = read_combined(framed + as_t);
    CHECK(plain.left_out == std::vector<std::string>{});
    CHECK(at(plain, 0.2f) == 0);
    CHECK(at(plain, 0.375f) == doctest::Approx(0.2));
    CHECK(at(plain, 0.625f) == doctest::Approx(0.8));
    CHECK(at(plain, 0.8f) == 0);
}
