// Vectors in JSON: texts of flags and of an EXR's metadata become arrays, and no others.

#include <doctest/doctest.h>

#include "base/json_text.h"
#include "session/writing/metadata_json.h"

using namespace pertev;

TEST_CASE("numbers between commas are a JSON array, to all their digits") {
    CHECK(json_vector("0.3,2.1,-4.7") == "[0.3,2.1,-4.7]");
    CHECK(json_vector("448262.257,5411933.125,1e-07") == "[448262.257,5411933.125,1e-07]");
    CHECK(json_vector("0,-0") == "[0,-0.0]"); // JSON readers keep the sign
    CHECK(json_vector("0,1e-400,0.5") == "[0,0,0.5]");
    CHECK(!json_vector("0,1e400"));
    CHECK(json_vector("1,0,0 0,1,0 0,0,1 4,5,6") == "[[1,0,0],[0,1,0],[0,0,1],[4,5,6]]");
    for (const char* other :
         {"", "1", "a", "1,", ",1", "1,,2", "1,2 3", "1,2 ", "nan,1", "1,inf", "1;2", "made up", "1, 2"}) {
        CHECK(!json_vector(other));
    }
}

TEST_CASE("vectors in an EXR's metadata become arrays, and all other texts stay texts") {
    CHECK(metadata_json({"pertev.eye", "0,0.5,4"}) == "[0,0.5,4]");
    CHECK(metadata_json({"pertev.ambient", "0.1,0.2,0.3"}) == "[0.1,0.2,0.3]");
    CHECK(metadata_json({"pertev.position_origin", "4000000.5,5,0"}) == "[4000000.5,5,0]");
    CHECK(metadata_json({"pertev.shutter", "-0.25,0.1"}) == "[-0.25,0.1]");
    CHECK(metadata_json({"pertev.environment", "1,2,0.5"}) == "[1,2,0.5]");
    CHECK(metadata_json({"pertev.environment", "sky.hdr"}) == "\"sky.hdr\"");
    CHECK(metadata_json({"pertev.camera", "1,2"}) == "\"1,2\""); // a name
    CHECK(metadata_json({"pertev.eye", "nowhere"}) == "\"nowhere\"");
    CHECK(metadata_json({"pertev.fov", 33.0f}) == "33");
    CHECK(metadata_json({"pertev.spp", 4}) == "4");
}
