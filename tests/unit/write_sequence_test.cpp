// Frames of a sequence rendered by a program: the record in each file, and continued sequences.

#include "session/pictures/write_sequence.h"

#include <set>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "image/read_exr.h"
#include "session/pictures/frame_settings.h"
#include "session/pictures/prepare_render.h"
#include "settings/setting_table.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

using Values = std::vector<std::pair<const char*, std::string>>;

void set(PictureOptions& options, const Values& values) {
    for (const auto& [name, text] : values) set_value(options, *find_setting(name), {&text, 1});
}

PictureOptions small_turntable() {
    PictureOptions options;
    options.scene.scene = "cornell-box";
    set(options, {{"turntable", "4"}, {"size", "8x6"}, {"spp", "1"}, {"device", "cpu"}, {"max_depth", "2"}});
    return options;
}

/// A sink that ends a sequence after some frames, or in the middle of one.
struct Caller final : Messages {
    uint32_t most = 100, most_begun = 100;
    std::vector<FrameReport> frames;
    std::set<std::string> begun; // frames in real time
    void progress(const Progress& now) override {
        if (now.doing.starts_with("frame ")) begun.insert(now.doing);
    }
    bool should_stop() override { return frames.size() >= most || begun.size() > most_begun; }
};

SequenceTally write_frames(PictureOptions options, Caller& caller, const std::string& output) {
    const std::unique_ptr<RenderSetup> ready = prepare_render(options, kRender, caller);
    PictureRecord record = picture_record(options, *ready, caller.messages());
    Session session(*ready->queue, ready->prepared(), record.camera.camera, ready->settings);
    SequenceTally tally;
    const FrameCamera camera = {*ready->camera, ready->sequence};
    write_sequence(
        {camera, *ready->moving, record, session}, options, {output}, caller,
        [&](const FrameReport& made) { caller.frames.push_back(made); }, tally);
    return tally;
}

} // namespace

TEST_CASE("an ended sequence continues where it stopped, and is refused with other settings") {
    const std::string output = test::scratch_folder() / "f-#.exr";
    Caller ended;
    ended.most = 2;
    SequenceTally tally = write_frames(small_turntable(), ended, output);
    CHECK(tally.frames == 4);
    CHECK(tally.written == 2);
    CHECK(!tally.is_complete());
    REQUIRE(ended.frames.size() == 2);
    CHECK(ended.frames[0].hash != ended.frames[1].hash);
    CHECK(ended.frames[1].written.files.front().path == frame_file(output, 1));

    PictureOptions options = small_turntable();
    set(options, {{"continue", "true"}});
    Caller whole;
    tally = write_frames(options, whole, output);
    CHECK(tally.written == 2);
    CHECK(tally.kept == 2);
    CHECK(tally.is_complete());
    REQUIRE(whole.frames.size() == 4);
    CHECK(whole.frames[1].is_kept);
    CHECK(!whole.frames[2].is_kept);

    for (const Values& other :
         {Values{{"seed", "1"}}, {{"size", "6x8"}}, {{"aov", "depth"}}, {{"integrator", "light"}}}) {
        PictureOptions changed = options;
        set(changed, other);
        Caller refused;
        const auto error = test::thrown_error([&] { write_frames(changed, refused, output); });
        CHECK(test::is_about(error, ErrorCode::BadInput, "continue"));
        REQUIRE(error);
        CHECK(error->reason().find(fmt::format("`{}`", other.front().first)) != std::string::npos);
        CHECK(error->location()->pointer == "/settings");
    }
}

TEST_CASE("a sequence with a checkpoint that ends in the middle of a frame keeps its history") {
    const std::filesystem::path folder = test::scratch_folder();
    PictureOptions options = small_turntable();
    set(options, {{"real_time", "true"}});
    Caller whole, ended, later;
    CHECK(write_frames(options, whole, folder / "whole-#.exr").is_complete());
    set(options, {{"checkpoint", (folder / "c.pvf").string()}, {"continue", "true"}});
    ended.most_begun = 2;
    CHECK(write_frames(options, ended, folder / "f-#.exr").written == 3);
    const SequenceTally tally = write_frames(options, later, folder / "f-#.exr");
    CHECK(tally.kept == 3);
    CHECK(tally.again == 0);
    CHECK(tally.is_complete());
    REQUIRE(later.frames.size() == 4);
    CHECK(later.frames[3].hash == whole.frames[3].hash);
}

TEST_CASE("the settings of a frame reproduce it without its sequence") {
    PictureRecord record;
    record.settings.width = 8, record.settings.height = 6;
    const auto settings_of = [&](const Values& values, uint32_t frame) {
        PictureOptions options;
        set(options, values);
        const std::optional<FrameRange> sequence = frame_range(options);
        if (sequence) record.scene.time_s = sequence->time_of(frame);
        const std::string json = settings_of_frame(options, record, frame);
        return json.substr(json.find("\"settings\":"));
    };
    const auto has = [](const std::string& json, const std::string& part) {
        return json.find(part) != std::string::npos;
    };
    std::string json = settings_of({{"frames", "3-9"}, {"fps", "7"}}, 3);
    CHECK(has(json, R"("time":0.42857142857142855)"));
    CHECK(!has(json, R"("frames":)"));
    CHECK(!has(json, "fps"));
    CHECK(has(json, R"("size":"8x6")"));
    json = settings_of({{"frames", "3-9"}, {"fps", "7"}, {"turntable", "9"}}, 4);
    CHECK(has(json, R"("frames":"4-4")"));
    CHECK(has(json, R"("fps":7)"));
    json = settings_of({{"turntable", "9"}}, 4);
    CHECK(!has(json, R"("frames":)")); // the time is that of the scene at rest, which no frame has
    json = settings_of({{"time", "2"}}, 0);
    CHECK(has(json, R"("time":2)"));

    record.display = Display{.exposure_stops = 1.25f}; // the exposure is metered at the first frame
    CHECK(has(settings_of({{"frames", "3-9"}}, 4), R"("exposure":"1.25")"));
    CHECK(!has(settings_of({{"time", "2"}}, 0), "exposure"));
    record.frame = ReconstructedFrame();
    record.in_sequence = FrameInSequence{.number = 4, .cut = 3};
    json = settings_of({{"frames", "3-9"}, {"real_time", "true"}}, 4);
    CHECK(has(json, R"("frames":"3-4")")); // it depends on earlier frames
}
