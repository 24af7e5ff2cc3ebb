// pertev bench sequence: measures error and flicker of a sequence's frames against references of many samples, and the
// same for each frame's samples denoised by `denoise`.

#include <algorithm>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/bench_parts.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/report_radiosity.h"
#include "base/limits.h"
#include "image/flip.h"
#include "image/metrics.h"
#include "image/picture_hash.h"
#include "image/tone_map_image.h"
#include "session/devices/session_on_devices.h"
#include "session/opening/strictness.h"
#include "session/pictures/prepare_render.h"
#include "settings/parse_values.h"
#include "settings/settings_file.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

struct SequenceFlags {
    RenderFlags render;
    uint32_t reference = 0;
};

/// Scores of one way of making frames, over a sequence.
struct Score {
    double flip = 0, flip_of_first = 0, flip_of_last = 0; // HDR-FLIP against the references: mean, of single frames
    double flicker = 0; // mean absolute change of the shown error from frame to frame, in [0, 1]
    uint32_t frames = 0;
    std::vector<float> error; // error of the previous frame, as a display shows it

    /// Adds a frame: its HDR-FLIP, and the frame and its reference after tone mapping.
    void add(double hdr_flip, const Rgba8Image& shown, const Rgba8Image& shown_reference) {
        flip_of_last = hdr_flip;
        if (frames == 0) flip_of_first = flip_of_last;
        flip += flip_of_last;
        std::vector<float> now(shown.pixels.size());
        double change = 0;
        for (std::size_t i = 0; i < now.size(); ++i) {
            now[i] = (static_cast<float>(shown.pixels[i]) - static_cast<float>(shown_reference.pixels[i])) / 255.0f;
            if (frames > 0) change += static_cast<double>(std::abs(now[i] - error[i]));
        }
        // Three of four numbers are colours; alpha has no error.
        flicker += change / (static_cast<double>(now.size()) * 0.75);
        error = std::move(now);
        ++frames;
    }
    double mean_flip() const { return flip / std::max(frames, 1u); }
    double mean_flicker() const { return frames > 1 ? flicker / (frames - 1) : 0.0; }
};

struct Scores {
    Score ours, sample;
    std::optional<Score> denoised;
    double noise = 0; // HDR-FLIP of one half of the first reference's samples against the other
    // Scores of half of each reference's samples against all samples, which differ by as much as the reference does
    // from the truth. The flicker of these halves is the part that noise of the references adds to the other scores.
    Score half;
    std::string denoiser; // RenderResult::denoiser
};

/// Samples of each pixel as `pertev render` takes them, others for each seed.
RenderResult samples_of(Session& session, const RenderSettings& settings, uint32_t seed, uint32_t samples,
                        Denoise denoise = Denoise::None) {
    RenderSettings some = settings;
    some.samples = samples;
    some.denoise = denoise;
    some.path.seed = seed;
    return session.render_separately(session.camera(), some);
}

constexpr const char* kWays[] = {"samples", "frames", "denoised"};

Scores measure(RenderSetup& ready, Session& session, PictureRecord& record, const SequenceFlags& flags, float exposure,
               ToneMap tone_map, BenchReport& report, Reporter& reporter) {
    const ReconstructionSettings settings = flags.render.reconstruction.used();
    const RestirSettings restir = flags.render.reconstruction.sharing;
    Scores scores;
    const Denoise denoise = ready.settings.denoise;
    if (denoise != Denoise::None) scores.denoised.emplace();
    const FrameCamera camera = {*ready.camera, ready.sequence};
    for (uint32_t number = 0; number < ready.sequence.count(); ++number) {
        throw_if_interrupted();
        const uint32_t frame = ready.sequence.first + number;
        reporter.progress((number + 1.0) / ready.sequence.count(),
                          fmt::format("frame {} of {}", number + 1, ready.sequence.count()));
        seek_frame(frame, camera, *ready.moving, session, record, reporter);
        session.render_frame(FrameRange::sample_of(frame), settings, restir);
        const std::optional<Image> instead = session.frame().shown_instead();
        const Image ours = instead ? *instead : session.frame().picture();
        const auto shown = [&](const Image& picture) { return tone_map_image(picture, tone_map, exposure); };
        if (flags.reference == 0) continue;
        const RenderResult sample = samples_of(session, ready.settings, number, 1, denoise);
        scores.denoiser = sample.denoiser;
        const uint32_t half = (flags.reference + 1) / 2;
        const Image first = samples_of(session, ready.settings, 0x40000000u + number, half).picture,
                    second = samples_of(session, ready.settings, 0x80000000u + number, half).picture,
                    reference = mean_of(first, second);
        std::vector<const Image*> pictures = {&sample.picture, &ours};
        if (sample.denoised) pictures.push_back(&*sample.denoised);
        const std::vector<FlipResult> flips = hdr_flips(pictures, reference);
        const Rgba8Image shown_reference = shown(reference);
        Score* const of[] = {&scores.sample, &scores.ours, scores.denoised ? &*scores.denoised : nullptr};
        for (std::size_t i = 0; i < pictures.size(); ++i) {
            of[i]->add(flips[i].mean, shown(*pictures[i]), shown_reference);
            if (number % 15 == 14) {
                report.add_picture({.group = fmt::format("Frame {}", frame),
                                    .title = kWays[i],
                                    .caption = fmt::format("HDR-FLIP {:.4f}", flips[i].mean),
                                    .image = shown(*pictures[i])});
            }
        }
        if (number % 15 == 14) {
            report.add_picture({fmt::format("Frame {}", frame), "reference", "", shown_reference});
        }
        scores.half.add(0, shown(first), shown_reference);
        if (number == 0) scores.noise = hdr_flip(first, second).mean;
    }
    return scores;
}

Fields fields_of(const Score& score) {
    return {{"hdr_flip", "HDR-FLIP", score.mean_flip(), "", "{:.4f}"},
            {"hdr_flip_first", "of the first frame", score.flip_of_first, "", "{:.4f}"},
            {"hdr_flip_last", "of the last frame", score.flip_of_last, "", "{:.4f}"},
            {"flicker", "flicker", score.mean_flicker(), "", "{:.5f}"}};
}

int bench_sequence(SequenceFlags& flags) {
    Reporter reporter(flags.render.report);
    flags.render.settings.read(flags.render, reporter);
    refuse(!frame_range(flags.render), {"frames", "", "the frames are missing; set `frames` or `turntable`"});
    const std::string denoise(name_of(flags.render.render.denoise));
    refuse(flags.reference == 0 && flags.render.render.is_denoised(),
           {"denoise", denoise, "the reference is missing; add --reference SPP"});
    const std::unique_ptr<RenderSetup> ready =
        prepare_render(flags.render, kBenchSequence, reporter, report_solving(reporter));
    const UseThreads threads(ready->queue->threads());
    reporter.report_messages();
    listen_for_interrupt();
    BenchReport report(reporter, flags.render.report, *ready->queue, "Frames of a moving picture");
    PictureRecord record = picture_record(flags.render, *ready, reporter.messages());
    SessionOnDevices opened(ready->queues, ready->prepared(), record.camera.camera, ready->settings, {.frames = true});
    Session& session = opened.session();
    const ToneMap tone_map = ToneMap::Agx;
    const float exposure = session.meter(tone_map);
    session.cut();
    reporter.set_work("rendering");
    const Scores scores = measure(*ready, session, record, flags, exposure, tone_map, report, reporter);
    reporter.end_progress();
    const auto score = [](const Score& of) { return ResultCell::raw(json_of("", fields_of(of))); };
    report.add_alone("sequence_errors",
                     {{"scene", "scene", flags.render.scene.scene},
                      {"device", "device", ready->device_name()},
                      {"width", "width", ready->settings.width},
                      {"height", "height", ready->settings.height},
                      {"frames", "frames", ready->sequence.count()},
                      {"max_depth", "max depth", ready->settings.path.max_depth},
                      {"reconstruction", "",
                       ResultCell::raw(reconstruction_json(flags.render.reconstruction, ready->settings.frame_depth))},
                      {"reference_spp", "samples of the references", flags.reference},
                      {"reference_noise", "HDR-FLIP of their halves", scores.noise, "", "{:.4f}"},
                      {"reference_flicker", "flicker of their own noise", scores.half.mean_flicker(), "", "{:.5f}"},
                      {"ours", "", score(scores.ours)},
                      {"sample", "", score(scores.sample)},
                      {"denoised", "", scores.denoised ? score(*scores.denoised) : ResultCell()},
                      {"denoiser", "denoiser", scores.denoiser.empty() ? denoise : scores.denoiser},
                      {"last_frame", "last frame", picture_hash(session.frame().picture()).hex()}});
    if (flags.reference > 0) {
        ResultTable table;
        const auto add = [&](const char* name, const Score& of) {
            const Fields fields = Fields{{"way", "frames by", name}} + fields_of(of);
            report.keep("scores", fields);
            table.add(fields);
        };
        add(kWays[1], scores.ours);
        if (scores.denoised) add(kWays[2], *scores.denoised);
        add(kWays[0], scores.sample);
        reporter.answer(text_of(table));
    }
    report.write();
    return 0;
}

} // namespace

void add_bench_sequence_command(CLI::App& bench, int& status) {
    const auto flags = std::make_shared<SequenceFlags>();
    CLI::App& verb = add_bench_verb(
        bench, "sequence", "Compare frames of a sequence with pictures of many samples, and with denoised samples",
        [flags, &status] { status = bench_sequence(*flags); });
    flags->render.size = PictureSize{1280, 720};
    flags->render.render.path.max_depth = 4;
    add_scene_name(verb, flags->render.scene);
    verb.add_option("--reference", flags->reference,
                    "compares each frame with a picture of this many samples by\nHDR-FLIP; flicker is the error's "
                    "mean change between frames")
        ->type_name("SPP")
        ->check(whole_between(2, kMaxSamplesPerPixel));
    add_bench_report_flags(verb, flags->render.report);
    flags->render.settings.add(verb, kBenchSequence, flags->render);
}

} // namespace pertev
