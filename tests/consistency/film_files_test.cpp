// Parts of a picture that are written as film files and merged in any order have the bytes of the film of one run, for
// any device and integrator. Parts of different pictures are refused.

#include <algorithm>
#include <cmath>
#include <cstring>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "image/picture_hash.h"
#include "render/light_paths/light_path_layers.h"
#include "render/sample_layers/matte_names.h"
#include "session/film_file/merge_films.h"
#include "session/film_render.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

using Files = std::vector<std::string>;

/// Renders parts of a picture whose emitter is too bright for a film, so that there are invalid samples.
class Renders {
public:
    Scene scene = test::make_mixed_scene();
    RenderSettings settings;
    PictureOptions options;

    Renders() : folder_(test::scratch_folder()) {
        scene.materials[5].emission = grey(0x1p41f);
        settings.width = 32, settings.height = 20, settings.samples = 5;
    }

    /// Renders on the requested device.
    std::unique_ptr<FilmRender> film(SampleRange range) {
        if (!pictures_) {
            Messages messages;
            prepared_ = prepare_scene(scene, {}, messages);
            scene_.set(prepared_, settings);
            pictures_ = std::make_unique<PictureRenderer>(scene_);
        }
        auto film = std::make_unique<FilmRender>(*pictures_, test::mixed_scene_camera(), settings);
        REQUIRE(film->render(range) == range.count());
        return film;
    }

    /// Returns the name of the film file of these samples.
    std::string file(SampleRange range) {
        const auto rendered = film(range);
        PictureRecord record;
        record.scene.scene = "mixed";
        record.scene.instances = {"first", "second"};
        record.camera.camera = test::mixed_scene_camera();
        record.settings = settings;
        record.settings.first_sample = range.first;
        record.display = Display{ToneMap::Aces, -0.0f, FalseColors{"luminance", "cd/m2", 683.1f, 0.1f, 1e5f}};
        options.render.samples = settings.samples;
        const Film& film = rendered->film();
        const PictureFacts facts = facts_of(record, film.ids());
        const Files names = {folder_ / fmt::format("{}-{}-{}.pvf", ++files_, range.first, range.end)};
        const auto written =
            write_film_files(names, film_header(options, record, facts, rendered->stats(), film), film);
        REQUIRE(written.size() == 1);
        REQUIRE(written[0].failure == "");
        return names[0];
    }

    Queue queue = test::requested_queue();

private:
    std::filesystem::path folder_;
    PreparedScene prepared_;
    DeviceScene scene_{queue};
    std::unique_ptr<PictureRenderer> pictures_;
    int files_ = 0;
};

std::vector<std::vector<std::byte>> bytes_of(const Film& film) {
    std::vector<std::vector<std::byte>> all;
    for (const auto& target : film.targets()) all.push_back(target->bytes());
    return all;
}

Film merged(const Files& files, bool is_partial = false) {
    static Queue cpu = Queue::make_cpu();
    return FilmMerge(files, is_partial).film(cpu, nobody());
}

std::string merge_refusal(const Files& files, bool is_partial = false) {
    return test::bad_input_message([&] { FilmMerge(files, is_partial); });
}

void check_parts(Renders& renders, std::size_t targets) {
    const auto whole = renders.film({0, 5});
    const auto bytes = bytes_of(whole->film());
    CHECK(bytes.size() == targets);
    Files parts = {renders.file({0, 1}), renders.file({1, 1}), renders.file({1, 3}), renders.file({3, 5})};
    std::ranges::sort(parts);
    do {
        const Film film = merged(parts);
        CHECK(film.part() == whole->film().part());
        CHECK(bytes_of(film) == bytes);
    } while (std::ranges::next_permutation(parts).found);
    CHECK(bytes_of(merged({renders.file({0, 5})})) == bytes);
    const FilmMerge merge(parts, false);
    static Queue cpu = Queue::make_cpu();
    Film film = merge.film(cpu, nobody());
    const RenderResult result = result_of(merge.header(), film, cpu);
    CHECK(picture_hash(result.picture) == picture_hash(whole->picture()));
    CHECK(result.samples == 5);
    CHECK(result.invalid_samples == whole->film().invalid_samples());
    CHECK(result.rays.total() == whole->rays().total());
    CHECK(result.layers.size() == whole->layers().size());
}

} // namespace

TEST_CASE("merged parts by path have the bytes of one run, with layers, light paths and ids") {
    Renders renders;
    renders.settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
    renders.settings.light_paths = std::make_shared<const LightPathLayers>(
        bind_to_scene({parse_light_path("sky=L<'environment'>.*E"), parse_light_path("once=L.E")}, renders.scene));
    check_parts(renders, 3);
    CHECK(renders.film({0, 5})->film().invalid_samples() > 0);
}

TEST_CASE("merged parts have the bytes of one run with layers at the centres of pixels and alpha") {
    Renders renders;
    renders.settings.aovs = kAovNormal | kAovIds;
    renders.settings.layers_at = LayersAt::Centre;
    renders.settings.transparent = true;
    check_parts(renders, 4);
}

TEST_CASE("merged parts by other integrators have the bytes of one run") {
    for (const IntegratorKind kind :
         {IntegratorKind::Bidirectional, IntegratorKind::PhotonMap, IntegratorKind::Light, IntegratorKind::Whitted}) {
        CAPTURE(static_cast<int>(kind));
        Renders renders;
        renders.settings.integrator = kind;
        check_parts(renders, 2);
    }
}

namespace {

/// Renders the whole picture, and merges parts [first row, end row, first sample, end sample).
void check_rows(Renders& renders, const std::vector<FilmPart>& parts) {
    const SampleRange all = {0, renders.settings.samples};
    const auto whole = renders.film(all);
    Files files;
    for (const FilmPart& part : parts) {
        renders.settings.first_row = part.first_row, renders.settings.end_row = part.end_row;
        files.push_back(renders.file(part.samples));
        CHECK(FilmFileReader(files.back()).header().part() == part);
    }
    renders.settings.first_row = renders.settings.end_row = 0;
    std::ranges::reverse(files);
    const FilmMerge merge(files, false);
    static Queue cpu = Queue::make_cpu();
    const Film film = merge.film(cpu, nobody());
    CHECK(film.part() == whole->film().part());
    CHECK(bytes_of(film) == bytes_of(whole->film()));
    const ExrMetadata known = FilmFileReader(renders.file(all)).header().facts.origin;
    CHECK(merge.header().facts.origin == known);
    if (!renders.settings.is_denoised()) return;
    Film sums = merge.film(cpu, nobody());
    const RenderResult result = result_of(merge.header(), sums, cpu);
    const Image expected = whole->denoised().value();
    CHECK(result.denoised.value().pixels == expected.pixels);
    CHECK(result.picture.pixels != expected.pixels);
}

const std::vector<FilmPart> kBands = {{0, 7, {0, 5}}, {7, 8, {0, 5}}, {8, 20, {0, 5}}},
                            kBandsOfSamples = {{0, 7, {0, 2}}, {0, 7, {2, 5}}, {7, 20, {0, 4}}, {7, 20, {4, 5}}};

} // namespace

TEST_CASE("merged parts by rows, or by rows and samples, have the bytes of one run") {
    for (const auto& parts : {kBands, kBandsOfSamples}) {
        Renders renders;
        renders.settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
        renders.settings.light_paths =
            std::make_shared<const LightPathLayers>(bind_to_scene({parse_light_path("once=L.E")}, renders.scene));
        check_rows(renders, parts);
        Renders at_centres;
        at_centres.settings.aovs = kAovAlbedo | kAovDepth | kAovDistance | kAovIds;
        at_centres.settings.layers_at = LayersAt::Centre;
        check_rows(at_centres, parts);
    }
    for (const IntegratorKind kind : {IntegratorKind::PhotonMap, IntegratorKind::Whitted, IntegratorKind::Raster,
                                      IntegratorKind::IrradianceCache, IntegratorKind::Reyes}) {
        CAPTURE(static_cast<int>(kind));
        Renders renders;
        renders.settings.integrator = kind;
        if (kind == IntegratorKind::PhotonMap) renders.scene.materials[5].emission = grey(0x1p127f); // invalid photons
        check_rows(renders, kBandsOfSamples);
    }
}

TEST_CASE("merged parts by samples, by rows or by both are denoised to the bytes of one run") {
    Renders renders;
    renders.settings.denoise = Denoise::Svgf;
    renders.settings.aovs = kAovAlbedo | kAovPosition | kAovIds;
    check_rows(renders, kBands);
    // More samples than every part takes the features of.
    renders.settings.samples = 20;
    check_rows(renders, {{0, 7, {3, 20}}, {0, 7, {0, 3}}, {7, 20, {0, 17}}, {7, 20, {17, 19}}, {7, 20, {19, 20}}});
}

TEST_CASE("a film that no denoiser has gathered for is not denoised") {
    Renders renders;
    renders.settings.denoise = Denoise::Svgf;
    Queue cpu = Queue::make_cpu();
    const FilmHeader without = FilmFileReader(renders.file({0, 1})).header();
    Film empty = without.make_film(cpu);
    empty.set_part(without.part());
    CHECK(!test::bad_input_message([&] { result_of(without, empty, cpu); }).empty());
}

TEST_CASE("a part of rows restarts a film of others, and its picture is black elsewhere") {
    Renders renders;
    const auto whole = renders.film({0, 2});
    const Image picture = whole->picture();
    RenderSettings part = renders.settings;
    part.first_row = 5, part.end_row = 9;
    CHECK(whole->set_settings(part));
    REQUIRE(whole->render({0, 2}) == 2);
    const Image rows = whole->picture();
    const std::size_t row = std::size_t(3) * rows.width;
    for (std::size_t i = 0; i < rows.pixels.size(); ++i) {
        const bool is_inside = i >= 5 * row && i < 9 * row;
        REQUIRE(rows.pixels[i] == (is_inside ? picture.pixels[i] : 0.0f));
    }
}

TEST_CASE("overlaps and gaps of rows are refused by name") {
    Renders renders;
    const auto band = [&](uint32_t first, uint32_t end, SampleRange range) {
        renders.settings.first_row = first, renders.settings.end_row = end;
        return renders.file(range);
    };
    const std::string top = band(0, 9, {0, 5}), bottom = band(9, 20, {0, 5}), over = band(8, 12, {4, 5}),
                      late = band(9, 20, {3, 5});
    CHECK(merge_refusal({bottom, top}) == "no error");
    CHECK(merge_refusal({top, bottom, over}).find("samples 4 to 4 of rows 8 to 8") != std::string::npos);
    CHECK(merge_refusal({top}).find("samples 0 to 4 of rows 9 to 19") != std::string::npos);
    CHECK(merge_refusal({top, late}).find("samples 0 to 2 of rows 9 to 19") != std::string::npos);
    for (const Files& some : {Files{bottom}, Files{top}, Files{top, late}})
        CHECK(merge_refusal(some, true) == "no error");
    CHECK(merge_refusal({late, over}, true).find("samples 4 to 4 of rows 9 to 11") != std::string::npos);
}

namespace {

/// Rows 0 to 6 have all samples, 7 to 11 the first two, 12 to 14 none, and the last ones the first three.
const std::vector<FilmPart> kUneven = {{0, 7, {0, 2}}, {0, 7, {2, 5}}, {7, 12, {0, 2}}, {15, 20, {0, 3}}},
                            kOthers = {{7, 12, {2, 5}}, {12, 15, {0, 4}}, {12, 15, {4, 5}}, {15, 20, {3, 5}}};

Files files_of_parts(Renders& renders, const std::vector<FilmPart>& parts) {
    Files files;
    for (const FilmPart& part : parts) {
        renders.settings.first_row = part.first_row, renders.settings.end_row = part.end_row;
        files.push_back(renders.file(part.samples));
    }
    renders.settings.first_row = renders.settings.end_row = 0;
    return files;
}

std::string file_of_merged(const Files& files) {
    const FilmMerge merge(files, true);
    static Queue cpu = Queue::make_cpu();
    const Files to = {test::scratch_folder() / "merged.pvf"};
    REQUIRE(write_film_files(to, merge.header(), merge.film(cpu, nobody()))[0].failure == "");
    return to[0];
}

/// Checks that rows [first, end) of an image have the bytes of those of another, or are 0 if that is null.
void check_image_rows(const Image& image, uint32_t first, uint32_t end, const Image* like) {
    const std::size_t row = std::size_t(image.width) * image.channels;
    REQUIRE(image.pixels.size() == row * image.height);
    const std::vector<float> none(row * image.height);
    const float* const expected = like != nullptr ? like->pixels.data() : none.data();
    CHECK(std::memcmp(&image.pixels[first * row], expected + first * row, (end - first) * row * sizeof(float)) == 0);
}

/// Checks rows [first, end) of a result against those of a render with their number of samples.
void check_rows_of(const RenderResult& result, uint32_t first, uint32_t end, Renders& renders, uint32_t samples) {
    CAPTURE(first);
    const auto like = renders.film({0, samples});
    const RenderResult known = like->result();
    check_image_rows(result.picture, first, end, samples > 0 ? &known.picture : nullptr);
    REQUIRE(result.layers.size() == known.layers.size());
    for (std::size_t i = 0; i < known.layers.size(); ++i) {
        CAPTURE(known.layers[i].name);
        check_image_rows(result.layers[i].image, first, end, samples > 0 ? &known.layers[i].image : nullptr);
    }
    const std::size_t width = result.picture.width;
    for (std::size_t i = first * width; !result.ids.empty() && i < end * width; ++i)
        REQUIRE(result.ids[i].instance == (samples > 0 ? known.ids[i].instance : kNoHit));
}

/// Merges some parts, then the result with the others.
void check_uneven(Renders& renders) {
    Files files = files_of_parts(renders, kUneven), others = files_of_parts(renders, kOthers);
    static Queue cpu = Queue::make_cpu();
    const FilmMerge merge(files, true);
    CHECK((merge.samples().least() == 0 && merge.samples().most() == 5));
    CHECK(merge.header().parts == std::vector<FilmPart>{{0, 7, {0, 5}}, {7, 12, {0, 2}}, {15, 20, {0, 3}}});
    Film film = merge.film(cpu, nobody());
    const RenderResult result = result_of(merge.header(), film, cpu);
    CHECK(result.samples == 5);
    if (!renders.settings.is_denoised()) {
        check_rows_of(result, 0, 7, renders, 5);
        check_rows_of(result, 7, 12, renders, 2);
        check_rows_of(result, 12, 15, renders, 0);
        check_rows_of(result, 15, 20, renders, 3);
    } else {
        const Image& image = result.denoised.value();
        check_image_rows(image, 12, 15, nullptr);
        CHECK(std::ranges::all_of(image.pixels, [](float x) { return std::isfinite(x); }));
        CHECK(std::ranges::count(image.pixels, 0.0f) < static_cast<std::ptrdiff_t>(image.pixels.size() / 2));
    }
    const std::string some = file_of_merged(files), others_of_all = file_of_merged(others);
    CHECK(FilmFileReader(some).header().parts == merge.header().parts);
    std::ranges::reverse(files);
    CHECK(bytes_of(merged({file_of_merged(files)}, true)) == bytes_of(merged({some}, true)));
    CHECK(merge_refusal({some}).find("samples 2 to 4 of rows 7 to 11") != std::string::npos);
    CHECK(merge_refusal({others[0], some, files[0]}, true).find("samples 0 to 2 of rows 15 to 19") !=
          std::string::npos);
    others.push_back(some);
    files.push_back(others_of_all);
    const auto whole = renders.film({0, 5});
    for (const Files& all : {others, files, Files{others_of_all, some}}) {
        Film again = FilmMerge(all, false).film(cpu, nobody());
        CHECK(bytes_of(again) == bytes_of(whole->film()));
        if (whole->denoised()) {
            const RenderResult of_all = result_of(FilmMerge(all, false).header(), again, cpu);
            CHECK(of_all.denoised.value().pixels == whole->denoised().value().pixels);
        }
    }
}

} // namespace

TEST_CASE("each row of a film whose rows have unequal samples has the bytes of a render with as many") {
    Renders renders;
    renders.settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovIds;
    renders.settings.light_paths =
        std::make_shared<const LightPathLayers>(bind_to_scene({parse_light_path("once=L.E")}, renders.scene));
    renders.settings.sample_layers = kFirstHitLayers | kLayerCount | kLayerVariance;
    renders.settings.mattes = std::make_shared<const MatteNames>(renders.scene);
    renders.settings.transparent = true;
    check_uneven(renders);
    Renders at_centres;
    at_centres.settings.aovs = kAovAlbedo | kAovDepth | kAovIds;
    at_centres.settings.layers_at = LayersAt::Centre;
    check_uneven(at_centres);
}

TEST_CASE("a film whose rows have unequal samples is denoised, and black where there are none") {
    Renders renders;
    renders.settings.denoise = Denoise::Svgf;
    check_uneven(renders);
}

TEST_CASE("a merged film has the facts of the part with the first samples, and all samples may be written again") {
    Renders renders;
    renders.settings.aovs = kAovIds;
    const Files parts = {renders.file({3, 5}), renders.file({0, 3})};
    const FilmMerge merge(parts, false);
    const FilmHeader first = FilmFileReader(parts[1]).header();
    CHECK(merge.header().facts.origin == first.facts.origin);
    CHECK(merge.header().facts.settings == first.facts.settings);
    CHECK(std::ranges::find(first.facts.origin, "pertev.instances", &ExrMetadata::value_type::first) !=
          first.facts.origin.end());
    const Display& display = first.facts.display.value();
    CHECK(display.tone_map == ToneMap::Aces);
    CHECK(std::signbit(display.exposure_stops));
    CHECK(display.false_colors.value().factor == 683.1f);
    CHECK(display.false_colors.value().unit == "cd/m2");
    const Film film = merged(parts);
    const Files again = {test::scratch_folder() / "again.pvf"};
    write_film_files(again, merge.header(), film);
    CHECK(bytes_of(merged(again)) == bytes_of(film));
    CHECK(FilmFileReader(again[0]).header().settings == first.settings);
}

TEST_CASE("overlaps, gaps and parts of other pictures are refused by name") {
    Renders renders;
    const std::string a = renders.file({0, 2}), b = renders.file({2, 3}), c = renders.file({3, 5}),
                      over = renders.file({1, 4}), none = renders.file({2, 2});
    CHECK(merge_refusal({a, b, c}) == "no error");
    CHECK(merge_refusal({c, none, b, a}) == "no error");
    const auto error = test::thrown_error([&] { FilmMerge(Files{a, over, c}, true); });
    CHECK(test::is_at(error, ErrorCode::BadInput, FileLocation{over}));
    CHECK(test::says(error, "samples 1 to 1"));
    CHECK(test::says(error, a));
    CHECK(merge_refusal({a, a}).find("samples 0 to 1") != std::string::npos);
    CHECK(merge_refusal({c, over}, true).find("samples 3 to 3") != std::string::npos);
    CHECK(merge_refusal({a, c}).find("samples 2 to 2 of rows 0 to 19") != std::string::npos);
    CHECK(merge_refusal({b, c}).find("samples 0 to 1") != std::string::npos);
    CHECK(merge_refusal({a, b}).find("samples 3 to 4") != std::string::npos);
    CHECK(merge_refusal({none}, true) != "no error");
    for (const Files& files : {Files{a, c}, Files{b, c}, Files{a, b}}) CHECK(merge_refusal(files, true) == "no error");
    CHECK(FilmMerge(Files{c, a}, true).header().parts == std::vector<FilmPart>{{0, 20, {0, 2}}, {0, 20, {3, 5}}});
    CHECK(FilmMerge(Files{c, b}, true).header().part() == FilmPart{0, 20, {2, 5}});
    const Film film = merged({c, a}, true);
    CHECK((film.row_samples().least() == 4 && film.row_samples().most() == 4));

    renders.settings.path.max_depth = 3;
    const std::string shallow = renders.file({2, 5});
    const std::string deeper = fmt::format("`max_depth` is \"{}\" there, not \"3\"", RenderSettings().path.max_depth);
    CHECK(merge_refusal({a, shallow}).find(deeper) != std::string::npos);
    renders.settings.path.max_depth = RenderSettings().path.max_depth;
    renders.settings.aovs = kAovAlbedo;
    CHECK(merge_refusal({a, renders.file({2, 5})}) != "no error");
}

TEST_CASE("samples can be added to a finished picture") {
    Renders renders;
    const std::string finished = renders.file({0, 5});
    renders.settings.samples = 8;
    const auto whole = renders.film({0, 8});
    const Film more = merged({renders.file({5, 8}), finished});
    CHECK(bytes_of(more) == bytes_of(whole->film()));
    CHECK(more.part() == whole->film().part());
}
