// Patches, their display, and the file of a solution.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>

#include "base/read_file.h"
#include "integrators/kinds/make_integrator.h"
#include "radiosity/corner_light.h"
#include "radiosity/solve_memory.h"
#include "tests/support/cpu_seconds.h"
#include "tests/support/options.h"
#include "tests/support/radiosity_scenes.h"
#include "tests/support/random.h"
#include "tests/support/render_scenes.h"
#include "tests/support/stop_after.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

RadiositySettings quick_settings() {
    RadiositySettings settings;
    settings.patch_size = 0.8f;
    settings.rays = 64;
    return settings;
}

Scene lit_box(float reflectance = 0.5f) {
    Scene scene = test::closed_box(test::white(reflectance));
    test::add(scene, test::sheet({0.2f, 0.9f, 0}, {0.3f, 0, 0}, {0, 0, 0.3f}), test::emitter_material(0, 5));
    return scene;
}

RadiositySolution solution_of(const Scene& scene, const RadiositySettings& settings = quick_settings()) {
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    return solve_radiosity(prepared, settings).solution;
}

void write_bytes(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// Returns whether the file is refused for `scene`, for a reason that contains `says`.
bool refuses_solution(const std::filesystem::path& path, const Scene& scene, const char* says = "") {
    Messages messages;
    const auto error = test::thrown_error([&] { read_solution(path, scene, messages); });
    return test::is_at(error, ErrorCode::BadInput, {path.string()}) && test::says(error, says);
}

} // namespace

TEST_CASE("patches cover their triangles with edges within the requested length, and each point finds its patch") {
    test::PatchedScene patched(lit_box(), 0.8f);
    double area = 0;
    for (const Patch& patch : patched.tree.patches) {
        if (patch.side() == 0 && patch.instance < 6) area += static_cast<double>(patch.area);
        const WorldTriangle triangle = world_triangle(patched.solved.view(), patch, patch.corners.middle());
        for (int k = 0; k < 3; ++k) {
            const Vec2 a = patch.corners.at[k], b = patch.corners.at[(k + 1) % 3];
            CHECK(length(triangle.at(a.x, a.y) - triangle.at(b.x, b.y)) <= 0.8f);
        }
    }
    CHECK(area == doctest::Approx(24).epsilon(1e-5));
    for (uint32_t i = 0; i < 40; i += 7) patched.tree.split(patched.solved.view(), i);
    std::size_t lookups = 0;
    for (uint32_t i = 0; i < patched.tree.patches.size(); ++i) {
        const Patch& patch = patched.tree.patches[i];
        for (const Vec2 b : {Vec2{0.2f, 0.3f}, Vec2{0.6f, 0.3f}, Vec2{0.1f, 0.8f}}) {
            const Vec2 at = patch.corners.uv_at(b);
            Vec3 weights = {1.0f - at.x - at.y, at.x, at.y};
            CHECK(patched.tree.view().find(patch.face, weights) == (kIsPatch | i));
            CHECK(weights.y == doctest::Approx(b.x).epsilon(1e-4));
            CHECK(weights.z == doctest::Approx(b.y).epsilon(1e-4));
            ++lookups;
        }
    }
    CHECK(lookups == 3 * patched.tree.patches.size());
}

TEST_CASE("displayed light has no gap where a patch meets smaller ones") {
    Scene scene;
    test::add(scene, test::floor_at(0, 1), test::white(0.5f));
    test::PatchedScene patched(std::move(scene), 1.5f); // there are four patches per triangle
    for (const uint32_t i : {0u, 0u, 3u}) patched.tree.split(patched.solved.view(), i);
    std::vector<Rgb> irradiance;
    for (const Patch& patch : patched.tree.patches) {
        const Vec2 middle = patch.corners.middle();
        irradiance.push_back(grey(1 + middle.x + 3 * middle.y * middle.y));
    }
    const SceneView& view = patched.solved.view();
    const std::vector<PatchLight> lights = light_corners(view, patched.tree, irradiance);
    const RadiosityView shown = {patched.tree.view(), lights.data(), {}};
    // Compares the light on both sides of each edge of each patch.
    int compared = 0;
    for (const Patch& patch : patched.tree.patches) {
        if (patch.side() != 0) continue;
        const Vec2 middle = patch.corners.middle();
        for (int k = 0; k < 3; ++k) {
            const Vec2 a = patch.corners.at[k], b = patch.corners.at[(k + 1) % 3];
            for (const float t : {0.1f, 0.3f, 0.7f, 0.9f}) {
                const Vec2 edge = a + t * (b - a);
                const Vec2 inside = edge + 1e-3f * (middle - edge), outside = edge - 1e-3f * (middle - edge);
                if (min(outside.x, min(outside.y, 1 - outside.x - outside.y)) < 0) continue;
                const Rgb one = shown.irradiance(patch.face, inside.x, inside.y),
                          other = shown.irradiance(patch.face, outside.x, outside.y);
                CHECK(pertev::abs(one.r - other.r) < 0.02f);
                ++compared;
            }
        }
    }
    CHECK(compared > 100);
    const RadiosityView flat = {patched.tree.view(), lights.data(), grey(7), true};
    CHECK(flat.irradiance(patched.tree.patches[5].face, patched.tree.patches[5].corners.middle().x,
                          patched.tree.patches[5].corners.middle().y) == irradiance[5] + grey(7));
}

TEST_CASE("a solution is read back from its file, and another scene's or a damaged one is refused") {
    const std::filesystem::path path = test::scratch_folder() / "solution";
    const Scene scene = lit_box();
    const RadiositySolution solution = solution_of(scene);
    write_solution(path, solution);
    Messages messages;
    const RadiositySolution back = read_solution(path, scene, messages);
    CHECK(back.hash() == solution.hash());
    CHECK(back.geometry == solution.geometry);
    CHECK(back.light == solution.light);
    CHECK(back.made == solution.made);

    Scene moved = scene;
    moved.instances[6].world_from_local = make_translation({0, 0, 0.01f});
    CHECK(refuses_solution(path, moved));
    Scene dented = scene;
    dented.meshes[0].positions[1].x += 0x1p-20f;
    CHECK(refuses_solution(path, dented));
    const std::vector<std::byte> whole = read_file(path);
    for (const std::size_t length :
         {std::size_t(0), std::size_t(15), std::size_t(95), std::size_t(127), whole.size() / 2, whole.size() - 1}) {
        write_bytes(path, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)});
        CHECK(refuses_solution(path, scene));
    }
    test::Random random(5);
    for (int i = 0; i < 300; ++i) { // flips a random bit
        std::vector<std::byte> damaged = whole;
        const auto most = static_cast<uint32_t>(whole.size());
        const std::size_t at = i < 136 ? static_cast<std::size_t>(i) : random.below(most);
        if (at >= 92 && at < 96) continue; // the reason mentions no part
        damaged[at] ^= std::byte(1u << random.below(8));
        write_bytes(path, damaged);
        CAPTURE(at);
        CHECK(refuses_solution(path, scene));
    }
    std::filesystem::remove(path);
    CHECK(refuses_solution(path, scene));
    CHECK(messages.all().empty());
}

namespace {

/// A scene with every kind of light and surface, whether a solution supports it or not.
Scene scene_of_all_light() {
    Scene scene = lit_box();
    test::add(scene, test::sheet({0.4f, -0.5f, 0}, {0.2f, 0, 0}, {0, 0, 0.2f}), test::mirror());
    test::add(scene, test::sheet({-0.4f, -0.5f, 0}, {0.2f, 0, 0}, {0, 0, 0.2f}), test::white(0.3f));
    Material& textured = scene.materials.back();
    textured.base_color_texture.image = 0;
    textured.alpha_mode = AlphaMode::Mask;
    scene.meshes.back().uv[0].assign(scene.meshes.back().positions.size(), {0.5f, 0.5f});
    scene.images.push_back({.name = "grey", .rgba8 = {1, 1, {128, 128, 128, 255}}, .rgba_float = {}});
    scene.lights.push_back(test::point_light({0, 0.5f, 0}, {1, 1, 1}));
    scene.lights.push_back({.kind = LightKind::Spot});
    scene.environment = Environment{{2, 1, 3, {1, 1, 1, 2, 2, 2}}, {1, 1, 1}, 0};
    return scene;
}

} // namespace

TEST_CASE("a solution is rendered only with the light it was solved for") {
    const std::filesystem::path path = test::scratch_folder() / "light";
    const Scene scene = scene_of_all_light();
    write_solution(path, solution_of(scene));
    const auto check_refused = [&](const char* says, const std::function<void(Scene&)>& change) {
        Scene changed = scene;
        change(changed);
        CHECK(refuses_solution(path, changed, says));
    };
    const char* const surfaces = "`two_sided_lights`"; // names a setting that may have changed them
    check_refused(surfaces, [](Scene& s) { s.materials[6].emission = grey(6); });
    check_refused(surfaces, [](Scene& s) { s.materials[6].two_sided_emission ^= true; });
    check_refused(surfaces, [](Scene& s) { s.materials[0].base_color.g += 0x1p-20f; });
    check_refused(surfaces, [](Scene& s) { s.materials[0].kind = MaterialKind::Unlit; });
    check_refused(surfaces, [](Scene& s) { s.materials[8].alpha_cutoff = 0.9f; });
    check_refused(surfaces, [](Scene& s) { s.materials[8].base_color_texture.m02 = 0.25f; });
    check_refused(surfaces, [](Scene& s) { s.images[0].rgba8.pixels[1] = 127; });
    check_refused(surfaces, [](Scene& s) { s.meshes.back().uv[0][1].x = 0; });
    check_refused(surfaces, [](Scene& s) { s.meshes[0].colors.assign(s.meshes[0].positions.size(), {1, 0, 1, 1}); });
    check_refused(surfaces, [](Scene& s) {
        s.materials[0].kind = MaterialKind::MetallicRoughness; // the material may be partly diffuse
        s.materials[0].metallic = 0.5f;
    });
    const char* const lights = "`environment`";
    check_refused(lights, [](Scene& s) { s.lights[0].intensity = 2.0f * s.lights[0].intensity; });
    check_refused(lights, [](Scene& s) { s.lights[0].position.y -= 0.1f; });
    check_refused(lights, [](Scene& s) { s.lights[0].range = 4; });
    check_refused(lights, [](Scene& s) { s.lights[1].direction = {1, 0, 0}; });
    check_refused(lights, [](Scene& s) { s.lights[1].cos_inner = 0.9f; });
    check_refused(lights, [](Scene& s) { s.lights.pop_back(); });
    check_refused(lights, [](Scene& s) { s.environment->scale.b = 2; });
    check_refused(lights, [](Scene& s) { s.environment->rotation = 1; });
    check_refused(lights, [](Scene& s) { s.environment->image.pixels[4] = 3; });
    check_refused(lights, [](Scene& s) { s.environment.reset(); });

    Scene seen = scene; // changes that do not affect a solution
    seen.cameras.emplace_back();
    seen.materials[0].name = seen.lights[0].name = seen.instances[0].name = "of another name";
    seen.materials[0].double_sided = false;
    seen.materials[0].normal_scale = 2;
    seen.materials[7].roughness = 0.7f; // the mirror
    seen.materials[7].eta = {1, 1, 1};
    seen.materials.push_back(test::white(0.9f)); // no instance has it
    seen.lights[0].direction = {1, 0, 0};        // direction of a point light
    CHECK_FALSE(refuses_solution(path, seen));
}

TEST_CASE("a solution's file of the previous version is read with a warning that its light is unknown") {
    const std::filesystem::path path = test::scratch_folder() / "old";
    Scene scene = lit_box();
    const RadiositySolution solution = solution_of(scene);
    write_solution(path, solution);
    std::vector<std::byte> bytes = read_file(path);
    bytes[15] = std::byte('1');
    bytes.erase(bytes.begin() + 96,
                bytes.begin() + 136); // that version stored neither hashes of light nor the state of the solution
    write_bytes(path, bytes);
    scene.materials[6].emission = grey(50);
    Messages messages;
    const RadiositySolution back = read_solution(path, scene, messages);
    CHECK(back.hash() == solution.hash());
    CHECK_FALSE(back.light.has_value());
    REQUIRE(messages.all().size() == 1);
    CHECK(messages.all()[0].is_warning);
    scene.meshes[0].positions[1].x += 1;
    CHECK(refuses_solution(path, scene));
    scene.meshes[0].positions[1].x -= 1;
    CHECK_FALSE(refuses_solution(path, scene));
    bytes[15] = std::byte('4');
    write_bytes(path, bytes);
    CHECK(refuses_solution(path, scene));
}

TEST_CASE("an interrupted solution records its state and is rendered with a warning") {
    const std::filesystem::path path = test::scratch_folder() / "ended";
    Messages messages;
    /// Stops at the report number `heard` of the step `during`.
    const auto ended = [&](RadiositySolver solver, const std::string& during, int heard, float reflectance = 0.5f) {
        const Scene scene = lit_box(reflectance);
        const PreparedScene prepared = prepare_scene(scene, {}, messages);
        RadiositySettings settings = quick_settings();
        settings.solver = solver;
        if (solver != RadiositySolver::Matrix) settings.patch_size = 0.2f; // there are too many for it
        settings.contrast = 0.01f;
        int count = 0;
        ProgressSink sink([&](const Progress& now) { return now.doing != during || ++count < heard; });
        const SolvedRadiosity solved = solve_radiosity(prepared, settings, sink);
        CHECK(solved.stats.was_interrupted);
        write_solution(path, solved.solution);
        Messages warnings;
        const RadiositySolution back = read_solution(path, scene, warnings);
        CHECK(back.hash() == solved.solution.hash());
        CHECK(back.extent == solved.solution.extent);
        REQUIRE(warnings.all().size() == 1);
        CHECK(warnings.all()[0].is_warning);
        CHECK(warnings.all()[0].text.find(describe(back.extent)) != std::string::npos);
        return back;
    };
    const RadiositySolution begun = ended(RadiositySolver::Hierarchical, "direct light", 1);
    CHECK(begun.extent == SolvedExtent{SolvedPart::SomeDirectLight, 1});
    const RadiositySolution direct = ended(RadiositySolver::Hierarchical, "links, pass 1", 1);
    CHECK(direct.extent == SolvedExtent{SolvedPart::DirectLight, 1});
    const RadiositySolution darker = ended(RadiositySolver::Hierarchical, "links, pass 1", 1, 0.25f);
    const auto same_light = [](const PatchLight& a, const PatchLight& b) { return a.mean == b.mean; };
    CHECK(std::ranges::equal(direct.patches, darker.patches, same_light)); // walls reflect nothing
    const RadiositySolution linked = ended(RadiositySolver::Hierarchical, "links, pass 2", 1);
    CHECK(linked.extent.part == SolvedPart::SomeBounces);
    CHECK(linked.extent.left < 1);
    const RadiositySolution swept = ended(RadiositySolver::GaussSeidel, "solving", 1);
    CHECK(swept.extent.part == SolvedPart::SomeBounces);
    CHECK(swept.extent.left == 1);
    const RadiositySolution eliminated = ended(RadiositySolver::Matrix, "solving", 1);
    CHECK(eliminated.extent == SolvedExtent{SolvedPart::DirectLight, 1});
    const auto is_lit = [](const PatchLight& patch) { return luminance(patch.mean) > 0; };
    CHECK(std::ranges::any_of(eliminated.patches, is_lit));
    const RadiositySolution divided = ended(RadiositySolver::GaussSeidel, "dividing patches", 1);
    CHECK(divided.extent == SolvedExtent{SolvedPart::SomeDivided, 0});

    const Scene scene = lit_box();
    RadiositySolution whole = solution_of(scene);
    CHECK(whole.extent == SolvedExtent{});
    const Hash128 hash = whole.hash();
    for (const SolvedPart part : {SolvedPart::DirectLight, SolvedPart::SomeDivided}) { // the other differences
        whole.extent.part = part;
        CHECK(whole.hash() != hash);
        CHECK_FALSE(describe(whole.extent).empty());
    }
    whole.extent.left = 2; // the share is unknown
    write_solution(path, whole);
    CHECK(refuses_solution(path, scene));
}

TEST_CASE("if refinement is interrupted, subdivided patches keep the light of their parent") {
    const Scene scene = lit_box(0.02f);
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RadiositySettings settings = quick_settings();
    settings.solver = RadiositySolver::Hierarchical;
    settings.patch_size = 0.1f;
    settings.subdivisions = 0;
    bool has_links = false;
    ProgressSink sink([&](const Progress& now) {
        has_links |= now.doing.starts_with("links");
        return !has_links || now.doing != "direct light";
    });
    const SolvedRadiosity solved = solve_radiosity(prepared, settings, sink);
    CHECK(solved.stats.was_interrupted);
    CHECK(solved.solution.extent.part == SolvedPart::SomeBounces);
    CHECK(solved.solution.patches.size() > 24);                    // some patches were subdivided
    const auto dim_share = [](const RadiositySolution& solution) { // the fraction of points where light from other
                                                                   // surfaces is below a hundredth
        const auto dim = std::ranges::count_if(solution.patches,
                                               [](const PatchLight& patch) { return luminance(patch.mean) < 0.02f; });
        return static_cast<double>(dim) / static_cast<double>(solution.patches.size());
    };
    CHECK(dim_share(solved.solution) < 0.5); // it is 0.82 if the new patches are black
}

TEST_CASE("a solution's bytes depend on its settings and not on threads") {
    const Scene scene = lit_box();
    for (const auto& [method, solver] : {std::pair(FormFactors::Rays, RadiositySolver::Southwell),
                                         std::pair(FormFactors::Hemicube, RadiositySolver::GaussSeidel),
                                         std::pair(FormFactors::Rays, RadiositySolver::Matrix),
                                         std::pair(FormFactors::Rays, RadiositySolver::Hierarchical)}) {
        RadiositySettings settings = quick_settings();
        settings.rays = 16;
        settings.hemicube = 16;
        settings.form_factors = method;
        settings.solver = solver;
        const Hash128 reference = solution_of(scene, settings).hash();
        for (const int threads : {1, 5}) {
            const UseThreads use(threads);
            CHECK(solution_of(scene, settings).hash() == reference);
        }
        settings.seed = 1;
        CHECK(solution_of(scene, settings).hash() != reference);
    }
}

TEST_CASE("a scene that cannot be solved is refused") {
    const auto fault = [](const Scene& scene, const RadiositySettings& settings) {
        return test::thrown_error([&] { solution_of(scene, settings); });
    };
    Scene mirrors;
    test::add(mirrors, test::floor_at(0, 1), test::mirror());
    test::add(mirrors, test::floor_at(1, 1), test::emitter_material(0, 1));
    const auto unlit = fault(mirrors, quick_settings());
    REQUIRE(unlit);
    CHECK(unlit->code() == ErrorCode::BadInput);
    RadiositySettings tiny = quick_settings();
    tiny.patch_size = 1e-4f;
    CHECK(test::is_about(fault(lit_box(), tiny), ErrorCode::OverLimit, "patch_size", "0.0001"));
    ProgressSink stop([](const Progress&) { return false; });
    Messages messages;
    const Scene scene = lit_box();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const auto error = test::thrown_error([&] { solve_radiosity(prepared, quick_settings(), stop); });
    CHECK(error.has_value());
    CHECK(error->code() == ErrorCode::Interrupted);
    test::StopAfter asked(0); // the scene stops the solver without progress
    const auto again = test::thrown_error([&] { solve_radiosity(prepared, quick_settings(), asked); });
    CHECK(again->code() == ErrorCode::Interrupted);
}

TEST_CASE("solving stops promptly on request, however long a row takes") {
    Messages messages;
    const Scene scene = lit_box();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const auto seconds_to_end = [&](const RadiositySettings& settings, const char* during) {
        double requested = -1;
        int heard = 0;
        ProgressSink end_in([&](const Progress& now) {
            if (now.doing != during || ++heard == 1) return true; // the step begins
            if (requested < 0) requested = test::cpu_seconds();
            return false;
        });
        try {
            CHECK(solve_radiosity(prepared, settings, end_in).stats.was_interrupted);
        } catch (const Error& error) {
            CHECK(error.code() == ErrorCode::Interrupted);
        }
        CHECK(requested >= 0);
        return test::cpu_seconds() - requested;
    };
    RadiositySettings few_long_rows;
    few_long_rows.patch_size = 10;
    few_long_rows.rays = kMaxPatchRays; // each row takes seconds
    CHECK(seconds_to_end(few_long_rows, "form factors") < test::allowed_seconds(0.5));
    few_long_rows.rays = 64;
    few_long_rows.hemicube = kMaxHemicube;
    few_long_rows.form_factors = FormFactors::Hemicube;
    few_long_rows.subdivisions = 0;
    CHECK(seconds_to_end(few_long_rows, "form factors") <
          test::allowed_seconds(1.5)); // a hemicube has 16 million pixels
    RadiositySettings many_rows = quick_settings();
    many_rows.subdivisions = 6;
    many_rows.contrast = 1e-4f;
    CHECK(seconds_to_end(many_rows, "dividing patches") < test::allowed_seconds(1));
}

TEST_CASE("memory of a solution equals its prediction, and a limit one byte below is refused") {
    Messages messages;
    const Scene scene = lit_box();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    for (const FormFactors method : {FormFactors::Rays, FormFactors::Hemicube}) {
        for (const RadiositySolver solver : {RadiositySolver::Southwell, RadiositySolver::GaussSeidel,
                                             RadiositySolver::Matrix, RadiositySolver::Hierarchical}) {
            RadiositySettings settings = quick_settings();
            settings.form_factors = method;
            settings.hemicube = 16;
            settings.solver = solver;
            const SolveMemory memory = predict_memory(prepared, settings, 2);
            const SolveStats stats = solve_radiosity(prepared, settings).stats;
            CHECK(stats.patches <= memory.patches);
            CHECK(memory.patches <= 2 * stats.patches);
            CHECK(stats.shown <= memory.shown);
            CHECK(stats.bytes <= memory.bytes);
            check_memory(memory, settings, memory.bytes);
            const auto error = test::thrown_error([&] { check_memory(memory, settings, memory.bytes - 1); });
            REQUIRE(error);
            CHECK(error->code() == ErrorCode::OutOfMemory);
        }
    }
    // Each of these settings takes more memory.
    const RadiositySettings settings = quick_settings();
    const std::size_t least = predict_memory(prepared, settings, 2).bytes;
    RadiositySettings more = settings;
    more.subdivisions = 4;
    CHECK(predict_memory(prepared, more, 2).bytes > 8 * least);
    more = settings;
    more.form_factors = FormFactors::Hemicube;
    more.hemicube = 512;
    CHECK(predict_memory(prepared, more, 2).bytes > least + 2 * 512 * 512 * 24);
    CHECK(predict_memory(prepared, more, 8).bytes > predict_memory(prepared, more, 2).bytes + 6 * 512 * 512 * 24);
}
