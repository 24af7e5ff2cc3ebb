#include <doctest/doctest.h>

#include "formats/files/file_access.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

struct Folders {
    fs::path top = fs::canonical(test::scratch_folder());
    fs::path scene = top / "scene", other = top / "scene2";
    fs::path file = scene / "a.obj";

    Folders() {
        fs::create_directories(scene / "textures");
        fs::create_directories(other);
        test::write_text(file, "");
        test::write_text(scene / "textures" / "t.png", "");
        test::write_text(other / "t.png", "");
    }
};

FileLocation at(const fs::path& file) { return {file.string()}; }

} // namespace

TEST_CASE("files in the scene's folder and below are resolved, including names with backslashes, dots and spaces") {
    const Folders f;
    const FileAccess access(f.file, {});
    CHECK(access.resolve(at(f.file), "textures/t.png") == f.scene / "textures/t.png");
    CHECK(access.resolve(at(f.file), "textures\\t.png") == f.scene / "textures/t.png");
    CHECK(access.resolve(at(f.file), "./textures/../textures/t.png") == f.scene / "textures/t.png");
    CHECK(access.resolve(at(f.scene / "textures" / "b.mtl"), "t.png") == f.scene / "textures/t.png");
    CHECK(access.resolve(at(f.file), "no such file.png") == f.scene / "no such file.png");
    CHECK(access.resolve(at(f.file), (f.scene / "a.obj").string()) == f.file);
}

TEST_CASE("a file outside the scene's folder is refused, with a message that names the file and `allow_path`") {
    const Folders f;
    const FileAccess access(f.file, {});
    fs::create_symlink(f.other, f.scene / "link");
    fs::create_symlink(f.other / "t.png", f.scene / "link.png");
    fs::create_symlink(f.other / "not yet", f.scene / "dangling");
    for (const std::string& reference :
         {std::string("../scene2/t.png"), std::string("..\\scene2\\t.png"), std::string("/etc/passwd"),
          (f.other / "t.png").string(), std::string("link/t.png"), std::string("link.png"),
          std::string("textures/../../scene2/t.png")}) {
        CAPTURE(reference);
        const auto error = test::thrown_error([&] { (void)access.resolve(at(f.file), reference); });
        REQUIRE(error);
        CHECK(error->code() == ErrorCode::BadInput);
        CHECK(test::says(error, f.file.string()));
        CHECK(test::says(error, "`allow_path="));
    }
    CHECK_THROWS_AS((void)access.resolve(at(f.file), "dangling"), Error);
    CHECK_THROWS_AS((void)access.resolve(at(f.file), ""), Error);
    CHECK_THROWS_AS((void)access.resolve(at(f.file), std::string("textures/t.png\0.txt", 18)), Error);
    CHECK_THROWS_AS((void)access.resolve(at(f.file), std::string(10000, 'x') + "/a"), Error);
}

TEST_CASE("an allowed folder may be read, but not a sibling whose name begins alike") {
    const Folders f;
    const FileAccess access(f.file, {f.other});
    CHECK(access.resolve(at(f.file), "../scene2/t.png") == f.other / "t.png");
    fs::create_directories(f.top / "scene22");
    CHECK_THROWS_AS((void)access.resolve(at(f.file), "../scene22/t.png"), Error);
    CHECK_THROWS_AS(FileAccess(f.file, {f.top / "missing"}), Error);
}

TEST_CASE("a file named with a path of another machine is found in the folder of the file that names it or below") {
    const Folders f;
    const FileAccess access(f.file, {});
    Messages messages;
    CHECK(access.find(at(f.file), "textures/t.png", messages) == f.scene / "textures/t.png");
    CHECK(!access.find(at(f.file), "nothing.png", messages));
    CHECK(!access.find(at(f.file), std::string(5000, 'x') + ".png", messages)); // longer than a name may be
    CHECK(messages.all().empty());
    CHECK(access.find(at(f.file), "C:\\models\\a.obj", messages) == f.file);
    CHECK(access.find(at(f.file), "maps/elsewhere/a.obj", messages) == f.file);
    CHECK(access.find(at(f.file), "C:\\models\\textures\\t.png", messages) == f.scene / "textures/t.png");
    CHECK(access.find(at(f.file), "D:/t.png", messages) == f.scene / "textures/t.png");
    CHECK(access.find(at(f.file), "t.png", messages) == f.scene / "textures/t.png");
    REQUIRE(messages.all().size() == 5);
    const auto names = [&](std::size_t i, const std::string& name) {
        return messages.all()[i].text.find(name) != std::string::npos;
    };
    CHECK((names(2, "\"C:/models/textures\"") && names(2, "\"textures\"")));
    CHECK((names(4, "\"t.png\"") && names(4, (f.scene / "textures/t.png").string())));
    for (const Message& message : messages.all()) CHECK(message.is_warning);
}

TEST_CASE("the file whose path has the longest common end with a name is found, nearest to where it is named") {
    const Folders f;
    for (const char* folder : {"a/wood", "b/wood", "b/stone", "c"}) fs::create_directories(f.scene / folder);
    for (const char* file : {"a/wood/x.png", "b/wood/x.png", "b/stone/x.png", "c/y.png", "a/y.png", "y.png"}) {
        test::write_text(f.scene / file, "");
    }
    const FileAccess access(f.file, {});
    Messages messages;
    CHECK(access.find(at(f.file), "C:/p/stone/x.png", messages) == f.scene / "b/stone/x.png");
    CHECK(access.find(at(f.scene / "a" / "m.mtl"), "C:/p/wood/x.png", messages) == f.scene / "a/wood/x.png");
    CHECK(access.find(at(f.scene / "c" / "m.mtl"), "C:/p/stone/x.png", messages) == f.scene / "b/stone/x.png");
    CHECK(access.find(at(f.file), "C:/p/y.png", messages) == f.scene / "y.png"); // the others are in deeper folders
    const std::size_t before = messages.all().size();
    CHECK(!access.find(at(f.file), "C:/p/wood/x.png", messages)); // both a's and b's match
    REQUIRE(messages.all().size() == before + 1);
    for (const char* candidate : {"a/wood/x.png", "b/wood/x.png"}) {
        CHECK(messages.all().back().text.find((f.scene / candidate).string()) != std::string::npos);
    }
}

TEST_CASE("a name in another case is found if only one file matches, with a message that names it") {
    const Folders f;
    for (const char* file : {"Wood.PNG", "one.png", "ONE.png", "deep name.Png"}) test::write_text(f.scene / file, "");
    fs::create_directories(f.scene / "Maps");
    test::write_text(f.scene / "Maps" / "Leaf.png", "");
    const FileAccess access(f.file, {});
    Messages messages;
    CHECK(access.find(at(f.file), "wood.png", messages) == f.scene / "Wood.PNG");
    CHECK(messages.all().back().text.find((f.scene / "Wood.PNG").string()) != std::string::npos);
    CHECK(access.find(at(f.file), "DEEP NAME.PNG", messages) == f.scene / "deep name.Png");
    CHECK(access.find(at(f.file), "maps\\leaf.png", messages) == f.scene / "Maps/Leaf.png");
    CHECK(access.find(at(f.file), "C:\\MAPS\\LEAF.PNG", messages) == f.scene / "Maps/Leaf.png");
    CHECK(access.find(at(f.file), "maps/Leaf.png", messages) == f.scene / "Maps/Leaf.png");
    CHECK(access.find(at(f.file), "one.png", messages) == f.scene / "one.png");
    CHECK(messages.all().size() == 5); // the last is exact
    CHECK(!access.find(at(f.file), "One.png", messages));
    CHECK(!access.find(at(f.file), "W\xc3\xb6od.png", messages));
}

TEST_CASE("a search never finds files outside, through links or in hidden folders") {
    const Folders f;
    fs::create_directories(f.scene / ".hidden");
    test::write_text(f.scene / ".hidden" / "h.png", "");
    test::write_text(f.other / "outside.png", "");
    fs::create_directory_symlink(f.other, f.scene / "linked");
    fs::create_symlink(f.other / "outside.png", f.scene / "Link.png");
    Messages messages;
    const FileAccess access(f.file, {});
    CHECK(!access.find(at(f.file), "C:/h.png", messages));
    CHECK(!access.find(at(f.file), "C:/outside.png", messages));
    CHECK(!access.find(at(f.file), "link.png", messages));
    CHECK(messages.all().empty());
    const FileAccess allowed(f.file, {f.other});
    CHECK(allowed.find(at(f.file), "C:/OUTSIDE.png", messages) == f.other / "outside.png");
    CHECK(allowed.find(at(f.file), "link.png", messages) == f.other / "outside.png");
}

TEST_CASE("a file outside is replaced by one of that name below with a warning, or refused") {
    const Folders f;
    test::write_text(f.other / "u.png", "");
    const FileAccess access(f.file, {});
    Messages messages;
    CHECK(access.find(at(f.file), "/no such home/artist/a.obj", messages) == f.file);
    CHECK(!access.find(at(f.file), "/no such home/artist/u.png", messages)); // no folder could allow it
    CHECK(access.find(at(f.scene / "textures" / "b.mtl"), (f.other / "t.png").string(), messages) ==
          f.scene / "textures/t.png");
    REQUIRE(messages.all().size() == 2);
    CHECK(messages.all()[0].text.find("\"/no such home/artist\"") != std::string::npos);
    const auto error = test::thrown_error([&] {
        (void)access.find(FileLocation{f.file.string(), 7}, "../scene2/u.png", messages);
    });
    REQUIRE(error);
    CHECK(error->location() == FileLocation{f.file.string(), 7});
    CHECK(test::says(error, "`allow_path=" + f.other.string() + "`"));

    fs::create_symlink(f.other / "u.png", f.scene / "u.png"); // a sibling can lead outside, too
    CHECK_THROWS_AS((void)access.find(at(f.file), "../scene2/u.png", messages), Error);
    CHECK(!access.find(at(f.file), "/no such home/artist/u.png", messages));
}
