#include <doctest/doctest.h>

#include "formats/obj/parse_mtl_texture.h"

using namespace pertev;

TEST_CASE("mtl: options of a map stand before or after its name, or on both sides") {
    for (const char* text :
         {"-o 0.25 0.5 -s 2 3 -clamp on my map.png", "my map.png -o 0.25 0.5 0 -s 2 3 1 -clamp on",
          "-s 2 3 my map.png -clamp on -o 0.25 0.5", "  my map.png\t-clamp on -s 2 3 -o 0.25 0.5 # x"}) {
        CAPTURE(text);
        const MtlTexture texture = parse_mtl_texture(text);
        CHECK(texture.name == "my map.png");
        CHECK(texture.offset == Vec2{0.25f, 0.5f});
        CHECK(texture.scale == Vec2{2, 3});
        CHECK(texture.clamp);
    }
    CHECK(parse_mtl_texture("a.png -bm 0.2").bump_multiplier == 0.2f);
    CHECK(parse_mtl_texture("a.png -bm 0.2").name == "a.png");
    CHECK(parse_mtl_texture("\"a b.png\" -bm 0.2").name == "a b.png");
    CHECK(parse_mtl_texture("a.png -imfchan g").channel == 'g');
    CHECK(parse_mtl_texture("a.png -blendu off -mm 0 1 -texres 256 -type sphere").name == "a.png");
}

TEST_CASE("mtl: words that only look like options belong to the name") {
    for (const char* name : {"wall -bm x.png", "a-s.png", "-x.png", "wood -clamp maybe.png", "a - b.png", "x -bm",
                             "photo -o 2.png", "night -s 1 2 3 4.png"}) {
        CAPTURE(name);
        CHECK(parse_mtl_texture(name).name == name);
        CHECK(parse_mtl_texture(name).scale == Vec2{1, 1});
        CHECK(parse_mtl_texture(name).bump_multiplier == 1);
    }
    CHECK(parse_mtl_texture("-s 1 2 3").name == "3"); // before the name a number that ends the line is the name
    CHECK(parse_mtl_texture("").name.empty());
    CHECK(parse_mtl_texture("-bm 1").name.empty());
    CHECK_THROWS_AS(parse_mtl_texture("-bm x.png"), MtlFault);
}
