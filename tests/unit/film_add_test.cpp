// Sums of films, and results computed on a film's device. With --device cuda the GPU renders, too.

#include <stdexcept>

#include <doctest/doctest.h>

#include "image/tone_map_image.h"
#include "render/film.h"
#include "render/noisy_frame.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr uint32_t kAovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
constexpr uint32_t kWidth = 17, kHeight = 9, kAddedSamples = 6;

/// Adds one arbitrary sample to every pixel of a film in the CPU's memory. Some samples are not finite, and some miss
/// the scene.
void take_sample(const FilmView& view, uint32_t sample) {
    test::Random random(100 + sample);
    for (uint32_t pixel = 0; pixel < kWidth * kHeight; ++pixel) {
        const Vec3 light = random.point(-0.1f, pixel % 5 == 0 ? 40.0f : 1.0f);
        add_radiance(view, pixel, {light.x, pixel == 3 ? kInfinity : light.y, light.z});
        const bool is_hit = random.below(3) != 0 && pixel % 11 != 0;
        if (sample == 0) view.ids[pixel] = is_hit ? PixelIds{pixel, pixel + 1, 7} : PixelIds{kNoHit, kNoHit, kNoHit};
        if (!is_hit) continue;
        add_channel(view, pixel, kFilmHits, 1);
        for (uint32_t c = kFilmColorChannels; c < view.channels; ++c) add_channel(view, pixel, c, random.within(-2, 2));
    }
}

void take_samples(Film& film, SampleRange samples) {
    for (uint32_t sample = samples.first; sample < samples.end; ++sample) take_sample(film.view(), sample);
    film.set_samples(samples);
}

void check_equal(const Film& a, const Film& b) {
    for (const bool transparent : {false, true}) {
        CHECK(a.picture(transparent).pixels == b.picture(transparent).pixels);
    }
    const std::vector<FilmLayer> layers_a = a.layers(), layers_b = b.layers();
    REQUIRE(layers_a.size() == 4);
    REQUIRE(layers_b.size() == 4);
    for (std::size_t i = 0; i < 4; ++i) CHECK(layers_a[i].image.pixels == layers_b[i].image.pixels);
    const std::vector<PixelIds> ids_a = a.ids(), ids_b = b.ids();
    REQUIRE(ids_a.size() == ids_b.size());
    for (std::size_t i = 0; i < ids_a.size(); ++i) {
        CHECK(ids_a[i].instance == ids_b[i].instance);
        CHECK(ids_a[i].primitive == ids_b[i].primitive);
        CHECK(ids_a[i].material == ids_b[i].material);
    }
    CHECK(a.invalid_samples() == b.invalid_samples());
}

} // namespace

TEST_CASE("films of parts of the samples add up to the film of all samples on any device") {
    Queue cpu = Queue::make_cpu(), other_cpu = Queue::make_cpu(), requested = test::requested_queue();
    Film whole(cpu, kWidth, kHeight, kAovs);
    take_samples(whole, {0, kAddedSamples});
    CHECK(whole.invalid_samples() == kAddedSamples);
    for (const uint32_t with_first : {0u, 1u}) { // the part that holds sample 0
        CAPTURE(with_first);
        Film parts[2] = {Film(cpu, kWidth, kHeight, kAovs), Film(other_cpu, kWidth, kHeight, kAovs)};
        take_samples(parts[with_first], {0, 2});
        take_samples(parts[1 - with_first], {2, kAddedSamples});
        Film sum(requested, kWidth, kHeight, kAovs);
        sum.add(parts[0]);
        sum.add(parts[1]);
        check_equal(sum, whole);
        parts[1].add(parts[0]); // between two queues
        check_equal(parts[1], whole);
        Film same_queue(other_cpu, kWidth, kHeight, kAovs);
        same_queue.add(parts[1]);
        check_equal(same_queue, whole);
        Film back(cpu, kWidth, kHeight, kAovs); // from the device
        back.add(sum);
        check_equal(back, whole);
    }
}

TEST_CASE("a film is restored from the bytes of its targets on any device") {
    Queue cpu = Queue::make_cpu(), requested = test::requested_queue();
    Film whole(cpu, kWidth, kHeight, kAovs), part(cpu, kWidth, kHeight, kAovs), other(cpu, kWidth, kHeight, kAovs);
    take_samples(whole, {0, kAddedSamples});
    take_samples(part, {0, 2});
    take_samples(other, {2, kAddedSamples});
    Film again(requested, kWidth, kHeight, kAovs);
    REQUIRE(again.targets().size() == 3);
    for (std::size_t i = 0; i < again.targets().size(); ++i) {
        again.targets()[i]->set_bytes(part.targets()[i]->bytes());
        CHECK(again.targets()[i]->bytes() == part.targets()[i]->bytes());
        CHECK_THROWS_AS(again.targets()[i]->set_bytes({}), std::logic_error);
    }
    again.set_part(part.part());
    again.add(other);
    check_equal(again, whole);
}

namespace {

/// Counts of a test, which are a kind of target that the film does not know.
class TallyTarget : public ElementTarget<uint64_t, AddCounts, 0> {
public:
    using ElementTarget::ElementTarget;
    void show(FilmView&) const override {}
    void count(uint64_t more) {
        std::vector<uint64_t> counts = elements().download();
        for (uint64_t& c : counts) c += more;
        set_bytes(std::as_bytes(std::span<const uint64_t>(counts)));
    }
};

TallyTarget& counts_of(const Film& film) { return dynamic_cast<TallyTarget&>(*film.targets().back()); }

} // namespace

TEST_CASE("targets given to a film are added and cleared with its own, and those of another kind are refused") {
    Queue cpu = Queue::make_cpu(), requested = test::requested_queue();
    const auto with_counts = [](Queue& queue, std::size_t count, const char* name) {
        Film film(queue, kWidth, kHeight, 0);
        film.hold(std::make_unique<TallyTarget>(queue, count, name));
        return film;
    };
    Film a = with_counts(requested, 5, "counts");
    const Film b = with_counts(cpu, 5, "counts");
    counts_of(a).count(3), counts_of(b).count(4);
    a.add(b);
    CHECK(counts_of(a).elements().download() == std::vector<uint64_t>(5, 7));
    CHECK_THROWS_AS(a.add(with_counts(cpu, 4, "counts")), std::logic_error);
    CHECK_THROWS_AS(a.add(with_counts(cpu, 5, "other counts")), std::logic_error);
    CHECK_THROWS_AS(a.add(Film(cpu, kWidth, kHeight, 0)), std::logic_error);
    Film other_window = with_counts(cpu, 5, "counts");
    other_window.set_window({.picture_width = 100, .x = 3, .y = 2, .width = kWidth, .height = kHeight});
    CHECK_THROWS_AS(a.add(other_window), std::logic_error);
    CHECK_THROWS_AS(a.set_window({.picture_width = kWidth, .x = 1, .width = kWidth, .height = kHeight}),
                    std::logic_error);
    CHECK(counts_of(a).elements().download() == std::vector<uint64_t>(5, 7)); // unchanged
    a.clear();
    CHECK(counts_of(a).elements().download() == std::vector<uint64_t>(5, 0));
}

TEST_CASE("all films of a session have its additional targets, including films of passes that can be interrupted") {
    Queue cpu = Queue::make_cpu(); // a GPU's passes are short
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    RenderSettings settings;
    settings.width = kWidth, settings.height = kHeight;
    settings.pass_samples = 1;
    Session session(cpu, prepare_scene(scene, {}, messages), test::mixed_scene_camera(), settings);
    session.set_targets([&](Film& film) { film.hold(std::make_unique<TallyTarget>(cpu, 5, "counts")); });
    session.interrupt_passes(true);
    for (const uint32_t width : {kWidth, kWidth + 1}) {
        settings.width = width;
        session.set_settings(settings);
        CHECK(session.render(1) == 1);
        CHECK(counts_of(session.film()).elements().download() == std::vector<uint64_t>(5, 0));
        counts_of(session.film()).count(3);
        CHECK(session.render(2) == 2); // adds films of one pass each
        CHECK(counts_of(session.film()).elements().download() == std::vector<uint64_t>(5, 3));
    }
}

TEST_CASE("a film of another size or of other layers is refused") {
    Queue queue = Queue::make_cpu();
    Film film(queue, kWidth, kHeight, kAovDepth);
    CHECK_THROWS_AS(film.add(Film(queue, kWidth, kHeight, kAovAlbedo)), std::logic_error);
    CHECK_THROWS_AS(film.add(Film(queue, kWidth + 1, kHeight, kAovDepth)), std::logic_error);
    CHECK_THROWS_AS(film.add(Film(queue, kWidth, kHeight + 1, kAovDepth)), std::logic_error);
}

TEST_CASE("the displayed film has the bytes of its picture tone-mapped on the host") {
    Queue cpu = Queue::make_cpu(), requested = test::requested_queue();
    Film film(cpu, kWidth, kHeight, kAovs);
    take_samples(film, {0, kAddedSamples});
    Film on_device(requested, kWidth, kHeight, kAovs);
    on_device.add(film);
    for (const ToneMap kind : {ToneMap::Srgb, ToneMap::Agx, ToneMap::Aces, ToneMap::Neutral}) {
        for (const float stops : {0.0f, -2.5f, 1.3f}) {
            for (const bool transparent : {false, true}) {
                CAPTURE(name_of(kind));
                CAPTURE(stops);
                CAPTURE(transparent);
                const Rgba8Image host = tone_map_image(film.picture(transparent), kind, stops);
                on_device.display(kind, stops, transparent);
                const Rgba8Image shown = on_device.displayed();
                CHECK(shown.width == kWidth);
                CHECK(shown.height == kHeight);
                CHECK(shown.pixels == host.pixels);
            }
        }
    }
    film.display(ToneMap::Srgb, 0, true);
    const Rgba8Image with_alpha = film.displayed();
    film.display(ToneMap::Srgb, 0, false);
    CHECK(film.displayed().pixels != with_alpha.pixels);
}

TEST_CASE("a film reports its samples and rows and refuses others that do not follow them") {
    Queue queue = Queue::make_cpu();
    const auto film_of = [&](FilmPart part) {
        Film film(queue, kWidth, kHeight, 0);
        film.set_part(part);
        return film;
    };
    const auto sum_of = [&](FilmPart a, FilmPart b) {
        Film film = film_of(a);
        film.add(film_of(b));
        return film.part();
    };
    CHECK(sum_of({}, {0, 9, {4, 6}}) == FilmPart{0, 9, {4, 6}});
    CHECK(sum_of({0, 9, {4, 6}}, {}) == FilmPart{0, 9, {4, 6}});
    CHECK(sum_of({0, 9, {4, 6}}, {0, 9, {6, 7}}) == FilmPart{0, 9, {4, 7}});
    CHECK(sum_of({0, 9, {4, 6}}, {0, 9, {0, 4}}) == FilmPart{0, 9, {0, 6}});
    CHECK(sum_of({5, 9, {0, 4}}, {0, 5, {0, 4}}) == FilmPart{0, 9, {0, 4}});
    CHECK_THROWS_AS(sum_of({0, 9, {4, 6}}, {0, 9, {5, 7}}), std::logic_error); // one part is added twice
    CHECK_THROWS_AS(sum_of({0, 9, {4, 6}}, {0, 9, {7, 8}}), std::logic_error); // samples between them are missing
    CHECK_THROWS_AS(sum_of({0, 5, {0, 4}}, {5, 9, {0, 5}}), std::logic_error); // more samples of some rows
    CHECK_THROWS_AS(sum_of({0, 5, {0, 4}}, {4, 9, {0, 4}}), std::logic_error);
    Film film = film_of({0, 9, {0, 4}});
    film.clear();
    CHECK(film.part().is_empty());
}

TEST_CASE("frames split into pixels on either device are merged") {
    Queue cpu = Queue::make_cpu(), requested = test::requested_queue();
    for (const bool splits_light : {false, true}) {
        NoisyFrame whole(cpu, kWidth, kHeight, splits_light), upper(cpu, kWidth, kHeight, splits_light);
        NoisyFrame lower(cpu, kWidth, kHeight, splits_light), both(requested, kWidth, kHeight, splits_light);
        for (NoisyFrame* frame : {&whole, &upper, &lower}) frame->clear();
        both.clear();
        const auto take = [&](const NoisyFrame& frame, uint32_t pixel) {
            test::Random random(pixel);
            const NoisyFrameView& view = frame.view();
            for (Float4* array : {view.emission, view.hit, view.normal, view.albedo, view.gloss}) {
                array[pixel] = {random.within(0, 1), random.within(0, 1), random.within(0, 1), random.within(0, 1)};
            }
            const float red = pixel % 7 == 0 ? kInfinity : random.within(0, 1);
            store_sample(frame.film_view(), pixel, {red, 1, 2}, {0.5f, 1, 1});
        };
        for (uint32_t pixel = 0; pixel < kWidth * kHeight; ++pixel) {
            take(whole, pixel);
            take(pixel < 4 * kWidth ? upper : lower, pixel);
        }
        both.add(lower);
        both.add(upper);
        CHECK(both.bytes() == whole.bytes());
        CHECK(both.invalid_samples() == whole.invalid_samples());
        CHECK(whole.invalid_samples() > 0);
        CHECK_THROWS_AS(both.add(NoisyFrame(cpu, kWidth + 1, kHeight, splits_light)), std::logic_error);
        CHECK_THROWS_AS(both.add(NoisyFrame(cpu, kWidth, kHeight, !splits_light)), std::logic_error);
        CHECK_THROWS_AS(both.set_bytes({}), std::logic_error);
    }
}

TEST_CASE("elements from another device or from bytes pass through one buffer per target") {
    constexpr uint32_t kSide = 1500; // 9 million sums, of which 2^20 are copied at once
    Queue cpu = Queue::make_cpu(), other_cpu = Queue::make_cpu();
    Film from(other_cpu, kSide, kSide, 0), added(cpu, kSide, kSide, 0), restored(cpu, kSide, kSide, 0);
    for (uint32_t pixel = 0; pixel < kSide * kSide; pixel += 997) {
        add_radiance(from.view(), pixel, {1, static_cast<float>(pixel), -0.5f});
    }
    from.set_samples({0, 1});
    uint64_t allocations = cpu.allocation_count();
    added.add(from);
    CHECK(cpu.allocation_count() == allocations + from.targets().size());
    for (std::size_t i = 0; i < from.targets().size(); ++i) {
        const std::vector<std::byte> bytes = from.targets()[i]->bytes();
        CHECK(added.targets()[i]->bytes() == bytes);
        allocations = cpu.allocation_count();
        restored.targets()[i]->set_bytes(bytes);
        CHECK(cpu.allocation_count() == allocations + 1);
        CHECK(restored.targets()[i]->bytes() == bytes);
    }
}
