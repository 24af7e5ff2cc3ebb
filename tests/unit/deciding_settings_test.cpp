// Which of several differences between two renders is named, and the names of files.

#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "session/writing/deciding_settings.h"
#include "session/writing/files_of_picture.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

std::string first_name(const DecidingSettings& before, const DecidingSettings& after) {
    const auto found = first_difference(before, after);
    return found ? found->name : "";
}

std::string text_of_first(const DecidingSettings& before, const DecidingSettings& after) {
    const auto found = first_difference(before, after);
    return found ? text_of(*found) : "";
}

std::vector<std::string> names_of_files(const std::vector<FileOfPicture>& files) {
    std::vector<std::string> names;
    for (const FileOfPicture& file : files) names.push_back(file.name);
    return names;
}

TEST_CASE("the difference that explains the others is named") {
    const DecidingSettings one = {
        {"hash of the scene's file", "a"}, {"exposure", "1.5"}, {"max_depth", "4"}, {"version", "1"}};
    CHECK(first_name(one, one) == "");
    DecidingSettings deeper = one;
    deeper[1].second = "1.7"; // metered again
    deeper[2].second = "5";
    CHECK(text_of_first(one, deeper) == "`max_depth` is \"4\" there, not \"5\"");
    DecidingSettings of_another = deeper;
    of_another[0].second = "b";
    CHECK(first_name(one, of_another) == "hash of the scene's file");
    DecidingSettings newer = of_another;
    newer.emplace(newer.begin() + 1, "max_texture_size", "8"); // a setting that the older program has not
    newer.back().second = "2";
    CHECK(first_name(one, newer) == "version");
    CHECK(first_name(newer, one) == "version");
    DecidingSettings brighter = one;
    brighter[1].second = "2";
    CHECK(first_name(one, brighter) == "exposure");
}

TEST_CASE("a file with other bytes is named, and a missing one unless only its name differs") {
    const DecidingSettings one = {
        {"max_depth", "4"}, {"exposure", "1"}, {"file a.mtl", "0a"}, {"file maps/b.png", "0b"}, {"version", "1"}};
    DecidingSettings changed = one;
    changed[0].second = "5"; // the changed file suggests it
    changed[3].second = "1b";
    CHECK(text_of_first(one, changed) == "maps/b.png is another file there");
    DecidingSettings missing = one;
    missing.erase(missing.begin() + 3);
    missing[1].second = "2";
    CHECK(text_of_first(one, missing) == "maps/b.png is read there and not here");
    CHECK(text_of_first(missing, one) == "maps/b.png is read here and not there");
    DecidingSettings renamed = one;
    renamed[3].first = "file other/b.png";
    CHECK(text_of_first(one, renamed) == "");
    renamed.emplace_back("file maps/b.png", "0b"); // another file with the same bytes
    CHECK(text_of_first(one, renamed) == "other/b.png is read here and not there");
    CHECK(text_of_first(renamed, one) == "other/b.png is read there and not here");
    renamed[3].second = "1b";
    renamed.pop_back();
    CHECK(text_of_first(one, renamed) == "other/b.png is read here and not there");
}

TEST_CASE("names of a picture's files are relative to the scene's file and say nothing of the machine") {
    const fs::path top = fs::canonical(test::scratch_folder()), scene = top / "scene";
    fs::create_directories(scene / "maps");
    fs::create_directories(top / "lib");
    std::vector<fs::path> found;
    for (const char* name : {"scene/a.mtl", "scene/maps/b.png", "lib/b.png", "lib/a.mtl"})
        found.push_back(test::write_text(top / name, name));
    found.push_back(scene / "missing.png");
    PictureOptions options;
    options.scene.scene = (scene / "maps" / ".." / "a.obj").string();
    options.scene.profiles = {"lamp=" + test::write_text(top / "x.ies", "x").string()};
    options.scene.environment = "1,1,1";
    options.lut = test::write_text(top / "x.cube", "y").string();
    std::vector<FileOfPicture> files = files_of_scene(options, found);
    CHECK(names_of_files(files) == std::vector<std::string>{"a.mtl", "maps/b.png", "b.png", "a.mtl", "x.ies"});
    give_own_names(files);
    CHECK(files[3].name == "a.mtl (2)");
    for (const FileOfPicture& file : files) CHECK(file.hash.size() == 16);
    CHECK(files[0].hash != files[3].hash);
    const std::vector<FileOfPicture> of_settings = files_of_settings(options);
    CHECK(names_of_files(of_settings) == std::vector<std::string>{"x.cube"});
    CHECK(of_settings[0].is_lut);
    // All files beyond the 1024th have one entry, which each of them changes.
    const std::vector<fs::path> many(1030, found[0]);
    options.scene.profiles.clear();
    const std::vector<FileOfPicture> united = files_of_scene(options, many);
    REQUIRE(united.size() == 1025);
    CHECK(united.back().name == "one of 6 more files");
    std::vector<fs::path> others = many;
    others.back() = found[1];
    CHECK(files_of_scene(options, others).back().hash != united.back().hash);
}

} // namespace
