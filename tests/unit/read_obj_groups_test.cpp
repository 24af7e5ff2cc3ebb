#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "formats/obj/parse_obj.h"
#include "formats/obj/read_obj.h"
#include "scene/validate/validate.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace read_obj_groups_test { // test files are compiled together

Scene load(const std::string& obj, const std::string& mtl, Messages& messages) {
    const fs::path folder = test::scratch_folder();
    test::write_text(folder / "a.mtl", mtl);
    const fs::path path = test::write_text(folder / "a.obj", obj);
    return read_obj(path, FileAccess(path, {}), {}, messages);
}

std::vector<std::string> names_of_instances(const std::string& text) {
    Messages messages;
    const Scene scene = load(text, "", messages);
    std::vector<std::string> names;
    for (const Instance& instance : scene.instances) {
        names.push_back(instance.name);
        CHECK(scene.meshes[instance.mesh].name == instance.name);
    }
    return names;
}

using Texts = std::vector<std::string>;

const std::string kThreeCorners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string kFace = "f 1 2 3\n";

TEST_CASE("obj: objects and groups are instances with their names, one per material, and share materials") {
    Messages messages;
    const Scene scene = load("mtllib a.mtl\n" + kThreeCorners + "o table\nusemtl wood\n" + kFace + "usemtl iron\n" +
                                 kFace + "o chair\n" + kFace + "usemtl wood\n" + kFace + "o table\n" + kFace,
                             "newmtl wood\nKd 1 0 0\nnewmtl iron\nKd 0 0 1\n", messages);
    REQUIRE(scene.instances.size() == 4);
    REQUIRE(scene.meshes.size() == 4);
    REQUIRE(scene.materials.size() == 2);
    const auto check = [&](std::size_t i, const char* name, const char* material, uint32_t triangles) {
        CHECK(scene.instances[i].name == name);
        CHECK(scene.materials[scene.instances[i].material].name == material);
        CHECK(scene.meshes[scene.instances[i].mesh].triangle_count() == triangles);
    };
    check(0, "table", "wood", 2); // the group is named twice
    check(1, "table", "iron", 1);
    check(2, "chair", "iron", 1);
    check(3, "chair", "wood", 1);
    CHECK(messages.all().empty());
}

TEST_CASE("obj: an instance has the name of its object and group, or else of its material") {
    CHECK(names_of_instances(kThreeCorners + kFace) == Texts{""});
    CHECK(names_of_instances(kThreeCorners + "usemtl red\n" + kFace) == Texts{"red"});
    CHECK(names_of_instances(kThreeCorners + "g left side # a note\nusemtl red\n" + kFace) == Texts{"left side"});
    CHECK(names_of_instances(kThreeCorners + "o car\ng wheel\n" + kFace + "g door\n" + kFace) ==
          Texts{"car/wheel", "car/door"});
    CHECK(names_of_instances(kThreeCorners + "g car\no car\n" + kFace) == Texts{"car"});
    CHECK(names_of_instances(kThreeCorners + "g a\n" + kFace + "g\n" + kFace + "g a\n" + kFace) == Texts{"a", ""});
    CHECK(names_of_instances(kThreeCorners + "o unused\no used\n" + kFace) == Texts{"used"});
}

TEST_CASE("obj: thousands of groups become thousands of instances, but a group per face is merged by material") {
    const auto text = [](std::size_t groups) {
        std::string lines = kThreeCorners;
        for (std::size_t i = 0; i < groups; ++i) lines += "g n" + std::to_string(i) + "\n" + kFace;
        return lines;
    };
    Messages messages;
    const Scene scene = load(text(5000), "", messages);
    CHECK(scene.instances.size() == 5000);
    CHECK(scene.materials.size() == 1);
    CHECK(scene.instances[4999].name == "n4999");
    CHECK(messages.all().empty());
    const Scene at_limit = load(text(kMaxObjGroups), "", messages);
    CHECK(at_limit.instances.size() == kMaxObjGroups);
    CHECK(messages.all().empty());
    const Scene many = load(text(kMaxObjGroups + 1), "", messages);
    REQUIRE(many.instances.size() == 1);
    CHECK(many.meshes[0].triangle_count() == kMaxObjGroups + 1);
    REQUIRE(messages.all().size() == 1);
    CHECK(messages.all()[0].text.find("65536 objects and groups") != std::string::npos);
}

} // namespace read_obj_groups_test
