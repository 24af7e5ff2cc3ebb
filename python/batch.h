#pragma once

// Pictures of one scene by many cameras, as Python sees them: arrays of all pictures, in the memory of the device that
// rendered them.

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>

#include "python/opened_scene.h"
#include "python/result.h"
#include "session/camera_batch.h"

namespace pertev {

/// The cameras of a call. Whatever they leave open, such as the lens, is the same for all: that of the settings.
/// Without poses there is one picture, by the camera of the settings.
struct CamerasArgument {
    std::vector<std::vector<double>> poses;      // numbers of the setting camera_pose, by camera
    std::vector<std::vector<double>> intrinsics; // numbers of this setting: one for all, one per camera, or none
    std::vector<uint32_t> seeds;                 // none, a seed for all, or one per camera
    bool has_color = true;                       // otherwise only layers at centres are made
    bool is_single = false;                      // the batch is a single camera without poses

    std::size_t count() const { return is_single ? 1 : poses.size(); }

    /// Returns the settings of each picture. Throws Error(BadInput) if a picture without colour has no centres.
    RenderSettings settings_of(RenderSettings settings) const;
};

/// Several threads may use one: render() waits for its turn, and the caller of every other function has the turn of
/// wait_for_turn().
class PythonBatch {
public:
    /// Renders with the settings and the device of `session`, which is that of `opened`. `record` and `options` are
    /// those of the call. The arrays are complete on return. Those of an earlier call are filled again, after all
    /// work on the device that may use them. Throws
    /// Error(BadInput) if they do not fit, and Error(OutOfMemory, Interrupted, ...).
    void render(OpenedScene& opened, Session& session, const CamerasArgument& cameras,
                std::shared_ptr<const PictureRecord> record, const PictureOptions& options, Sink& sink);

    /// Waits until no other thread fills the arrays or reads them. Throws Error(Interrupted) if the sink stops.
    std::unique_lock<std::timed_mutex> wait_for_turn(Sink& sink) const;
    bool is_single() const { return is_single_; }
    bool is_empty() const { return queue_ == nullptr; }
    /// Returns the hash of a picture, as its array holds it now, or of its samples if it is denoised; nothing if it
    /// has no colour.
    std::optional<std::string> hash(std::size_t picture) const;
    /// Returns the metadata of a picture, as an EXR has them.
    ExrMetadata metadata(std::size_t picture) const;
    /// Returns what is known of a picture before its samples.
    PictureRecord record_of(std::size_t picture) const;
    /// Returns a copy of a picture in the memory of the host. It has no colour if there is none.
    PythonResult picture(std::size_t picture) const;
    bool has_color() const { return color_channels_ > 0; }
    uint32_t samples() const { return record_ ? made_by_.settings_of(record_->settings).samples : 0; }
    bool is_denoised() const { return !arrays_.noisy_hashes.empty(); }

    uint64_t invalid_samples() const { return invalid_samples_; }
    double seconds() const { return seconds_; }
    std::size_t count() const { return arrays_.pictures; }
    /// Number, height and width of the pictures; a single picture has no number.
    std::vector<std::size_t> shape() const;
    const Queue& queue() const { return *queue_; }

    struct Array {
        std::string name; // a group of layers, "color" or "noisy"
        void* values;
        std::size_t channels;
        bool is_float; // otherwise uint32
    };
    std::vector<Array> arrays() const;
    /// Returns the bytes of an array on the host.
    std::vector<std::byte> download(const Array& array) const;

private:
    std::vector<std::byte> download(const Array& array, std::size_t first, std::size_t count) const;
    std::vector<PixelIds> ids_of(std::size_t picture) const;
    RenderStats stats() const;
    std::string misfit(const RenderSettings& settings, const CamerasArgument& cameras, const Queue& queue) const;

    std::unique_ptr<std::timed_mutex> turn_ = std::make_unique<std::timed_mutex>(); // so that batches can be moved
    std::shared_ptr<Queue> queue_;                                                  // outlives the buffers
    BatchArrays arrays_;
    uint32_t width_ = 0, height_ = 0, color_channels_ = 0;
    bool is_single_ = false;
    uint64_t invalid_samples_ = 0;
    RayCounts rays_;
    double seconds_ = 0;
    // These made the pictures.
    std::shared_ptr<const PictureRecord> record_;
    PictureOptions options_;
    CamerasArgument made_by_;
    CameraBatch batch_;
};

/// Returns the error with Python's names of what places a camera, and the camera's number.
Error error_of_camera(const Error& error, std::size_t number);

/// Returns how many pictures are rendered at once.
uint32_t size_of_chunk(OpenedScene& opened, const RenderSettings& settings, const CamerasArgument& cameras,
                       const PictureOptions& options);

void define_batch(nanobind::module_& module);

} // namespace pertev
