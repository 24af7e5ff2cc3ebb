#include <set>

#include <doctest/doctest.h>

#include "image/tone_map_image.h"
#include "session/settings_text.h"

using namespace pertev;

TEST_CASE("each name of a setting's value leads to the value and back, and no other name does") {
    for (const std::string& name : sampler_names()) CHECK(name_of(*sampler_named(name)) == name);
    for (const std::string& name : filter_names()) CHECK(name_of(*filter_named(name)) == name);
    for (const std::string& name : tone_map_names()) CHECK(name_of(*tone_map_named(name)) == name);
    RenderSettings settings;
    for (const std::string& name : integrator_names()) {
        CHECK(set_integrator(settings, name));
        CHECK(integrator_name(settings) == name);
    }
    for (const char* name : {"", "Box", "box ", "pat", "halton"}) {
        CHECK(!sampler_named(name));
        CHECK(!filter_named(name));
        CHECK(!aov_named(name));
        const RenderSettings before = settings;
        CHECK(!set_integrator(settings, name));
        CHECK(same_picture(before, settings));
    }
}

TEST_CASE("every value has a name") {
    CHECK(sampler_names() == std::vector<std::string>{"sobol", "independent"});
    CHECK(filter_names() == std::vector<std::string>{"box", "tent", "gaussian", "blackman-harris"});
    CHECK(tone_map_names() == std::vector<std::string>{"srgb", "agx", "aces", "neutral"});
    CHECK(integrator_names() == std::vector<std::string>{"path", "direct", "indirect", "hybrid", "cast", "whitted",
                                                         "distributed", "raster", "reyes", "light", "bidirectional",
                                                         "photon_map", "irradiance_cache", "radiosity"});
    CHECK(aov_names() == std::vector<std::string>{"albedo", "normal", "depth", "position", "ids", "motion"});
}

TEST_CASE("names of layers are bits of their own, in their order") {
    uint32_t before = 0;
    for (const std::string& name : aov_names()) {
        const uint32_t bit = *aov_named(name);
        CHECK(bit > before);
        CHECK((bit & (bit - 1)) == 0);
        before = bit;
    }
}
