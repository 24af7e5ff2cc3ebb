// A sequence in real time that goes on from its checkpoint, on the same devices or others, has the bytes of an
// uninterrupted one. tests/robust/cli_real_time_test.py kills sequences.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>

#include "base/read_file.h"
#include "image/picture_hash.h"
#include "restir/bounce_reservoir.h"
#include "scene/validate/validate.h"
#include "session/devices/frames_on_devices.h"
#include "session/film_file/history_file.h"
#include "session/moving_scene.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

/// A scene of which one thing moves, with lights and surfaces of many kinds.
Scene scene_of_kept() {
    Scene scene = test::make_mixed_scene();
    scene.nodes.resize(1);
    Instance& moving = scene.instances.back();
    moving.node = 0;
    moving.node_from_local = moving.world_from_local;
    scene.animations.emplace_back().channels.push_back(
        {0, AnimatedPart::Translation, Interpolation::Linear, {0, 2}, {0, 0, 0, 0.4f, 0.2f, 0}});
    Messages messages;
    validate(scene, "moving", messages);
    return scene;
}

struct KeptOptions {
    ReconstructionSettings reconstruction;
    RestirSettings restir;
    bool moves = true;
};

/// A sequence by one device or several.
class KeptSequence {
public:
    KeptSequence(std::size_t devices, const KeptOptions& options) : options_(options) {
        for (std::size_t i = 0; i < devices; ++i) {
            const bool is_gpu = test::cuda_requested() && static_cast<int>(i) < cuda_device_count();
            queues_.push_back(
                std::make_shared<Queue>(is_gpu ? Queue::make_cuda(static_cast<int>(i)) : Queue::make_cpu(Threads(1))));
        }
        settings_.width = 50, settings_.height = 38;
        settings_.path.max_depth = 3;
        if (devices > 1) together_.emplace(queues_, moving_.prepared());
        session_.emplace(*queues_.front(), moving_.prepared(), test::mixed_scene_camera(), settings_);
        if (together_) session_->pictures().share_frames(*together_);
    }
    void seek(uint32_t k) {
        const double time_s = options_.moves ? 0.2 * k : 0;
        if (const uint32_t parts = moving_.set_time(time_s, messages_))
            session_->update_scene(moving_.prepared(), parts);
        Camera camera = test::mixed_scene_camera();
        camera.world_from_camera.translation += (0.04f * static_cast<float>(k)) * column(camera.world_from_camera, 0);
        session_->set_camera(camera);
    }
    Hash128 render(uint32_t k) {
        seek(k);
        REQUIRE(session_->render_frame(k, options_.reconstruction, options_.restir, messages_));
        return picture_hash(session_->frame().picture());
    }
    FrameHistory history() { return session_->frames().history(); }
    /// Goes on after frame `k` of another sequence.
    void restore(uint32_t k, FrameHistory history) {
        seek(k);
        history.camera = session_->camera();
        session_->frames().restore(std::move(history), session_->settings(), messages_);
    }
    std::size_t devices() const { return together_ ? together_->devices() : 1; }
    std::size_t warnings() const {
        return static_cast<std::size_t>(std::ranges::count(messages_.all(), true, &Message::is_warning));
    }

private:
    KeptOptions options_;
    Messages messages_;
    MovingScene moving_{scene_of_kept(), 0.0, {}, messages_};
    RenderSettings settings_;
    std::vector<std::shared_ptr<Queue>> queues_;
    std::optional<FramesOnDevices> together_;
    std::optional<Session> session_;
};

/// Options that differ in what a frame leaves for the next one.
std::vector<KeptOptions> all_kept_options() {
    std::vector<KeptOptions> all(5);
    all[1].restir.light = RestirLight::Direct;
    all[2].restir.light = RestirLight::Indirect;
    all[3].reconstruction.resolution_scale = 0.5f;
    all[3].restir.light = RestirLight::Direct;
    all[4].moves = false;
    return all;
}

constexpr uint32_t kKeptFrame = 2, kFramesOfKept = 5; // the frame of the checkpoint, and all frames

} // namespace

TEST_CASE("a restored sequence has the bytes of an uninterrupted one, on the same devices and others") {
    for (const KeptOptions& options : all_kept_options()) {
        CAPTURE(static_cast<int>(options.restir.light));
        CAPTURE(options.reconstruction.resolution_scale);
        CAPTURE(options.moves);
        KeptSequence whole(1, options);
        std::vector<Hash128> expected;
        std::optional<FrameHistory> of_one;
        for (uint32_t k = 0; k < kFramesOfKept; ++k) {
            expected.push_back(whole.render(k));
            if (k == kKeptFrame) of_one = whole.history();
        }
        CHECK(of_one->has_light == options.moves);
        KeptSequence bands(2, options);
        for (uint32_t k = 0; k <= kKeptFrame; ++k) CHECK(bands.render(k) == expected[k]);
        const FrameHistory of_two = bands.history();
        CHECK(of_two.arrays == of_one->arrays);
        for (const std::size_t devices : {1u, 2u, 3u}) {
            CAPTURE(devices);
            KeptSequence later(devices, options);
            later.restore(kKeptFrame, of_two);
            for (uint32_t k = kKeptFrame + 1; k < kFramesOfKept; ++k) CHECK(later.render(k) == expected[k]);
            CHECK(later.devices() == devices);
            CHECK(later.warnings() == 0);
            later.restore(kKeptFrame, of_two); // in place of a history of its own
            CHECK(later.render(kKeptFrame + 1) == expected[kKeptFrame + 1]);
        }
    }
}

TEST_CASE("a history that does not fit is refused, and the next frame begins a sequence") {
    KeptSequence first(1, {});
    for (uint32_t k = 0; k <= kKeptFrame; ++k) first.render(k);
    const FrameHistory good = first.history();
    FrameHistory shorter = good, fewer = good, other = good;
    shorter.arrays.front().pop_back();
    fewer.arrays.pop_back();
    other.has_reservoirs = true;
    for (const FrameHistory& bad : {shorter, fewer, other}) {
        for (const std::size_t devices : {1u, 2u}) {
            KeptSequence sequence(devices, {}), fresh(1, {});
            sequence.restore(kKeptFrame, bad);
            const auto error = test::thrown_error([&] { sequence.render(kKeptFrame + 1); });
            REQUIRE(error.has_value());
            CHECK(error->code() == ErrorCode::BadInput);
            CHECK(sequence.render(kKeptFrame + 2) == fresh.render(kKeptFrame + 2));
        }
    }
}

TEST_CASE("a history that names what the scene lacks is refused, on each device") {
    KeptOptions options;
    options.restir.light = RestirLight::Indirect;
    KeptSequence first(1, options);
    for (uint32_t k = 0; k <= kKeptFrame; ++k) first.render(k);
    const FrameHistory good = first.history();
    // Behind the arrays of the reconstruction: reservoirs, hits, normals, bounces, then light, emission, hits and more
    // of the small picture.
    constexpr std::size_t kPixels = 50 * 38, kBounces = 3, kSmallHits = 6;
    REQUIRE(good.has_light);
    const auto is_bounces = [&](const auto& array) { return array.size() == kPixels * sizeof(BounceReservoir); };
    const auto bounces = std::ranges::find_if(good.arrays, is_bounces);
    REQUIRE(bounces != good.arrays.end());
    const auto lights = static_cast<std::size_t>(bounces - good.arrays.begin()) - kBounces;
    const auto forged = [&]<class Element>(std::size_t array, const auto& change, const Element&) {
        FrameHistory history = good;
        std::size_t changes = 0;
        for (std::size_t at = 0; at < history.arrays[array].size(); at += sizeof(Element)) {
            Element element;
            std::memcpy(&element, &history.arrays[array][at], sizeof element);
            if (!change(element)) continue;
            std::memcpy(&history.arrays[array][at], &element, sizeof element);
            ++changes;
        }
        CHECK(changes > 0);
        return history;
    };
    const auto change_light = [](uint32_t instance, uint32_t primitive) {
        return [=](LightReservoir& of) {
            const bool is_some = of.weight > 0 && of.point.is_there() && of.point.kind() == SourceKind::Triangle;
            if (is_some) of.point.instance = instance, of.point.index = primitive;
            return is_some;
        };
    };
    const auto change_bounce = [](uint32_t instance, uint32_t primitive) {
        return [=](BounceReservoir& of) {
            if (of.weight > 0) of.instance = instance, of.primitive = primitive;
            return of.weight > 0;
        };
    };
    const auto change_hit = [](uint32_t primitive) {
        return [=](Float4& hit) {
            const bool is_some = bits_of(hit.x) != kNoHit;
            if (is_some) hit.y = float_of(primitive);
            return is_some;
        };
    };
    constexpr uint32_t kFar = 1000000;
    std::vector<FrameHistory> bad;
    bad.push_back(forged(lights, change_light(kFar, 0), LightReservoir()));
    bad.push_back(forged(lights, change_light(0, kFar), LightReservoir()));
    bad.push_back(forged(lights + 1, change_hit(kFar), Float4()));
    bad.push_back(forged(lights + kBounces, change_bounce(kFar, 0), BounceReservoir()));
    bad.push_back(forged(lights + kBounces, change_bounce(kNoHit, 0), BounceReservoir()));
    bad.push_back(forged(lights + kBounces, change_bounce(0, kFar), BounceReservoir()));
    bad.push_back(forged(lights + kSmallHits, change_hit(kFar), Float4()));
    for (std::size_t i = 0; i < bad.size(); ++i) {
        CAPTURE(i);
        for (const std::size_t devices : {1u, 2u}) {
            KeptSequence sequence(devices, options);
            sequence.restore(kKeptFrame, bad[i]);
            const auto error = test::thrown_error([&] { sequence.render(kKeptFrame + 1); });
            REQUIRE(error.has_value());
            CHECK(error->code() == ErrorCode::BadInput);
        }
    }
    KeptSequence sequence(1, options); // a history that names nothing that is looked at is taken
    sequence.restore(kKeptFrame, forged(
                                     lights + kBounces,
                                     [](BounceReservoir& of) {
                                         if (of.weight > 0) return false;
                                         of.instance = kFar;
                                         return true;
                                     },
                                     BounceReservoir()));
    CHECK(sequence.render(kKeptFrame + 1) == first.render(kKeptFrame + 1));
}

namespace {

struct HistoryOnDisk {
    std::string file = test::scratch_folder() / "h.pvf";
    DecidingSettings settings = {{"version", "1.0.0 abc"}, {"seed", "0"}};
    FrameHistory history = {7, {}, true, false, {std::vector<std::byte>(400000), std::vector<std::byte>(16)}};
    Messages messages;

    HistoryOnDisk() {
        for (std::size_t i = 0; i < history.arrays[0].size(); ++i) history.arrays[0][i] = std::byte(i * i / 7);
    }
    HistoryFile kept() const { return {file, settings}; }
    std::size_t warnings() const {
        return static_cast<std::size_t>(std::ranges::count(messages.all(), true, &Message::is_warning));
    }
    void flip(std::size_t at) const {
        std::vector<std::byte> bytes = read_file(file);
        bytes.at(at) ^= std::byte(1);
        std::ofstream(file, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    }
};

} // namespace

TEST_CASE("a checkpoint of frames is read as it was written") {
    HistoryOnDisk disk;
    CHECK(!disk.kept().read(disk.messages));
    disk.kept().write(41, disk.history);
    const KeptFrame kept = disk.kept().read(disk.messages).value();
    CHECK(kept.frame == 41);
    CHECK(kept.history.number == 7);
    CHECK(kept.history.has_reservoirs);
    CHECK(!kept.history.has_light);
    CHECK(kept.history.arrays == disk.history.arrays);
    CHECK(!fs::exists(disk.file + ".previous"));
    disk.history.has_light = true;
    disk.kept().write(42, disk.history);
    CHECK(disk.kept().read(disk.messages).value().frame == 42);
    CHECK(disk.kept().read(disk.messages).value().history.has_light);
    CHECK(fs::exists(disk.file + ".previous"));
    CHECK(disk.warnings() == 0);
}

TEST_CASE("a damaged checkpoint of frames is found, and the generation before is used if it is whole") {
    HistoryOnDisk disk;
    disk.kept().write(1, disk.history);
    const std::size_t size = fs::file_size(disk.file);
    for (const std::size_t at : {std::size_t(3), std::size_t(9), std::size_t(40), size / 2, size - 1}) {
        CAPTURE(at);
        disk.kept().write(1, disk.history), disk.kept().write(2, disk.history);
        disk.flip(at);
        HistoryFile damaged = disk.kept();
        const std::size_t before = disk.warnings();
        CHECK(damaged.read(disk.messages).value().frame == 1);
        CHECK(disk.warnings() == before + 1);
        damaged.write(3, disk.history); // replaces the damaged one, and the generation before stays
        CHECK(disk.kept().read(disk.messages).value().frame == 3);
        disk.flip(at);
        CHECK(disk.kept().read(disk.messages).value().frame == 1);
        const std::vector<std::byte> damaged_too = read_file(disk.file);
        std::ofstream(disk.file + ".previous", std::ios::binary)
            .write(reinterpret_cast<const char*>(damaged_too.data()), std::streamsize(damaged_too.size()));
        CHECK(!disk.kept().read(disk.messages)); // both generations are named
        const std::string said = disk.messages.all().back().text;
        CHECK(said.find(disk.file + ":") != std::string::npos);
        CHECK(said.find(disk.file + ".previous") != std::string::npos);
        fs::remove(disk.file + ".previous");
        CHECK(!disk.kept().read(disk.messages));
    }
    disk.kept().write(1, disk.history);
    fs::resize_file(disk.file, size - 100);
    fs::remove(disk.file + ".previous");
    CHECK(!disk.kept().read(disk.messages));
}

TEST_CASE("a checkpoint of another sequence is refused with the difference") {
    HistoryOnDisk disk;
    disk.kept().write(1, disk.history);
    disk.settings[1].second = "4";
    const auto error = test::thrown_error([&] { disk.kept().read(disk.messages); });
    REQUIRE(error.has_value());
    CHECK(test::is_about(error, ErrorCode::BadInput, "checkpoint"));
    CHECK(std::string(error->what()).find("`seed`") != std::string::npos);
    CHECK(disk.warnings() == 0);
}
