// Extensions of file names in upper and lower case.

#include <doctest/doctest.h>

#include "base/file_extension.h"
#include "formats/read_scene.h"
#include "image/image_format.h"
#include "image/write_image.h"
#include "session/photometry.h"

using namespace pertev;

TEST_CASE("extensions are compared without case everywhere") {
    CHECK(lower_case_extension("folder.X/Leaf.PnG") == ".png");
    CHECK(lower_case_extension("a.b.GLB") == ".glb");
    CHECK(lower_case_extension("folder.X/leaf").empty());
    CHECK(lower_case_extension("leaf.\xc3\x84") == ".\xc3\x84"); // letters of other alphabets are unchanged
    CHECK(is_picture_name("A.EXR"));
    CHECK(image_format_for("A.JPEG") == ImageFormat::Jpeg);
    CHECK(is_scene_name("A.GLTF"));
    CHECK_FALSE(defines_emitter_sides("A.OBJ"));
    CHECK(lumens_per_watt("A.GlB") == 1);
    CHECK(lumens_per_watt("A.OBJ") == kLumensPerWatt);
}

TEST_CASE("values that are defined for a file of another format are reported") {
    ReadOptions options;
    options.defines = {"a=1"};
    Messages messages;
    (void)read_scene("cornell-box", options, messages);
    REQUIRE(messages.all().size() == 1);
    CHECK(messages.all()[0].remark.setting == "define");
}
