#include "python/batch.h"

#include <algorithm>
#include <cstring>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "device/wait_for_device.h"
#include "image/picture_hash.h"
#include "python/unlocked.h"
#include "session/batch_render.h"
#include "session/devices/batch_on_devices.h"
#include "session/opening/calibrated_camera.h"
#include "session/opening/choose_camera.h"
#include "session/pictures/frame_settings.h"

namespace pertev {
namespace {

/// Returns what places camera `k`.
CameraChoice choice_of(const CamerasArgument& cameras, const PictureOptions& options, std::size_t k) {
    CameraChoice choice = options.scene.camera;
    choice.pose = cameras.poses[k];
    if (!cameras.intrinsics.empty()) choice.intrinsics = cameras.intrinsics[cameras.intrinsics.size() > 1 ? k : 0];
    return choice;
}

/// Returns the cameras of the batch, all of which have the options' lens. A single picture has the camera `own`.
CameraBatch batch_of(const CamerasArgument& cameras, const PictureOptions& options, const RenderSettings& settings,
                     const Scene& scene, const Camera& own, Sink& sink) {
    CameraBatch batch = {.cameras = {}, .seeds = cameras.seeds};
    if (cameras.is_single) batch.cameras = {own};
    const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
    for (std::size_t k = 0; k < cameras.poses.size(); ++k) {
        CameraChoice choice = choice_of(cameras, options, k);
        PartMessages unsaid(sink); // the first camera's messages were reported
        try {
            fit_intrinsics({settings.width, settings.height}, choice);
            batch.cameras.push_back(choose_camera(choice, scene, aspect, unsaid));
        } catch (const Error& error) {
            throw error_of_camera(error, k);
        }
        sink.check_at(k);
    }
    return batch;
}

uint32_t color_channels_of(const RenderSettings& settings) {
    return settings.samples == 0 ? 0 : settings.transparent ? 4 : 3;
}

std::string text_of_layers(uint32_t groups) {
    const std::vector<std::string> names = aov_names(groups);
    return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

/// Returns the bytes of the arrays of `count` pictures.
std::size_t bytes_of_arrays(const RenderSettings& settings, uint32_t count, bool on_cuda) {
    Queue queue = Queue::make_dry_run(on_cuda);
    BatchArrays arrays;
    arrays.fit(queue, settings, count);
    return queue.allocated_bytes();
}

MemoryLimit limit_of(const RenderSetup& setup, const RenderSettings& settings, const PictureOptions& options) {
    return batch_memory(*setup.queue, settings, max_memory_bytes(options.radiosity));
}

void copy_part(Queue& queue, void* to, const void* from, uint64_t first, uint64_t count, std::size_t bytes_each) {
    queue.copy_on_device(static_cast<std::byte*>(to) + first * bytes_each, from, count * bytes_each);
}

/// Copies a chunk to its place among all pictures, each of `pixels`.
void copy_chunk(Queue& queue, const BatchArrays& part, uint64_t pixels, uint32_t color_channels, BatchArrays& all) {
    std::ranges::copy(part.noisy_hashes, all.noisy_hashes.begin() + part.first);
    all.denoiser = part.denoiser;
    const uint64_t first = part.first * pixels, count = part.pictures * pixels;
    const std::size_t color_bytes = color_channels * sizeof(float);
    if (color_channels > 0) copy_part(queue, all.color.data(), part.color.data(), first, count, color_bytes);
    if (!part.noisy_hashes.empty()) {
        copy_part(queue, all.noisy.data(), part.noisy.data(), first, count, color_bytes);
    }
    for (std::size_t i = 0; i < part.layers.size(); ++i) {
        copy_part(queue, all.layers[i].values.data(), part.layers[i].values.data(), first, count,
                  part.layers[i].channels * sizeof(float));
    }
    if (part.ids.size() > 0) copy_part(queue, all.ids.data(), part.ids.data(), first, count, sizeof(PixelIds));
}

/// Throws Error(OutOfMemory) if `bytes` for so many pictures are more than the limit.
void check_room(std::size_t bytes, const MemoryLimit& limit, uint32_t pictures) {
    if (bytes <= limit.bytes) return;
    throw Error(
        ErrorCode::OutOfMemory, "cameras", fmt::format("{}", pictures),
        fmt::format("{:.1f} GiB are needed and {:.1f} GiB are available; pertev.render_chunks() renders the pictures "
                    "in parts",
                    static_cast<double>(bytes) / (1u << 30), static_cast<double>(limit.bytes) / (1u << 30)));
}

/// Returns the metadata without those of an entry.
void leave_out(std::string_view name, ExrMetadata& metadata) {
    std::erase_if(metadata, [&](const auto& entry) { return entry.first == name; });
}

} // namespace

Error error_of_camera(const Error& error, std::size_t number) {
    const bool is_pose = error.setting() == "camera_pose", is_lens = error.setting() == "intrinsics";
    if (!is_pose && !is_lens) return error;
    return {error.code(), is_pose ? "cameras" : "K", "", fmt::format("camera {}: {}", number, error.reason())};
}

RenderSettings CamerasArgument::settings_of(RenderSettings settings) const {
    if (has_color) return settings;
    if (settings.layers_at != LayersAt::Centre)
        throw Error(ErrorCode::BadInput, "color", "", "only layers at centres are made without it; see `layers_at`");
    settings.samples = 0;
    return settings;
}

uint32_t size_of_chunk(OpenedScene& opened, const RenderSettings& settings, const CamerasArgument& cameras,
                       const PictureOptions& options) {
    const RenderSetup& setup = *opened.setup();
    CameraBatch batch = {.cameras = std::vector<Camera>(cameras.count()), .seeds = cameras.seeds};
    return pictures_at_once(setup.prepared(), batch, settings, limit_of(setup, settings, options).bytes,
                            setup.queue->is_cuda());
}

/// Returns why pictures of a call cannot fill the arrays; empty if they can.
std::string PythonBatch::misfit(const RenderSettings& settings, const CamerasArgument& cameras,
                                const Queue& queue) const {
    uint32_t groups = 0;
    for (const BatchArrays::Layer& layer : arrays_.layers) groups |= layer.group;
    if (arrays_.ids.size() > 0) groups |= kAovIds;
    const uint32_t channels = color_channels_of(settings);
    if (&queue != queue_.get())
        return "the arrays belong to another scene or device, or to the scene before it was opened again";
    if (cameras.is_single != is_single_)
        return is_single_ ? "the arrays are of one picture, without `cameras`" : "the arrays are of many `cameras`";
    if (cameras.count() != arrays_.pictures)
        return fmt::format("the arrays are of {} pictures; expected {}", arrays_.pictures, cameras.count());
    if (settings.width != width_ || settings.height != height_) {
        return fmt::format("the arrays are of pictures of {}x{}; expected {}x{}", width_, height_, settings.width,
                           settings.height);
    }
    if (groups != settings.aovs)
        return fmt::format("the layers are {}; expected {}", text_of_layers(groups), text_of_layers(settings.aovs));
    if (channels != color_channels_)
        return fmt::format("the color has {} channels; expected {}", color_channels_, channels);
    return "";
}

void PythonBatch::render(OpenedScene& opened, Session& session, const CamerasArgument& cameras,
                         std::shared_ptr<const PictureRecord> record, const PictureOptions& options, Sink& sink) {
    const std::unique_lock turn = wait_for_turn(sink);
    const RenderSetup& setup = *opened.setup();
    const RenderSettings settings = cameras.settings_of(session.settings());
    Queue& queue = *setup.queue;
    const auto count = static_cast<uint32_t>(cameras.count());
    const CameraBatch batch = batch_of(cameras, options, settings, setup.scene(), session.camera(), sink);
    check_batch(batch, settings);
    if (!is_empty()) {
        const std::string why = misfit(settings, cameras, queue);
        if (!why.empty()) throw Error(ErrorCode::BadInput, "out", "", why);
        wait_for_device(queue); // others may still read the arrays
    }
    const uint32_t at_once = size_of_chunk(opened, settings, cameras, options);
    if (is_empty()) {
        const std::size_t bytes = predicted_batch_bytes(setup.prepared(), batch, settings, at_once, queue.is_cuda()) +
                                  (at_once < count ? bytes_of_arrays(settings, count, queue.is_cuda()) : 0);
        check_room(bytes, limit_of(setup, settings, options), count);
        queue_ = setup.queue;
        width_ = settings.width, height_ = settings.height;
        color_channels_ = color_channels_of(settings);
        is_single_ = cameras.is_single;
    }
    arrays_.fit(queue, settings, count);
    record_ = std::move(record), options_ = options, made_by_ = cameras, batch_ = batch;
    const Stopwatch watch;
    if (RenderOnDevices* const together = opened.together()) {
        const SharedBatch made = render_batch(*together, session.pictures(), batch, settings, at_once, arrays_, sink);
        sink.check();
        invalid_samples_ = made.invalid_samples, rays_ = made.rays;
        seconds_ = watch.seconds();
        return;
    }
    BatchRender render(session.pictures(), batch, settings, at_once);
    if (at_once == count) {
        render.next(arrays_, sink);
    } else {
        const uint64_t pixels = uint64_t(width_) * height_;
        arrays_.noisy_hashes.assign(settings.is_denoised() ? count : 0, {});
        for (BatchArrays part; render.next(part, sink);) {
            copy_chunk(queue, part, pixels, color_channels_, arrays_);
        }
    }
    queue.wait();
    sink.check();
    arrays_.first = 0, arrays_.pictures = count;
    invalid_samples_ = render.invalid_samples(), rays_ = render.rays();
    seconds_ = watch.seconds();
}

std::unique_lock<std::timed_mutex> PythonBatch::wait_for_turn(Sink& sink) const { return wait_for(*turn_, sink); }

std::vector<std::size_t> PythonBatch::shape() const {
    if (is_single_) return {height_, width_};
    return {arrays_.pictures, height_, width_};
}

std::vector<PythonBatch::Array> PythonBatch::arrays() const {
    std::vector<Array> all;
    if (color_channels_ > 0) all.push_back({"color", arrays_.color.data(), color_channels_, true});
    if (is_denoised()) all.push_back({"noisy", arrays_.noisy.data(), color_channels_, true});
    for (const BatchArrays::Layer& layer : arrays_.layers) {
        all.push_back({aov_group(layer.group).name, layer.values.data(), layer.channels, true});
    }
    if (arrays_.ids.size() > 0) all.push_back({"ids", arrays_.ids.data(), 3, false});
    return all;
}

std::vector<std::byte> PythonBatch::download(const Array& array) const { return download(array, 0, arrays_.pictures); }

/// Returns the bytes of `count` pictures from number `first` on, as others have left them.
std::vector<std::byte> PythonBatch::download(const Array& array, std::size_t first, std::size_t count) const {
    wait_for_device(*queue_);
    const std::size_t each = sizeof(float) * array.channels * height_ * width_;
    std::vector<std::byte> bytes(each * count);
    queue_->copy_to_host(bytes.data(), static_cast<const std::byte*>(array.values) + first * each, bytes.size());
    queue_->wait();
    return bytes;
}

std::optional<std::string> PythonBatch::hash(std::size_t picture) const {
    if (color_channels_ == 0) return std::nullopt;
    if (is_denoised()) return arrays_.noisy_hashes[picture].hex();
    const std::vector<std::byte> bytes = download(arrays().front(), picture, 1);
    return picture_hash(width_, height_, {reinterpret_cast<const float*>(bytes.data()), bytes.size() / sizeof(float)})
        .hex();
}

PictureRecord PythonBatch::record_of(std::size_t picture) const {
    PictureRecord record = *record_;
    PictureOptions options = options_;
    record.settings = made_by_.settings_of(record.settings);
    record.settings.path.seed = batch_.seed_of(static_cast<uint32_t>(picture), record.settings);
    options.render.path.seed = record.settings.path.seed;
    if (!batch_.seeds.empty()) {
        options.given["seed"] = SettingOrigin::Caller;
        const std::vector<std::string> words = words_of(record.scene.by_caller);
        std::set<std::string> names(words.begin(), words.end());
        names.insert("seed");
        record.scene.by_caller = fmt::format("{}", fmt::join(names, " "));
    }
    if (!made_by_.is_single) {
        const CameraChoice choice = choice_of(made_by_, options, picture);
        options.scene.camera.pose = choice.pose, options.scene.camera.intrinsics = choice.intrinsics;
        record.camera = source_of(choice, batch_.cameras[picture], record.camera.origin);
    }
    record.scene.settings = settings_of_frame(options, record, 0);
    return record;
}

std::vector<PixelIds> PythonBatch::ids_of(std::size_t picture) const {
    std::vector<PixelIds> ids(arrays_.ids.size() > 0 ? std::size_t(width_) * height_ : 0);
    if (!ids.empty()) {
        const std::vector<std::byte> bytes = download(arrays().back(), picture, 1);
        std::memcpy(ids.data(), bytes.data(), bytes.size());
    }
    return ids;
}

RenderStats PythonBatch::stats() const {
    RenderStats stats;
    stats.samples = samples(), stats.invalid_samples = invalid_samples_;
    stats.render_seconds = seconds_, stats.rays = rays_;
    return stats;
}

PythonResult PythonBatch::picture(std::size_t picture) const {
    RenderResult result;
    static_cast<RenderStats&>(result) = stats();
    for (const Array& array : arrays()) {
        if (!array.is_float) continue;
        const std::vector<std::byte> bytes = download(array, picture, 1);
        Image image = {width_, height_, static_cast<uint32_t>(array.channels),
                       std::vector<float>(bytes.size() / sizeof(float))};
        std::memcpy(image.pixels.data(), bytes.data(), bytes.size());
        if (array.name == "color" && is_denoised()) {
            result.denoised = std::move(image);
        } else if (array.name == "color" || array.name == "noisy") {
            result.picture = std::move(image);
        } else {
            const AovGroup& group = *std::ranges::find(kAovTable, array.name, &AovGroup::name);
            result.layers.push_back({group.layer, channel_names(group), std::move(image)});
        }
    }
    result.ids = ids_of(picture);
    result.denoiser = arrays_.denoiser;
    PythonResult made(std::move(result), std::make_shared<const PictureRecord>(record_of(picture)));
    if (is_denoised()) made.hash = arrays_.noisy_hashes[picture].hex();
    return made;
}

ExrMetadata PythonBatch::metadata(std::size_t picture) const {
    const std::optional<std::string> known = hash(picture);
    ExrMetadata metadata = picture_metadata(facts_of(record_of(picture), ids_of(picture)), stats(), known.value_or(""));
    if (!known) leave_out("pertev.hash", metadata);
    if (!arrays_.denoiser.empty()) metadata.emplace_back("pertev.denoiser", arrays_.denoiser);
    if (made_by_.is_single) return metadata;
    for (const char* of_all : {"pertev.rays", "pertev.invalid_samples", "pertev.render_seconds"})
        leave_out(of_all, metadata);
    return metadata;
}

} // namespace pertev
