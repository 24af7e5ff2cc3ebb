// Test code adds a target that ranks instances by coverage to a film. A render adds samples to it, its results are
// correct, and parts of a film add up to the whole, byte for byte, across serialisation and devices.

#include "tests/seams/ranked_coverage.h"

#include <doctest/doctest.h>

#include "tests/seams/picture_on_device.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr uint32_t kMatteWidth = 13, kMatteHeight = 9, kMatteSamples = 8;

/// Black squares in a row that emit red, green and blue in turn. At most three are in one pixel.
Scene striped_scene() {
    Scene scene;
    for (uint32_t i = 0; i < 9; ++i) {
        Rgb color = {0, 0, 0};
        (i % 3 == 0 ? color.r : i % 3 == 1 ? color.g : color.b) = 1;
        const float x = 0.25f * static_cast<float>(i) - 1;
        test::add_emitter(scene, test::make_square(1), color,
                          compose(make_translation({x, 0, 0.1f * static_cast<float>(i)}), make_scale({0.125f, 1, 1})));
        scene.materials.back().base_color = {0, 0, 0};
    }
    return scene;
}
Camera from_below() {
    Camera camera;
    camera.world_from_camera = look_at({0.1f, -6, 0.2f}, {0.1f, 0, 0.2f}, {0.2f, 0, 1});
    camera.fov_y = 0.5f;
    return camera;
}

template <uint32_t kIds>
struct Matte {
    Matte(Queue& on, const PreparedScene& prepared)
        : queue(on), picture(on, prepared, from_below(), kMatteWidth, kMatteHeight),
          film(on, kMatteWidth, kMatteHeight, kAovIds) {
        auto target = std::make_unique<test::CoverageTarget<kIds>>(on, kMatteWidth * kMatteHeight);
        coverage = target.get();
        film.hold(std::move(target));
    }
    void render(uint32_t first, uint32_t end) {
        const test::CoverageJob<kIds> job = {
            {.picture = picture.view, .settings = {.max_depth = 0}, .film = film.view(), .layers = {}},
            coverage->elements().data()};
        test::CoverageRounds<kIds>(queue, kMatteWidth * kMatteHeight).render(job, picture.tracer, first, end);
        film.set_samples({film.part().is_empty() ? first : film.part().samples.first, end});
    }
    std::vector<std::vector<std::byte>> bytes() const {
        std::vector<std::vector<std::byte>> all;
        for (const auto& target : film.targets()) all.push_back(target->bytes());
        return all;
    }

    Queue& queue;
    test::PictureOnDevice picture;
    Film film;
    const test::CoverageTarget<kIds>* coverage;
};

/// Renders samples [0, 3) and [3, 8) on two devices. Each film, restored from its bytes and added to the other, has
/// the bytes of the whole film.
template <uint32_t kIds>
void check_parts(const PreparedScene& prepared) {
    Queue cpu = Queue::make_cpu(), queue = test::requested_queue();
    Matte<kIds> whole(cpu, prepared), first(queue, prepared), second(cpu, prepared), again(queue, prepared);
    whole.render(0, kMatteSamples);
    first.render(0, 3);
    second.render(3, 5);
    second.render(5, kMatteSamples);
    CHECK(first.bytes() != whole.bytes());
    for (std::size_t i = 0; i < again.film.targets().size(); ++i) again.film.targets()[i]->set_bytes(second.bytes()[i]);
    again.film.set_part(second.film.part());
    again.film.add(first.film);
    CHECK(again.bytes() == whole.bytes());
    first.film.add(second.film);
    CHECK(first.bytes() == whole.bytes());
    first.film.clear();
    CHECK(first.bytes() == Matte<kIds>(cpu, prepared).bytes());
}

} // namespace

TEST_CASE("a film target defined by a test ranks the objects in each pixel, and its parts add up to the byte") {
    Messages messages;
    const Scene scene = striped_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    Matte<6> matte(queue, prepared);
    matte.render(0, kMatteSamples);
    const Image picture = matte.film.picture(true);
    const std::vector<PixelIds> first_ids = matte.film.ids();
    const FilmLayer layer = matte.film.layers().back();
    REQUIRE(layer.name == "coverage");
    uint32_t shared = 0;
    for (uint32_t pixel = 0; pixel < kMatteWidth * kMatteHeight; ++pixel) {
        const float* const ranks = &layer.image.pixels[12 * std::size_t(pixel)];
        float of_color[3] = {}, covered = 0, last = 1;
        bool has_first = first_ids[pixel].instance == kNoHit;
        uint32_t count = 0;
        for (; count < 6 && ranks[2 * count + 1] > 0; ++count) {
            const auto id = static_cast<uint32_t>(ranks[2 * count]);
            const float share = ranks[2 * count + 1]; // the values are eighths, so sums are exact
            REQUIRE(share <= last);
            last = share;
            of_color[id % 3] += share, covered += share;
            has_first = has_first || id == first_ids[pixel].instance;
        }
        shared += count > 2 ? 1 : 0;
        CHECK(has_first);
        const float* const means = &picture.pixels[4 * std::size_t(pixel)];
        CHECK(means[3] == covered);
        for (int c = 0; c < 3; ++c) CHECK(means[c] == of_color[c]);
    }
    CHECK(shared > 5);

    check_parts<6>(prepared);
    check_parts<2>(prepared); // pixels with more ids than fit
}
