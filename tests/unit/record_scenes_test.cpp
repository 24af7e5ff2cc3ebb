// The scenes of the ray record, in files of the folder PERTEV_SCENES, have the stated number of triangles.

#include "lab/record_scenes.h"

#include <doctest/doctest.h>

#include "scene/validate/validate.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"

using namespace pertev;
using namespace pertev::test;

TEST_CASE("Sponza of the record has the stated number of triangles") { // record_scenes_test.py tests the others
    const RecordScene& record = *find_named(the_record().scenes, "sponza");
    const auto file = test_scene(record.file);
    if (!file) return;
    Messages messages;
    Scene scene = make_record_scene(record, file->parent_path().parent_path(), messages);
    CHECK(scene.meshes[0].triangle_count() == record.triangles);
    validate(scene, record.name, messages);
    CHECK(scene.meshes[0].triangle_count() == record.triangles);
}

TEST_CASE("a scene whose file is missing is refused with the file's name") {
    Messages messages;
    for (const char* name : {"sponza", "bunny", "forest"}) {
        const RecordScene& record = *find_named(the_record().scenes, name);
        for (const std::filesystem::path& folder : {std::filesystem::path(), scratch_folder()}) {
            CHECK(bad_input_message([&] { make_record_scene(record, folder, messages); }).find(record.file) !=
                  std::string::npos);
        }
    }
    CHECK(find_named(the_record().scenes, "sponz") == nullptr);
}
