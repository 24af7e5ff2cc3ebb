// Open Image Denoise, loaded at run time: a substitute (stand_in/oidn.cpp) records its calls and fails on request.
// Incompatible libraries are refused. Film, layers and frames do not depend on it. robust/cli_oidn_test.py tests the
// library itself.

#include <dlfcn.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include <doctest/doctest.h>

#include "base/stopwatch.h"
#include "base/write_file_atomically.h"
#include "denoise/oidn/oidn_filter.h"
#include "formats/read_scene.h"
#include "image/picture_hash.h"
#include "session/devices/render_on_devices.h"
#include "session/film_file/merge_films.h"
#include "session/pictures/check_options.h"
#include "session/session_bytes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// Selects the library that is found while this object exists.
class FoundLibrary {
public:
    explicit FoundLibrary(const char* path) {
        if (const char* const value = std::getenv("PERTEV_OIDN")) before_ = value;
        ::setenv("PERTEV_OIDN", path, 1);
    }
    ~FoundLibrary() {
        if (before_) {
            ::setenv("PERTEV_OIDN", before_->c_str(), 1);
        } else {
            ::unsetenv("PERTEV_OIDN");
        }
    }

private:
    std::optional<std::string> before_;
};

/// The substitute and its controls.
struct StandIn {
    FoundLibrary found{PERTEV_OIDN_STAND_IN};
    void* library = ::dlopen(PERTEV_OIDN_STAND_IN, RTLD_NOW);
    ~StandIn() {
        if (library == nullptr) return;
        fail("", 0);
        ::dlclose(library);
    }
    bool is_there() const {
        if (library == nullptr) std::printf("skipped: %s is not there\n", PERTEV_OIDN_STAND_IN);
        return library != nullptr;
    }
    void fail(const char* call, int with) {
        reinterpret_cast<void (*)(const char*, int)>(::dlsym(library, "stand_in_fail"))(call, with);
    }
    int objects() { return reinterpret_cast<int (*)()>(::dlsym(library, "stand_in_objects"))(); }
    int value(const char* name) {
        return reinterpret_cast<int (*)(const char*)>(::dlsym(library, "stand_in_value"))(name);
    }
};

RenderSettings small_settings(Denoise denoise) {
    RenderSettings settings;
    settings.width = 48, settings.height = 32;
    settings.path.max_depth = 3;
    settings.denoise = denoise;
    return settings;
}

std::optional<Error> refusal_of(const char* path) {
    const FoundLibrary found(path);
    return thrown_error([] { OidnLibrary::find("denoise"); });
}

} // namespace

TEST_CASE("a filter passes picture, guides, quality and threads, and all objects are released") {
    StandIn stand_in;
    if (!stand_in.is_there()) return;
    Queue queue = requested_queue();
    {
        OidnFilter filter(queue, 3, 2, OidnQuality::Fast, "denoise");
        CHECK(stand_in.objects() == 2);
        CHECK(stand_in.value("quality") == 4);
        CHECK(stand_in.value("hdr") == 1);
        CHECK(stand_in.value("cleanAux") == 0);
        CHECK(stand_in.value("setAffinity") == 0);
        CHECK(stand_in.value("numThreads") == thread_count());
        CHECK(filter.name() == "Open Image Denoise 2.5.1 on the CPU, fast quality");
        std::vector<Float4> images;
        for (float i = 0; i < 18; ++i) images.push_back({i, 10 * i, 100 * i, 7});
        queue.copy_to_device(filter.color(), images.data(), images.size() * sizeof(Float4));
        filter.run();
        std::vector<Float4> made(6);
        queue.copy_to_host(made.data(), filter.color(), made.size() * sizeof(Float4));
        for (std::size_t i = 0; i < 6; ++i) {
            const Float4 color = images[i], albedo = images[6 + i], normal = images[12 + i];
            CHECK(made[i].x == 0.5f * color.x + 0.25f * albedo.x + 0.125f * normal.x);
            CHECK(made[i].z == 0.5f * color.z + 0.25f * albedo.z + 0.125f * normal.z);
        }
    }
    CHECK(stand_in.objects() == 0);
    OidnFilter fine(queue, 3, 2, OidnQuality::High, "denoise");
    CHECK(stand_in.value("quality") == 6);
    CHECK(stand_in.value("cleanAux") == 1);
}

TEST_CASE("a library that is missing, lacks a function, has no device or is of another version is refused") {
    if (!StandIn().is_there()) return;
    for (const char* path : {"/nowhere", "/nowhere/x.so", "libz.so.1", "/", PERTEV_OIDN_LACKING, PERTEV_OIDN_OLD}) {
        CAPTURE(path);
        CHECK(is_about(refusal_of(path), ErrorCode::BadInput, "denoise", "oidn"));
    }
    CHECK(says(refusal_of(PERTEV_OIDN_LACKING), "oidnNewFilter"));
    CHECK(says(refusal_of(PERTEV_OIDN_OLD), "1.4.3"));
    CHECK(says(refusal_of("/nowhere"), "pip install pyoidn"));
    CHECK(!refusal_of(PERTEV_OIDN_STAND_IN));
    const std::filesystem::path folder = scratch_folder();
    std::filesystem::create_directory(folder / "lib");
    std::filesystem::create_symlink(PERTEV_OIDN_STAND_IN, folder / "lib/libOpenImageDenoise.so.2");
    CHECK(!refusal_of(folder.c_str()));
    CHECK(!refusal_of((folder / "lib").c_str()));
    // Before any render, and after a library was found.
    const FoundLibrary none("/nowhere");
    Queue queue = requested_queue();
    Messages messages;
    const Scene scene = make_furnace_scene(0.5f);
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    CHECK(is_about(thrown_error([&] { Session(queue, prepared, mixed_scene_camera(), small_settings(Denoise::Oidn)); }),
                   ErrorCode::BadInput, "denoise", "oidn"));
    Session session(queue, prepared, mixed_scene_camera(), small_settings(Denoise::None));
    CHECK(is_about(thrown_error([&] { session.render_frame(0, {.denoiser = FrameDenoiser::Oidn}); }),
                   ErrorCode::BadInput, "frame_denoiser", "oidn"));
}

TEST_CASE("parts of rows and samples have the guides of one run, in any order") {
    StandIn stand_in;
    if (!stand_in.is_there()) return;
    Queue queue = requested_queue();
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = small_settings(Denoise::Oidn);
    settings.samples = 23; // more than those that are always gathered
    DeviceScene on_device(queue);
    on_device.set(prepared, settings);
    PictureRenderer pictures(on_device);
    FilmRender whole(pictures, mixed_scene_camera(), settings), fewer(pictures, mixed_scene_camera(), settings);
    REQUIRE(whole.render({0, 23}) == 23);
    REQUIRE(fewer.render({0, 16}) == 16);
    const Image expected = whole.denoised().value();
    CHECK(expected.pixels != fewer.denoised().value().pixels);
    FilmHeader header;
    header.width = settings.width, header.height = settings.height, header.denoise = settings.denoise;
    header.spp = 23;
    const std::vector<FilmPart> bands = {{0, 5, {0, 23}}, {5, 32, {0, 23}}},
                                samples = {{0, 32, {0, 3}}, {0, 32, {3, 17}}, {0, 32, {17, 20}}, {0, 32, {20, 23}}},
                                both = {{0, 5, {0, 23}}, {5, 32, {0, 18}}, {5, 32, {18, 23}}};
    const auto file_of = [&](const FilmPart& of) {
        settings.first_row = of.first_row, settings.end_row = of.end_row;
        FilmRender part(pictures, mixed_scene_camera(), settings);
        REQUIRE(part.render(of.samples) == of.samples.count());
        header.parts = {of};
        const std::string file = scratch_folder() / "part.pvf";
        const std::vector<std::byte> bytes = film_file_bytes(header, part.film());
        write_file_atomically(file, bytes);
        return file;
    };
    for (const std::vector<FilmPart>& parts : {bands, samples, both}) {
        std::vector<std::string> files;
        for (const FilmPart& of : parts) files.push_back(file_of(of));
        for (int order = 0; order < 2; ++order) {
            const FilmMerge merge(files, false);
            Film all = merge.film(queue, nobody());
            for (std::size_t i = 0; i < all.targets().size(); ++i)
                CHECK(all.targets()[i]->bytes() == whole.film().targets()[i]->bytes());
            const RenderResult result = result_of(merge.header(), all, queue);
            CHECK(result.denoised.value().pixels == expected.pixels);
            CHECK(result.denoiser == whole.denoiser());
            std::ranges::reverse(files);
        }
    }
    // The substitute makes each pixel of itself alone.
    const FilmMerge merge(std::vector<std::string>{file_of({5, 20, {0, 16}}), file_of({20, 32, {0, 23}})}, true);
    Film some = merge.film(queue, nobody());
    const Image made = result_of(merge.header(), some, queue).denoised.value();
    CHECK(stand_in.value("not_finite") == 0);
    const Image of_fewer = fewer.denoised().value();
    const std::size_t row = std::size_t(3) * made.width;
    for (std::size_t i = 0; i < made.pixels.size(); ++i)
        REQUIRE(made.pixels[i] == (i < 5 * row ? 0.0f : i < 20 * row ? of_fewer.pixels[i] : expected.pixels[i]));
}

namespace {

void check_devices(Denoise denoise) {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = small_settings(denoise);
    settings.samples = 40;
    settings.pass_samples = 1; // one sample a slice
    const auto bytes_of = [](const Film& film) {
        std::vector<std::vector<std::byte>> all;
        for (const auto& target : film.targets()) all.push_back(target->bytes());
        return all;
    };
    Queue queue = requested_queue();
    Session alone(queue, prepared, mixed_scene_camera(), settings);
    alone.render(settings.range());
    const RenderResult expected = alone.result();
    for (const int fails : {0, 1}) {
        for (const double fold_s : {0.0, kFoldSeconds}) {
            if (denoise == Denoise::Svgf && (fold_s > 0) != (fails == 1)) continue; // two ways suffice for its sums
            CAPTURE(fails);
            CAPTURE(fold_s);
            std::atomic<int> slices[3] = {};
            DeviceHooks hooks;
            hooks.fold_s = fold_s;
            hooks.after_slice = [&](std::size_t number, SampleRange) {
                if (++slices[number] == 2 && number == 1 && fails == 1)
                    throw Error(ErrorCode::DeviceFault, "a test ends this device");
                const Stopwatch watch; // until each has taken two slices
                const auto all_have = [&] { return slices[0] > 1 && slices[1] > 1 && slices[2] > 1; };
                while (!all_have() && slices[number] > 1 && watch.seconds() < 20) std::this_thread::yield();
            };
            std::vector<std::shared_ptr<Queue>> queues;
            for (int i = 0; i < 3; ++i) queues.push_back(std::make_shared<Queue>(requested_queue()));
            RenderOnDevices together(queues, prepared, hooks);
            Session session(*queues.front(), prepared, mixed_scene_camera(), settings);
            session.pictures().share(together);
            CHECK(session.render({0, 18}) == 18); // more than are always gathered, and then the others
            CHECK(session.render({18, 40}) == 22);
            CHECK(slices[1] > 1);
            CHECK(bytes_of(session.film()) == bytes_of(alone.film()));
            const RenderResult result = session.result();
            CHECK(result.denoised.value().pixels == expected.denoised.value().pixels);
            CHECK(result.denoiser == expected.denoiser);
            CHECK(result.rays.total() == expected.rays.total());
        }
    }
    // Samples of a checkpoint, and others of another picture.
    std::vector<std::shared_ptr<Queue>> queues = {std::make_shared<Queue>(requested_queue()),
                                                  std::make_shared<Queue>(requested_queue())};
    RenderOnDevices together(queues, prepared);
    Session session(*queues.front(), prepared, mixed_scene_camera(), settings);
    session.pictures().share(together);
    for (const uint32_t seed : {9u, settings.path.seed}) {
        RenderSettings of_seed = settings;
        of_seed.path.seed = seed;
        session.set_settings(of_seed);
        session.render({0, 20});
    }
    FilmRender goes_on(session.pictures(), mixed_scene_camera(), settings);
    const auto take = [&](Film& into) {
        for (std::size_t i = 0; i < into.targets().size(); ++i)
            into.targets()[i]->set_bytes(session.film().targets()[i]->bytes());
    };
    goes_on.restore({0, 20}, take, {}, 0);
    CHECK(goes_on.render({20, 40}) == 20);
    CHECK(bytes_of(goes_on.film()) == bytes_of(alone.film()));
    CHECK(goes_on.denoised().value().pixels == expected.denoised.value().pixels);
}

} // namespace

TEST_CASE("several devices gather for Open Image Denoise what one does, also if one of them fails") {
    const StandIn stand_in;
    if (stand_in.is_there()) check_devices(Denoise::Oidn);
}

TEST_CASE("several devices gather for svgf what one does, also if one of them fails") { check_devices(Denoise::Svgf); }

TEST_CASE("a call that fails is an error of its kind, and nothing leaks") {
    StandIn stand_in;
    if (!stand_in.is_there()) return;
    Queue queue = requested_queue();
    const auto fault_of = [&](const char* call, int with) {
        stand_in.fail(call, with);
        const std::optional<Error> error =
            thrown_error([&] { OidnFilter(queue, 4, 4, OidnQuality::High, "denoise").run(); });
        stand_in.fail("", 0);
        CHECK(stand_in.objects() == 0);
        REQUIRE(error.has_value());
        return error->code();
    };
    for (const char* call :
         {"oidnNewDevice", "oidnCommitDevice", "oidnNewFilter", "oidnCommitFilter", "oidnExecuteFilter"}) {
        CAPTURE(call);
        OidnLibrary::find("denoise");
        CHECK(fault_of(call, 4) == ErrorCode::OutOfMemory);
        CHECK(fault_of(call, 1) == ErrorCode::DeviceFault);
    }
}

TEST_CASE("Open Image Denoise gets means of guides and does not change film and layers") {
    StandIn stand_in;
    if (!stand_in.is_there()) return;
    Messages messages;
    const Scene scene =
        read_scene("cornell-box", {}, messages); // the surface is diffuse, so its albedo is that of the layer
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    RenderSettings settings = small_settings(Denoise::Oidn);
    settings.aovs = kAovAlbedo | kAovNormal;
    settings.filter = PixelFilter::Box;
    settings.transparent = true; // alpha is the share of samples that hit something
    Session session(queue, prepared, scene.cameras.front(), settings);
    session.render(7);
    session.denoised(); // an invalid sample does not change the guides
    session.render(16); // to more than are always gathered
    const RenderResult denoised = session.result();
    CHECK(denoised.denoiser == "Open Image Denoise 2.5.1 on the CPU, high quality");
    settings.denoise = Denoise::None;
    session.set_settings(settings);
    session.render(23);
    const RenderResult plain = session.result();
    CHECK(plain.denoiser.empty());
    CHECK(!plain.denoised);
    CHECK(picture_hash(denoised.picture) == picture_hash(plain.picture));
    const Image &albedo = layer_named(plain, "albedo"), &normal = layer_named(plain, "normal");
    CHECK(layer_named(denoised, "albedo").pixels == albedo.pixels);
    float largest = 0;
    for (std::size_t pixel = 0; pixel < albedo.pixels.size() / 3; ++pixel) {
        const float *before = &plain.picture.pixels[4 * pixel], *made = &denoised.denoised.value().pixels[4 * pixel];
        for (std::size_t c = 0; c < 3; ++c) { // the layer's normals are means over the samples that hit something
            const float mean_normal = before[3] * normal.pixels[3 * pixel + c];
            const float expected = 0.5f * before[c] + 0.25f * albedo.pixels[3 * pixel + c] + 0.125f * mean_normal;
            largest = max(largest, pertev::abs(made[c] - expected));
        }
        if (made[3] != before[3]) FAIL("alpha of pixel ", pixel);
    }
    CHECK(largest < 1e-5f);
}

TEST_CASE("frames are denoised only for display, and do not depend on denoised ones") {
    StandIn stand_in;
    if (!stand_in.is_there()) return;
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    for (const float scale : {1.0f, 0.5f}) {
        const ReconstructionSettings by_oidn = {.denoiser = FrameDenoiser::Oidn, .resolution_scale = scale},
                                     plain = of_samples_alone(by_oidn);
        Session session(queue, prepared, mixed_scene_camera(), small_settings(Denoise::None)),
            other(queue, prepared, mixed_scene_camera(), small_settings(Denoise::None));
        for (uint32_t number = 0; number < 3; ++number) {
            session.render_frame(number, by_oidn);
            other.render_frame(number, plain);
            const RenderResult made = session.frame_result();
            CHECK(picture_hash(made.picture) == picture_hash(other.frame_result().picture));
            CHECK(picture_hash(made.denoised.value()) != picture_hash(made.picture));
            CHECK(made.denoiser == "Open Image Denoise 2.5.1 on the CPU, fast quality");
        }
        session.frame().display(ToneMap::Agx, 0);
        other.frame().display(ToneMap::Agx, 0);
        CHECK(session.frame().displayed().pixels != other.frame().displayed().pixels);
        session.render_frame(3, plain);
        other.render_frame(3, plain);
        CHECK(!session.frame_result().denoised);
        CHECK(picture_hash(session.frame_result().picture) == picture_hash(other.frame_result().picture));
        session.frame().display(ToneMap::Agx, 0);
        other.frame().display(ToneMap::Agx, 0);
        CHECK(session.frame().displayed().pixels == other.frame().displayed().pixels);
    }
}

TEST_CASE("memory of buffers for Open Image Denoise equals its prediction") {
    StandIn stand_in;
    if (!stand_in.is_there()) return;
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    const auto bytes_of = [&](Denoise denoise) {
        RenderSettings settings = small_settings(denoise);
        settings.samples = 1;
        Session session(queue, prepared, mixed_scene_camera(), settings);
        session.render(1);
        return queue.allocated_bytes() - predicted_bytes(prepared, settings, queue.is_cuda());
    };
    CHECK(bytes_of(Denoise::Oidn) == bytes_of(Denoise::None));
    const auto frame_bytes_of = [&](FrameDenoiser denoiser) {
        const RenderSettings settings = small_settings(Denoise::None);
        const ReconstructionSettings frames = {.denoiser = denoiser};
        Session session(queue, prepared, mixed_scene_camera(), settings);
        session.render_frame(0, frames);
        return queue.allocated_bytes() - predicted_frame_bytes(prepared, settings, frames, {}, queue.is_cuda());
    };
    CHECK(frame_bytes_of(FrameDenoiser::Oidn) == frame_bytes_of(FrameDenoiser::Svgf));
}
