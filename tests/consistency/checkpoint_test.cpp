// A film that resumes from a checkpoint has the bytes of an uninterrupted one, and a checkpoint of another picture is
// refused. tests/robust/cli_checkpoint_test.py kills renders.

#include <doctest/doctest.h>

#include "session/film_file/checkpoint.h"
#include "session/film_file/film_file.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

/// Makes films of one picture, each with its own memory, on the requested device.
class Interrupted {
public:
    explicit Interrupted(RenderSettings of_picture) : settings_(std::move(of_picture)) {
        settings_.width = 24, settings_.height = 18, settings_.samples = 6;
        prepared_ = prepare_scene(scene_, {}, messages_);
        on_device_.set(prepared_, settings_);
        header.settings = {{"version", "1.0.0 abc"}, {"seed", "0"}};
        header.width = settings_.width, header.height = settings_.height;
        header.aovs = settings_.aovs, header.layers_at = settings_.layers_at, header.denoise = settings_.denoise;
        header.parts = {{0, settings_.height, settings_.range()}}, header.spp = settings_.samples;
    }
    FilmRender film() { return {pictures_, test::mixed_scene_camera(), settings_}; }
    Checkpoint checkpoint() const { return {file, header}; }
    const Messages& messages() const { return messages_; }
    /// Returns why a render refuses the checkpoint.
    std::optional<Error> refusal() {
        return test::thrown_error([&] {
            FilmRender render = film();
            checkpoint().restore(render, messages_);
        });
    }

    FilmHeader header;
    std::string file = test::scratch_folder() / "c.pvf";

private:
    Scene scene_ = test::make_mixed_scene();
    RenderSettings settings_;
    Messages messages_;
    Queue queue_ = test::requested_queue();
    PreparedScene prepared_;
    DeviceScene on_device_{queue_};
    PictureRenderer pictures_{on_device_};
};

std::vector<std::vector<std::byte>> bytes_of_film(const Film& film) {
    std::vector<std::vector<std::byte>> all;
    for (const auto& target : film.targets()) all.push_back(target->bytes());
    return all;
}

void check_resumed(const RenderSettings& settings) {
    Interrupted work(settings);
    FilmRender whole = work.film();
    REQUIRE(whole.render({0, 6}) == 6);
    {
        FilmRender first = work.film();
        REQUIRE(first.render({0, 2}) == 2);
        work.checkpoint().write(first, {});
    }
    for (const uint32_t end : {5u, 6u}) {
        FilmRender next = work.film();
        Checkpoint checkpoint = work.checkpoint();
        Messages messages;
        checkpoint.restore(next, messages);
        CHECK(messages.all().size() == 1);
        const uint32_t begin = next.samples().end;
        CHECK(begin == (end == 5 ? 2 : 5));
        REQUIRE(next.render({begin, end}) == end - begin);
        checkpoint.write(next, {});
        if (end < 6) continue;
        CHECK(bytes_of_film(next.film()) == bytes_of_film(whole.film()));
        CHECK(next.film().part() == whole.film().part());
        CHECK(next.rays().total() == whole.rays().total());
        if (settings.is_denoised()) CHECK(next.denoised().value().pixels == whole.denoised().value().pixels);
    }
}

} // namespace

TEST_CASE("a film that resumes from checkpoints has the bytes of one run") {
    RenderSettings settings;
    settings.aovs = kAovAlbedo | kAovDepth | kAovIds;
    check_resumed(settings);
    settings.layers_at = LayersAt::Centre;
    check_resumed(settings);
    settings = {};
    settings.integrator = IntegratorKind::PhotonMap;
    check_resumed(settings);
    settings = {};
    settings.denoise = Denoise::Svgf;
    check_resumed(settings);
}

TEST_CASE("a checkpoint keeps the previous generation unless it is damaged") {
    Interrupted work({});
    FilmRender film = work.film();
    Checkpoint checkpoint = work.checkpoint();
    const auto samples_in = [](const std::string& file) {
        return FilmFileReader(file).header().part().samples.count();
    };
    for (const uint32_t end : {1u, 2u, 3u}) {
        REQUIRE(film.render({end - 1, end}) == 1);
        checkpoint.write(film, {});
        CHECK(samples_in(work.file) == end);
        if (end > 1) CHECK(samples_in(work.file + ".previous") == end - 1);
    }
    fs::resize_file(work.file, fs::file_size(work.file) - 1);
    FilmRender next = work.film();
    Checkpoint again = work.checkpoint();
    Messages messages;
    again.restore(next, messages);
    CHECK(next.samples().end == 2);
    CHECK(messages.all().front().is_warning);
    REQUIRE(next.render({2, 4}) == 2);
    again.write(next, {});
    CHECK(samples_in(work.file) == 4);
    CHECK(samples_in(work.file + ".previous") == 2);
}

TEST_CASE("two damaged generations are refused together, each with its fault") {
    Interrupted work({});
    FilmRender film = work.film();
    Checkpoint checkpoint = work.checkpoint();
    for (const uint32_t end : {1u, 2u}) {
        REQUIRE(film.render({end - 1, end}) == 1);
        checkpoint.write(film, {});
    }
    const std::string previous = work.file + ".previous";
    fs::resize_file(work.file, fs::file_size(work.file) - 1);
    fs::resize_file(previous, 3);
    const auto error = work.refusal();
    REQUIRE(error);
    CHECK(error->code() == ErrorCode::BadInput);
    CHECK(error->location() == FileLocation{work.file});
    for (const std::string& part : {std::string("truncated"), previous, std::string("this is not a film file")}) {
        CAPTURE(error->what());
        CHECK(test::says(error, part));
    }
    fs::remove(previous);
    const auto alone = work.refusal();
    REQUIRE(alone);
    CHECK(!test::says(alone, previous));
    // A missing one is no reason to start again silently.
    fs::rename(work.file, previous);
    Messages messages;
    FilmRender next = work.film();
    work.checkpoint().restore(next, messages);
    CHECK(next.samples().count() == 0);
    REQUIRE(messages.all().size() == 1);
    CHECK(messages.all().front().is_warning);
    CHECK(messages.all().front().remark.location == FileLocation{previous});
}

TEST_CASE("a checkpoint of another version, setting, part or size is refused with the difference") {
    Interrupted work({});
    FilmRender film = work.film();
    REQUIRE(film.render({0, 4}) == 4);
    work.checkpoint().write(film, {});
    CHECK(!work.refusal());
    const FilmHeader header = work.header;
    const auto says = [&](const std::string& text) {
        const auto error = work.refusal();
        work.header = header;
        REQUIRE(error);
        CHECK(error->code() == ErrorCode::BadInput);
        CHECK(error->setting() == "checkpoint");
        CHECK(error->location() == FileLocation{work.file});
        CAPTURE(error->what());
        CHECK(test::says(error, text));
    };
    work.header.settings[0].second = "1.1.0 abc";
    says("version is \"1.0.0 abc\" there, not \"1.1.0 abc\"");
    work.header.settings[1].second = "7";
    says("`seed` is \"0\" there, not \"7\"");
    work.header.aovs = kAovDepth;
    says("the film is");
    work.header.parts[0].samples = {2, 6};
    says("begin with number 0, not 2");
    work.header.parts[0].samples = {0, 3};
    says("up to 4, more than the 3");
    CHECK(!work.refusal());
}

TEST_CASE("a render can begin from a checkpoint without samples") {
    Interrupted work({});
    FilmRender none = work.film();
    work.checkpoint().write(none, {});
    FilmRender film = work.film();
    work.checkpoint().restore(film, nobody());
    CHECK(film.samples().count() == 0);
    CHECK(film.render({0, 1}) == 1);
}
