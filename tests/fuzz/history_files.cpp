// Fuzz target of histories of frames (session/film_file/history_file.h). An input is taken for such a file whose
// checksums are made right. It is refused by an Error, or it is a history, after which a frame is rendered. Numbers of
// that history are then replaced by others, as a forger would: the frame is refused or rendered. Under AddressSanitizer
// an index that leads beyond the scene's arrays is found.

#include <array>
#include <optional>
#include <random>

#include "base/error.h"
#include "formats/read_scene.h"
#include "session/film_file/history_file.h"
#include "session/session.h"
#include "tests/fuzz/block_files.h"
#include "tests/fuzz/fuzz_target.h"

namespace pertev {
namespace {

constexpr uint32_t kKinds = 4, kFrames = 2;

/// Kinds of sequences, which differ in what a frame leaves.
struct Kind {
    ReconstructionSettings reconstruction;
    RestirSettings restir;
};

Kind kind_number(uint32_t number) {
    constexpr RestirLight kLights[kKinds] = {RestirLight::Off, RestirLight::Direct, RestirLight::Indirect,
                                             RestirLight::Indirect};
    Kind kind;
    kind.restir.light = kLights[number % kKinds];
    if (number % kKinds == 3) kind.reconstruction.resolution_scale = 0.5f;
    return kind;
}

DecidingSettings settings_of(uint32_t kind) { return {{"seed", "0"}, {"kind", fmt::format("{}", kind % kKinds)}}; }

/// A scene with lights of all kinds.
const PreparedScene& prepared() {
    static Scene scene;
    static const PreparedScene made = [] {
        Messages messages;
        scene = read_scene("cornell-box", {}, messages);
        scene.lights.push_back({.position = {0.278f, 0.3f, 0.2f}, .intensity = {0.1f, 0.1f, 0.1f}});
        scene.environment = Environment{.image = {4, 2, 3, std::vector<float>(24, 0.2f)}};
        return prepare_scene(scene, {}, messages);
    }();
    return made;
}

/// The sequence of a kind.
Session& session_of(uint32_t kind) {
    Queue& queue = cpu(); // first, so that it outlives them
    static std::array<std::optional<Session>, kKinds> sessions;
    std::optional<Session>& session = sessions[kind % kKinds];
    if (session) return *session;
    RenderSettings settings;
    settings.width = 8, settings.height = 6;
    settings.path.max_depth = 2;
    return session.emplace(queue, prepared(), prepared().scene->cameras.front(), settings);
}

/// Renders the frame after that of the history. Returns whether the history was taken.
bool goes_on(uint32_t kind, FrameHistory history) {
    Session& session = session_of(kind);
    history.camera = session.camera();
    const Kind of = kind_number(kind);
    session.frames().restore(std::move(history), session.settings(), nobody());
    try {
        require(session.render_frame(kFrames, of.reconstruction, of.restir, nobody()));
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        return false;
    }
    return true;
}

/// Replaces some words of the arrays, most of which are those that name instances, triangles and lights.
void forge(std::mt19937_64& random, FrameHistory& history) {
    constexpr uint32_t kWords[] = {0,           1,           7,           100,         0x7fffffffu, 0x80000000u,
                                   0xfffffffdu, 0xfffffffeu, 0xffffffffu, 0x7fc00000u, 0x7f800000u, 0x3f800000u};
    for (int changes = 0; changes < 8; ++changes) {
        std::vector<std::byte>& array = history.arrays[random() % history.arrays.size()];
        if (array.size() < sizeof(uint32_t)) continue;
        const uint32_t word = kWords[random() % std::size(kWords)];
        std::memcpy(&array[random() % (array.size() / sizeof word) * sizeof word], &word, sizeof word);
    }
}

std::optional<KeptFrame> read_history(const Bytes& bytes, uint32_t kind) {
    const FileInMemory file(bytes);
    try {
        return HistoryFile(file.name(), settings_of(kind)).read(nobody());
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        return std::nullopt;
    }
}

} // namespace

Bytes history_seed(uint32_t number) {
    static std::array<Bytes, kKinds> made;
    Bytes& seed = made[number % kKinds];
    if (!seed.empty()) return seed;
    Session& session = session_of(number);
    const Kind kind = kind_number(number);
    session.frames().cut();
    for (uint32_t k = 0; k < kFrames; ++k) require(session.render_frame(k, kind.reconstruction, kind.restir, nobody()));
    seed = history_file_bytes(settings_of(number), kFrames - 1, session.frames().history());
    return seed;
}

bool read_history_input(std::span<const std::byte> input) {
    bool is_read = false;
    Bytes bytes(input.begin(), input.end());
    repair(kHistoryFile, bytes);
    Hasher hasher;
    hasher.add(input);
    std::mt19937_64 random(hasher.result().low);
    for (uint32_t kind = 0; kind < kKinds; ++kind) {
        const std::optional<KeptFrame> kept = read_history(bytes, kind);
        if (!kept) continue;
        is_read = true;
        const Bytes again = history_file_bytes(settings_of(kind), kept->frame, kept->history);
        const std::optional<KeptFrame> same = read_history(again, kind);
        require(same.has_value() && same->frame == kept->frame && same->history.arrays == kept->history.arrays);
        if (!goes_on(kind, kept->history)) continue;
        FrameHistory forged = kept->history;
        forge(random, forged);
        goes_on(kind, std::move(forged));
    }
    return is_read;
}

} // namespace pertev
