#include <set>

#include <doctest/doctest.h>

#include "image/tone_map_image.h"
#include "settings/value_names.h"

using namespace pertev;

TEST_CASE("names of a setting's values convert to the value and back, and other names are refused") {
    for (const std::string& name : names_of<SamplerKind>()) CHECK(name_of(*value_named<SamplerKind>(name)) == name);
    for (const std::string& name : names_of<PixelFilter>()) CHECK(name_of(*value_named<PixelFilter>(name)) == name);
    for (const std::string& name : names_of<ToneMap>()) CHECK(name_of(*value_named<ToneMap>(name)) == name);
    RenderSettings settings;
    for (const std::string& name : integrator_names()) {
        CHECK(set_integrator(settings, name));
        CHECK(integrator_name(settings) == name);
    }
    for (const char* name : {"", "Box", "box ", "pat", "halton"}) {
        CHECK(!value_named<SamplerKind>(name));
        CHECK(!value_named<PixelFilter>(name));
        CHECK(!aov_named(name));
        const RenderSettings before = settings;
        CHECK(!set_integrator(settings, name));
        CHECK(same_picture(before, settings));
    }
}

TEST_CASE("every value has a name") {
    CHECK(names_of<SamplerKind>() == std::vector<std::string>{"sobol", "independent"});
    CHECK(names_of<PixelFilter>() == std::vector<std::string>{"box", "tent", "gaussian", "blackman-harris"});
    CHECK(names_of<ToneMap>() == std::vector<std::string>{"srgb", "agx", "aces", "neutral"});
    CHECK(integrator_names() == std::vector<std::string>{"path", "direct", "indirect", "hybrid", "cast", "whitted",
                                                         "distributed", "raster", "reyes", "light", "bidirectional",
                                                         "photon_map", "irradiance_cache", "radiosity"});
    CHECK(aov_names() ==
          std::vector<std::string>{"albedo", "normal", "depth", "position", "ids", "motion", "distance"});
}

TEST_CASE("names of layers have distinct bits in their order") {
    uint32_t before = 0;
    for (const std::string& name : aov_names()) {
        const uint32_t bit = *aov_named(name);
        CHECK(bit > before);
        CHECK((bit & (bit - 1)) == 0);
        before = bit;
    }
}
