// The solvers of a radiosity system: all converge to the same light, each by its own method.

#include <doctest/doctest.h>

#include <cmath>

#include "radiosity/radiosity_settings.h"
#include "radiosity/radiosity_system.h"
#include "tests/support/random.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

/// Patches of different sizes in a closed room whose form factors keep F_ij A_i = F_ji A_j.
RadiositySystem room_of(std::size_t count, float reflectance, float exitance) {
    RadiositySystem system;
    double all = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const float area = 1.0f + static_cast<float>(i % 5);
        const float shade = static_cast<float>(i % 3) / 3.0f;
        system.patches.push_back(
            {area, {reflectance, reflectance * shade, 0.5f * reflectance}, i % 7 == 0 ? grey(exitance) : Rgb{}});
        system.direct.push_back(i % 4 == 1 ? Rgb{0.5f, 0.25f, 0} : Rgb{});
        all += static_cast<double>(area);
    }
    for (std::size_t i = 0; i < count; ++i) {
        std::vector<FormFactor> row; // inside a sphere the form factor is the patch's share of the area
        for (uint32_t j = 0; j < count; ++j) {
            row.push_back({j, static_cast<float>(static_cast<double>(system.patches[j].area) / all)});
        }
        system.rows.push_back(row);
    }
    return system;
}

double difference(const SolvedSystem& a, const SolvedSystem& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.irradiance.size(); ++i) {
        const Rgb d = a.irradiance[i] + a.ambient - (b.irradiance[i] + b.ambient);
        largest = std::max(
            largest, static_cast<double>(max_component(Rgb{pertev::abs(d.r), pertev::abs(d.g), pertev::abs(d.b)})));
    }
    return largest;
}

} // namespace

TEST_CASE("all solvers converge to the known light inside a sphere") {
    const RadiositySystem system = room_of(40, 0.8f, 2);
    const SolvedSystem southwell = solve_by_southwell(system, 1e-7, 0);
    const SolvedSystem gauss_seidel = solve_by_gauss_seidel(system, 1e-8);
    const SolvedSystem matrix = solve_by_matrix(system);
    CHECK(difference(southwell, matrix) < 1e-5);
    CHECK(difference(gauss_seidel, matrix) < 1e-5);
    // Every patch gathers the same light: the area-weighted mean of E + r direct, divided by 1 - mean r.
    double area = 0, sent = 0, reflected = 0;
    for (std::size_t i = 0; i < system.patches.size(); ++i) {
        const SystemPatch& patch = system.patches[i];
        const auto size = static_cast<double>(patch.area);
        area += size;
        sent += size * static_cast<double>(patch.exitance.g + patch.reflectance.g * system.direct[i].g);
        reflected += size * static_cast<double>(patch.reflectance.g);
    }
    const double known = sent / area / (1 - reflected / area);
    for (std::size_t i = 0; i < system.patches.size(); ++i) {
        CHECK(static_cast<double>(matrix.irradiance[i].g - system.direct[i].g) == doctest::Approx(known).epsilon(1e-5));
    }
}

TEST_CASE("an interrupted elimination leaves the direct light of emitters and of lights without patches") {
    const RadiositySystem system = room_of(40, 0.8f, 2);
    double sent = 0, area = 0;
    for (const SystemPatch& patch : system.patches) {
        sent += static_cast<double>(patch.area * patch.exitance.g), area += static_cast<double>(patch.area);
    }
    for (const int most : {1, 40, 100}) { // in the first channel, at its end, and in the last channel
        int requested = 0;
        const SolvedSystem ended = solve_by_matrix(system, [&](double) { return ++requested < most; });
        CHECK(requested == most);
        CHECK(ended.steps == 0);
        CHECK(ended.left == 1);
        REQUIRE(ended.irradiance.size() == 40);
        for (std::size_t i = 0; i < 40; ++i) {
            CHECK(static_cast<double>(ended.irradiance[i].g - system.direct[i].g) ==
                  doctest::Approx(sent / area).epsilon(1e-5));
        }
    }
}

TEST_CASE("Southwell shoots from the patch with the most unshot light, the first of several") {
    RadiositySystem system;
    // Each of four patches in a row sends light only to the next. Without reflection each sends its emission.
    for (const float exitance : {1.0f, 3.0f, 3.0f, 2.0f}) system.patches.push_back({1, {}, grey(exitance)});
    system.patches[2].area = 1;
    system.direct.assign(4, {});
    system.rows = {{}, {{0, 1.0f}}, {{1, 1.0f}}, {{2, 1.0f}}};
    const auto received = [&](uint64_t steps) {
        std::vector<float> light;
        for (const Rgb irradiance : solve_by_southwell(system, 0, steps).irradiance) light.push_back(irradiance.r);
        return light;
    };
    CHECK(received(1) == std::vector<float>{0, 0, 3, 0}); // patch 1 shoots first, although patch 2 has as much light
    CHECK(received(2) == std::vector<float>{0, 0, 3, 3});
    CHECK(received(3) == std::vector<float>{0, 0, 3, 3}); // patch 3, from which no patch receives light
    CHECK(received(4) == std::vector<float>{0, 1, 3, 3});
    system.patches[0].area = 4; // the sum is more than all light
    CHECK(received(1) == std::vector<float>{0, 1, 0, 0});
}

TEST_CASE("unshot light is displayed as ambient light, so the picture has all light from the start") {
    const RadiositySystem system = room_of(40, 0.8f, 2);
    const SolvedSystem whole = solve_by_matrix(system);
    double before = 1e30;
    for (const uint64_t steps : {1u, 5u, 20u, 100u, 1000u}) {
        const SolvedSystem part = solve_by_southwell(system, 0, steps);
        CHECK(part.steps == steps);
        CHECK(part.left < before);
        before = part.left;
        CHECK(part.ambient.r > 0);
        // Inside a sphere light is uniform, so that the display is correct after every step.
        CHECK(difference(part, whole) < 1e-4);
    }
    CHECK(max_component(solve_by_gauss_seidel(system, 1e-6).ambient) == 0);
}

TEST_CASE("no light is lost or added: patches absorb what is emitted") {
    const RadiositySystem system = room_of(60, 0.9f, 3);
    const SolvedSystem solved = solve_by_gauss_seidel(system, 1e-9);
    double emitted = 0, absorbed = 0;
    for (std::size_t i = 0; i < system.patches.size(); ++i) {
        const SystemPatch& patch = system.patches[i];
        const auto area = static_cast<double>(patch.area);
        emitted += area * static_cast<double>(patch.exitance.b + system.direct[i].b);
        absorbed += area * static_cast<double>((1 - patch.reflectance.b) * solved.irradiance[i].b);
    }
    CHECK(absorbed == doctest::Approx(emitted).epsilon(1e-5));
}

TEST_CASE("a solution ends on request or within its tolerance") {
    const RadiositySystem system = room_of(300, 0.95f, 1);
    int requested = 0;
    const auto end_after_three = [&](double) { return ++requested < 3; };
    CHECK(solve_by_gauss_seidel(system, 0, end_after_three).steps == 3);
    const SolvedSystem rough = solve_by_southwell(system, 0.1, 0), fine = solve_by_southwell(system, 1e-3, 0);
    CHECK(rough.left <= 0.1);
    CHECK(fine.left <= 1e-3);
    CHECK(rough.steps < fine.steps);
    RadiositySystem large;
    large.patches.resize(kMaxMatrixPatches + 1);
    const auto error = test::thrown_error([&] { solve_by_matrix(large); });
    CHECK(test::is_about(error, ErrorCode::OverLimit, "solver", "matrix"));
}

TEST_CASE("an almost lossless scene ends after a limited number of steps and reports the rest") {
    const RadiositySystem system = room_of(12, 0.999995f, 2);
    const SolvedSystem southwell = solve_by_southwell(system, 1e-6, 0), few = solve_by_southwell(system, 1e-6, 10);
    CHECK(southwell.steps == kMaxSweeps * 12);
    CHECK(southwell.reached_limit);
    CHECK(southwell.left > 1e-6);
    CHECK_FALSE(few.reached_limit); // stopped by its number of steps
    const SolvedSystem gauss_seidel = solve_by_gauss_seidel(system, 1e-6);
    CHECK(gauss_seidel.steps == kMaxSweeps);
    CHECK(gauss_seidel.reached_limit);
    CHECK_FALSE(solve_by_gauss_seidel(room_of(12, 0.9f, 2), 1e-6).reached_limit);
    CHECK_FALSE(solve_by_southwell(room_of(12, 0.9f, 2), 1e-6, 0).reached_limit);
}

TEST_CASE("only light that nothing absorbs is refused") {
    const auto why = [](const RadiositySystem& system) {
        return test::bad_input_message([&] { check_light_ends(system); });
    };
    const RadiositySystem white = room_of(30, 1, 2);
    CHECK(why(white).find(" of 30 ") != std::string::npos); // only a third of the patches reflects red
    RadiositySystem system = white;
    for (SystemPatch& patch : system.patches) patch.reflectance = grey(1);
    CHECK(why(system).find("30 of 30") != std::string::npos);
    RadiositySystem dark = system;
    for (SystemPatch& patch : dark.patches) patch.exitance = {};
    for (Rgb& direct : dark.direct) direct = {};
    CHECK(why(dark) == "no error");
    RadiositySystem absorbing = system; // one absorbing patch is enough
    absorbing.patches[3].reflectance = grey(0.99f);
    CHECK(why(absorbing) == "no error");
    RadiositySystem open = system; // a window covers one patch
    for (FormFactor& factor : open.rows[7]) factor.factor *= 0.99f;
    CHECK(why(open) == "no error");
    // There are two rooms, and the one that absorbs nothing has no light.
    RadiositySystem rooms;
    rooms.patches = {{1, grey(1), {}}, {1, grey(1), {}}, {1, grey(0.5f), grey(1)}, {1, grey(1), {}}};
    rooms.direct.assign(4, {});
    rooms.rows = {{{1, 1.0f}}, {{0, 1.0f}}, {{3, 1.0f}}, {{2, 1.0f}}};
    CHECK(why(rooms) == "no error");
    rooms.direct[1] = grey(1);
    CHECK(why(rooms).find("2 of 4") != std::string::npos);
}

TEST_CASE("ambient light is averaged over patches that receive light from others") {
    const RadiositySystem inside = room_of(40, 0.8f, 2);
    RadiositySystem with_outside = inside;
    for (int i = 0; i < 40; ++i) {
        with_outside.patches.push_back({5, grey(0.8f), {}});
        with_outside.direct.push_back({});
        with_outside.rows.emplace_back();
    }
    const Rgb alone = solve_by_southwell(inside, 0, 5).ambient, both = solve_by_southwell(with_outside, 0, 5).ambient;
    CHECK(static_cast<double>(both.g) == doctest::Approx(static_cast<double>(alone.g)).epsilon(1e-5));
}
