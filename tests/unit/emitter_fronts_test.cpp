// Messages about emitters of file formats that cannot state which faces emit.

#include <doctest/doctest.h>

#include "session/opening/open_scene.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace {

/// A square emitter of side 0.5 at height `y` in a box of side 2 without front and back. `face` is the order of its
/// corners 9 to 12.
std::string room(float y, const std::string& face) {
    std::string text = "mtllib a.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\n";
    for (const char* corner : {"-0.25 {} -0.25", "0.25 {} -0.25", "0.25 {} 0.25", "-0.25 {} 0.25"}) {
        const std::string pattern = corner;
        const std::size_t at = pattern.find("{}");
        text += "v " + pattern.substr(0, at) + std::to_string(y) + pattern.substr(at + 2) + "\n";
    }
    return text + "usemtl wall\nf 1 2 3 4\nf 5 6 7 8\nusemtl bulb\nf " + face + "\n";
}

const std::string kDown = "9 10 11 12", kUp = "12 11 10 9";

Messages read(const std::string& obj, bool two_sided_lights = false) {
    const std::filesystem::path folder = test::scratch_folder();
    test::write_text(folder / "a.mtl", "newmtl wall\nKd 1 1 1\nnewmtl bulb\nKe 1 1 1\nnewmtl second\nKe 1 1 1\n");
    Messages messages;
    ReadOptions options;
    options.two_sided_lights = two_sided_lights;
    const Scene scene = read_scene_and_emitters(test::write_text(folder / "a.obj", obj), options, messages);
    for (const Material& material : scene.materials) CHECK(material.two_sided_emission == two_sided_lights);
    return messages;
}

bool says(const Messages& messages, bool is_warning, const std::string& text) {
    for (const Message& message : messages.all()) {
        if (message.is_warning == is_warning && message.text.find(text) != std::string::npos) return true;
    }
    return false;
}

bool warns_of_fronts(const Messages& messages) { return says(messages, true, ""); }

} // namespace

TEST_CASE("a notice names the one-sided emitters of an OBJ file once, with the setting for both sides") {
    const Messages one = read(room(1.99f, kDown));
    REQUIRE(one.all().size() == 1);
    CHECK(says(one, false, "bulb"));
    CHECK(says(one, false, "`two_sided_lights`"));
    CHECK(says(read(room(1.99f, kDown) + "usemtl second\nf 12 11 10\n"), false, "bulb, second"));
    CHECK(read(room(1.99f, kDown), true).all().empty());
    CHECK(read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").all().empty());
}

TEST_CASE("an emitter whose front faces a wall, with space behind it, causes a warning with advice") {
    const Messages turned = read(room(1.99f, kUp));
    for (const char* part : {"bulb", "0.01 m", "1.99 m", "`two_sided_lights`"}) CHECK(says(turned, true, part));
    for (const Messages& fine : {read(room(1.99f, kDown)), read(room(1, kUp)), read(room(0.01f, kUp))}) {
        CHECK_FALSE(warns_of_fronts(fine));
    }
    CHECK(warns_of_fronts(read(room(0.01f, kDown))));
    CHECK(read(room(1.99f, kUp), true).all().empty());
}

TEST_CASE("an emitter over an open floor causes no warning") {
    const std::string floor = "mtllib a.mtl\nv -4 0 -4\nv 4 0 -4\nv 4 0 4\nv -4 0 4\nusemtl wall\nf 4 3 2 1\n";
    for (const char* height : {"2", "0.1"}) {
        const std::string y = height;
        const std::string emitter = "v -.5 " + y + " -.5\nv .5 " + y + " -.5\nv .5 " + y + " .5\nv -.5 " + y + " .5\n";
        for (const char* face : {"5 6 7 8", "8 7 6 5"}) { // faces down, then up to the sky
            CAPTURE(y);
            CHECK_FALSE(warns_of_fronts(read(floor + emitter + "usemtl bulb\nf " + face + "\n")));
        }
    }
    CHECK_FALSE(warns_of_fronts(read(room(2.01f, kDown)))); // lies on the roof, with nothing above it
}

TEST_CASE("an emitter whose front faces a wall, with most of the scene but no surface behind it, causes a warning") {
    const std::string no_floor = "mtllib a.mtl\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\nv -1 0 1\nv 1 0 1\n"
                                 "v -.2 1.99 -.2\nv .2 1.99 -.2\nv .2 1.99 .2\nv -.2 1.99 .2\n"
                                 "usemtl wall\nf 1 2 3 4\nf 4 3 6 5\nusemtl bulb\nf ";
    CHECK(says(read(no_floor + "10 9 8 7\n"), true, "0.01 m"));
    CHECK_FALSE(warns_of_fronts(read(no_floor + "7 8 9 10\n")));
}
