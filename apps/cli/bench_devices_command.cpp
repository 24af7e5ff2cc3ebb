// pertev bench devices: times one picture of the record, a batch of pictures, and frames in real time, by one device,
// two, and so on to all that are named. From the picture's times it predicts those of more devices.

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/bench_parts.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/report_result.h"
#include "base/stopwatch.h"
#include "image/picture_hash.h"
#include "lab/record_scenes.h"
#include "lab/stored_figures.h"
#include "math/portable_math.h"
#include "session/devices/batch_on_devices.h"
#include "session/devices/device_names.h"
#include "session/devices/machine.h"
#include "session/devices/session_on_devices.h"
#include "settings/tracer_options.h"

namespace pertev {
namespace {

constexpr uint32_t kLongSamples = 8192; // half a minute on one GPU for the default job
constexpr uint32_t kShortSamples = 256;
constexpr uint32_t kFramesBefore = 4; // frames that take memory, warm up, and find the bands
constexpr uint32_t kDepthOfFrames = 4;

struct DevicesFlags {
    PictureFlags picture;
    std::string job = "S8";
    uint32_t runs = 5;
    uint32_t pictures = 0; // 0: by the device
    uint32_t frames = 60;
    std::vector<std::size_t> numbers; // numbers of devices to measure; empty: each
};

/// Times of some devices for a picture.
struct TimesTaken {
    RunTimes times;
    double sum_s = 0;    // median seconds after the last sample
    double upload_s = 0; // time of the slowest device
    std::string hash;
};

/// The picture to be timed.
struct PictureJob {
    const PreparedScene& prepared;
    const Camera& camera;
    const RenderSettings& settings;
};

/// Times a picture by the first `count` devices. One alone renders as it does without others.
TimesTaken time_devices(std::span<const std::shared_ptr<Queue>> queues, const PictureJob& job, uint32_t samples,
                        uint32_t runs) {
    SessionOnDevices opened(queues, job.prepared, job.camera, job.settings, {.pictures = true});
    Session& session = opened.session();
    RenderOnDevices* const together = opened.together();
    TimesTaken taken;
    std::vector<double> seconds, sums;
    for (uint32_t run = 0; run <= runs; ++run) { // the first one takes memory and warms up
        render_again(session, run == 0 ? std::min(samples, 64u) : samples);
        if (run == 0) continue;
        seconds.push_back(session.stats().render_seconds);
        if (together) sums.push_back(together->sum_seconds());
    }
    taken.times = summarize_runs(seconds);
    taken.upload_s = session.stats().upload_seconds;
    if (together) taken.upload_s = std::max(taken.upload_s, together->upload_seconds());
    if (together) taken.sum_s = summarize_runs(sums).median;
    taken.hash = picture_hash(session.picture()).hex();
    return taken;
}

void add_colors(Hasher& hasher, const BatchArrays& arrays, const RenderSettings& settings) {
    const std::vector<float> values = arrays.color.download();
    const std::size_t floats = std::size_t(settings.width) * settings.height * 3 * arrays.pictures;
    hasher.add(std::as_bytes(std::span(values).first(floats)));
}

/// Times the pictures of a batch by some devices. One alone renders as it does without others.
TimesTaken time_batch(std::span<const std::shared_ptr<Queue>> queues, const PictureJob& job, const CameraBatch& batch,
                      uint32_t runs) {
    const RenderSettings& settings = job.settings;
    Queue& queue = *queues.front();
    SessionOnDevices opened(queues, job.prepared, job.camera, settings, {.pictures = true});
    opened.share_pictures(false); // a batch is shared by pictures
    PictureRenderer& pictures = opened.session().pictures();
    RenderOnDevices* const together = opened.together();
    const std::size_t limit = batch_memory(queue, settings, {}).bytes;
    const uint32_t at_once = pictures_at_once(job.prepared, batch, settings, limit, queue.is_cuda());
    TimesTaken taken;
    BatchArrays arrays;
    std::vector<double> seconds;
    Hasher hasher;
    for (uint32_t run = 0; run <= runs; ++run) { // the first one takes memory and warms up; its hash counts
        const Stopwatch watch;
        InterruptSink sink;
        if (together) {
            render_batch(*together, pictures, batch, settings, at_once, arrays, sink);
            if (run == 0) add_colors(hasher, arrays, settings);
        } else {
            BatchRender render(pictures, batch, settings, at_once);
            while (render.next(arrays, sink)) {
                if (run == 0) add_colors(hasher, arrays, settings);
            }
        }
        queue.wait();
        throw_if_interrupted();
        if (run > 0) seconds.push_back(watch.seconds());
    }
    taken.times = summarize_runs(seconds);
    taken.hash = hasher.result().hex();
    return taken;
}

std::string names_of_some(std::span<const std::shared_ptr<Queue>> queues) {
    std::vector<std::string> names;
    for (const auto& queue : queues) names.push_back(queue->device_name());
    return text_of_devices(names);
}

/// Predicts the seconds of `count` devices if each loses as much as the measured ones, and films are added in turn.
double expected_seconds(std::size_t count, const TimesTaken& alone, const TimesTaken& most, std::size_t of_most) {
    const double all = static_cast<double>(of_most), n = static_cast<double>(count);
    const double loss = (most.times.median - most.sum_s) * all / alone.times.median;
    return alone.times.median * loss / n + most.sum_s * n / all;
}

/// Throws Error(DeviceFault) if the pictures are not those of one device.
void check_hash(const TimesTaken& taken, const TimesTaken& alone, const std::string& devices) {
    if (taken.hash == alone.hash) return;
    throw Error(ErrorCode::DeviceFault,
                fmt::format("the picture of {} is {} and not {}, that of one device", devices, taken.hash, alone.hash));
}

/// Returns the numbers of devices to be measured: 1 first, with which all others are compared. Throws Error(BadInput).
std::vector<std::size_t> numbers_measured(const DevicesFlags& flags, std::size_t devices) {
    std::vector<std::size_t> numbers = {1};
    for (std::size_t count = 2; flags.numbers.empty() && count <= devices; ++count) numbers.push_back(count);
    numbers.insert(numbers.end(), flags.numbers.begin(), flags.numbers.end());
    std::ranges::sort(numbers);
    numbers.erase(std::ranges::unique(numbers).begin(), numbers.end());
    if (numbers.back() <= devices) return numbers;
    throw Error(ErrorCode::BadInput, fmt::format("--numbers {}: there are {} devices", numbers.back(), devices));
}

/// Reports the times of a batch of small pictures by each number of devices.
void report_batches(const DevicesFlags& flags, std::span<const std::shared_ptr<Queue>> queues, const PictureJob& job,
                    const std::string& name, float scene_size, BenchReport& report) {
    RenderSettings settings = job.settings;
    settings.width = settings.height = 128, settings.samples = 16;
    const uint32_t pictures = flags.pictures > 0 ? flags.pictures : (queues.front()->is_cuda() ? 4096 : 32);
    const CameraBatch batch = cameras_about(job.camera, pictures, scene_size);
    TimesTaken alone;
    for (const std::size_t count : flags.numbers) {
        const auto some = queues.first(count);
        const TimesTaken taken = time_batch(some, {job.prepared, job.camera, settings}, batch, flags.runs);
        if (count == 1) alone = taken;
        check_hash(taken, alone, names_of_some(some));
        Fields fields = {{"job", "job", name},
                         {"devices", "devices", count},
                         {"device", "device", names_of_some(some)},
                         {"width", "width", settings.width},
                         {"height", "height", settings.height},
                         {"samples", "samples", settings.samples},
                         {"pictures", "pictures", pictures}};
        fields = fields + time_fields(taken.times);
        fields.push_back({"pictures_per_second", "pictures/s", pictures / taken.times.median, "", "{:.5g}"});
        fields.push_back({"ratio_to_one", "times one", alone.times.median / taken.times.median, "", "{:.3f}"});
        fields.push_back({"hash", "pictures", taken.hash});
        report.add("devices_cameras", fields);
    }
}

/// Times frames of a moving camera by some devices, each from its camera to the shown picture on the host.
TimesTaken time_frames(std::span<const std::shared_ptr<Queue>> queues, const PictureJob& job, uint32_t frames,
                       float scene_size, double& reconstruction_s, double& copy_s) {
    SessionOnDevices opened(queues, job.prepared, job.camera, job.settings, {.frames = true});
    Session& session = opened.session();
    std::vector<double> seconds, reconstructions, copies;
    for (uint32_t frame = 0; frame < frames + kFramesBefore; ++frame) {
        throw_if_interrupted();
        const float k = static_cast<float>(frame);
        const Stopwatch watch;
        session.set_camera(moved(job.camera, 0.35f * sin(k * 0.05f), {0, 0, -0.001f * scene_size * k}));
        session.render_frame(frame, {});
        session.frame().display(ToneMap::Agx, 0);
        if (frame < kFramesBefore) continue;
        seconds.push_back(watch.seconds());
        reconstructions.push_back(session.frame().seconds());
        copies.push_back(session.frame().copy_seconds());
    }
    reconstruction_s = summarize_runs(reconstructions).median;
    copy_s = summarize_runs(copies).median;
    TimesTaken taken;
    taken.times = summarize_runs(seconds);
    taken.hash = picture_hash(session.frame().picture()).hex();
    return taken;
}

/// Reports the times of frames in real time by each number of devices.
void report_frames(const DevicesFlags& flags, std::span<const std::shared_ptr<Queue>> queues, const PictureJob& job,
                   const std::string& name, float scene_size, BenchReport& report) {
    RenderSettings settings = job.settings;
    const bool on_cuda = queues.front()->is_cuda();
    settings.width = on_cuda ? 3840 : 192, settings.height = on_cuda ? 2160 : 108;
    settings.samples = 1;
    settings.path.max_depth = kDepthOfFrames;
    TimesTaken alone;
    for (const std::size_t count : flags.numbers) {
        const auto some = queues.first(count);
        double reconstruction_s = 0, copy_s = 0;
        const TimesTaken taken =
            time_frames(some, {job.prepared, job.camera, settings}, flags.frames, scene_size, reconstruction_s, copy_s);
        if (count == 1) alone = taken;
        check_hash(taken, alone, names_of_some(some));
        Fields fields = {{"job", "job", name},
                         {"devices", "devices", count},
                         {"device", "device", names_of_some(some)},
                         {"width", "width", settings.width},
                         {"height", "height", settings.height},
                         {"max_depth", "max depth", settings.path.max_depth}};
        fields = fields + time_fields(taken.times);
        fields.push_back({"frames_per_second", "frames/s", 1 / taken.times.median, "", "{:.1f}"});
        fields.push_back({"reconstruction_seconds", "reconstruction by the first", reconstruction_s, "s", "{:.6f}"});
        fields.push_back({"copy_seconds", "copy to the host", copy_s, "s", "{:.6f}"});
        fields.push_back({"ratio_to_one", "times one", alone.times.median / taken.times.median, "", "{:.3f}"});
        fields.push_back({"hash", "last frame", taken.hash});
        report.add("devices_frames", fields);
    }
}

int bench_devices(DevicesFlags& flags) {
    Reporter reporter(flags.picture.report);
    flags.picture.settings.read(flags.picture, reporter);
    const RecordJob& record = *find_named(the_record().jobs, flags.job);
    const std::string& file = flags.picture.scenes.front();
    RenderSettings settings = job_settings(record);
    if (const auto& size = flags.picture.size) settings.width = size->width, settings.height = size->height;
    settings.samples = flags.picture.is_given("spp") ? flags.picture.render.samples : kLongSamples;
    check_bench_scene(file);
    listen_for_interrupt();
    const Stopwatch watch;
    std::vector<std::shared_ptr<Queue>> queues;
    for (auto& queue : open_queues(flags.picture.machine, reporter)) queues.push_back(std::move(queue));
    const double start_s = watch.seconds();
    flags.numbers = numbers_measured(flags, queues.size());
    const std::size_t greatest = flags.numbers.back();
    const UseThreads threads(queues.front()->threads());
    settings.tracers = tracer_choice(flags.picture.tracer, queues.front()->is_cuda());
    BenchReport report(reporter, flags.picture.report, *queues.front(), "One picture by several devices");
    const Scene scene = make_job_scene(record, file, reporter);
    throw_if_interrupted();
    const PreparedScene prepared = prepare_scene(scene, trees_for(settings, *queues.front()), reporter);
    const Camera camera = job_camera(record, scene, aspect_of(settings.width, settings.height), reporter);
    reporter.report_messages();

    std::vector<uint32_t> jobs = {settings.samples};
    if (settings.samples > kShortSamples) jobs.push_back(kShortSamples);
    for (const uint32_t samples : jobs) {
        settings.samples = samples;
        TimesTaken alone, most;
        for (const std::size_t count : flags.numbers) {
            reporter.set_work(fmt::format("measuring {} samples by {} of {} devices", samples, count, queues.size()));
            const std::span some = std::span(queues).first(count);
            most = time_devices(some, {prepared, camera, settings}, samples, flags.runs);
            if (count == 1) alone = most;
            check_hash(most, alone, names_of_some(some));
            const double ratio = alone.times.median / most.times.median;
            Fields fields = {{"job", "job", record.name},
                             {"devices", "devices", count},
                             {"device", "device", names_of_some(some)},
                             {"width", "width", settings.width},
                             {"height", "height", settings.height},
                             {"samples", "samples", samples}};
            fields = fields + time_fields(most.times);
            fields.push_back({"ratio_to_one", "times one", ratio, "", "{:.3f}"});
            fields.push_back({"share_of_ideal", "of ideal", ratio / static_cast<double>(count), "", "{:.3f}"});
            fields.push_back({"sum_seconds", "films", most.sum_s, "s", "{:.4f}"});
            fields.push_back({"upload_seconds", "upload", most.upload_s, "s", "{:.3f}"});
            fields.push_back({"start_seconds", "start of all", start_s, "s", "{:.3f}"});
            fields.push_back({"peak_bytes", "peak memory of the host", peak_memory_bytes()});
            fields.push_back({"hash", "picture", most.hash});
            report.add("devices", fields);
        }
        for (const std::size_t count : {4u, 8u}) {
            if (count <= greatest || greatest < 2) continue;
            const double seconds = expected_seconds(count, alone, most, greatest);
            report.add("devices_expected", {{"job", "job", record.name},
                                            {"devices", "devices, not measured", count},
                                            {"samples", "samples", samples},
                                            {"expected_seconds", "expected", seconds, "s", "{:.4f}"},
                                            {"ratio_to_one", "times one", alone.times.median / seconds, "", "{:.3f}"}});
        }
    }
    reporter.set_work("measuring batches of cameras");
    const float size = length(bounds_of(scene).size());
    report_batches(flags, queues, {prepared, camera, settings}, record.name, size, report);
    reporter.set_work("measuring frames in real time");
    report_frames(flags, queues, {prepared, camera, settings}, record.name, size, report);
    report.write();
    return 0;
}

} // namespace

void add_bench_devices_command(CLI::App& bench, int& status) {
    const auto flags = std::make_shared<DevicesFlags>();
    CLI::App& verb = add_bench_verb(bench, "devices", "Time a picture by one device and by several together",
                                    [flags, &status] { status = bench_devices(*flags); });
    flags->picture.tracer.default_build = TreeBuild::Best; // only the render is timed
    std::vector<std::string> names;
    for (const RecordJob& job : the_record().jobs) names.emplace_back(job.name);
    verb.add_option("--job", flags->job, "the job of `bench render`")
        ->type_name("NAME")
        ->check(one_of(std::move(names)))
        ->capture_default_str();
    verb.add_option("--scene", flags->picture.scenes, "the job's scene, as of `bench render`")
        ->type_name("FILE")
        ->required()
        ->expected(1);
    add_whole(verb, "--runs", flags->runs, "timed runs of each number of devices", 1, 1000)->capture_default_str();
    add_whole(verb, "--pictures", flags->pictures, "pictures of 128x128 in a batch (4096 in CUDA, 32 on the CPU)", 1,
              10000000);
    add_whole(verb, "--frames", flags->frames, "frames in real time, 3840x2160 in CUDA, 192x108 on the CPU", 1, 100000)
        ->capture_default_str();
    verb.add_option("--numbers", flags->numbers, "numbers of devices, compared with one alone (each up to all)")
        ->type_name("N,...")
        ->delimiter(',')
        ->check(whole_between(1, 1000));
    add_picture_flags(verb, kBenchDevices, flags->picture, "the job's", "8192, and 256");
}

} // namespace pertev
