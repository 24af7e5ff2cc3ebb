// Receivers that pixels store scatter exactly what the surfaces scatter of which they are made (restir/receiver.h).

#include <doctest/doctest.h>

#include "restir/receiver.h"
#include "tests/support/random.h"

using namespace pertev;

TEST_CASE("a stored receiver scatters what its surface does, from both sides and at a bent normal") {
    test::Random random(7);
    int lit = 0, bent = 0;
    for (int i = 0; i < 20000; ++i) {
        Surface surface = {};
        surface.position = random.point(-9, 9);
        surface.geometric_normal = random.direction();
        surface.frame = make_frame(normalize(surface.geometric_normal + 0.6f * random.direction()));
        surface.tilt = i % 2 == 0 ? 0.0f : random.within(0.01f, 0.4f);
        surface.bsdf = make_diffuse({random.within(0, 1), random.within(0, 1), random.within(0, 1)});
        const Vec3 wo = random.direction(), wi = random.direction();
        const DiffuseReceiver receiver = diffuse_receiver(surface, wo);
        const BsdfValue expected = surface.evaluate(wo, wi), found = receiver.evaluate(wi);
        REQUIRE(found.f == expected.f);
        REQUIRE(found.pdf == expected.pdf);
        REQUIRE(receiver.position() == surface.position);
        lit += is_black(expected.f) ? 0 : 1;
        bent += surface.tilt > 0 && !is_black(expected.f) && dot(wo, surface.geometric_normal) < 0 ? 1 : 0;
    }
    CHECK(lit > 5000);
    CHECK(bent > 1000);
}
