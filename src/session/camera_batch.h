#pragma once

// A batch of pictures of one scene by many cameras, and the arrays in which they come. Each picture has the bytes that
// its camera gives alone with the same settings and its seed.

#include <span>
#include <string>
#include <vector>

#include "base/hash.h"
#include "device/buffer.h"
#include "render/batch_view.h"
#include "session/render_memory.h"
#include "settings/render_settings.h"

namespace pertev {

/// The cameras of a batch. The size and everything else are those of the settings. With `samples` 0 there are only
/// layers at centres.
struct CameraBatch {
    std::vector<Camera> cameras;
    std::vector<uint32_t> seeds; // seed of each picture, or of all; empty: the seed of the settings

    uint32_t count() const { return static_cast<uint32_t>(cameras.size()); }
    uint32_t seed_of(uint32_t picture, const RenderSettings& settings) const {
        if (seeds.empty()) return settings.path.seed;
        return seeds.size() == 1 ? seeds.front() : seeds[picture];
    }
};

/// Throws Error(BadInput) for cameras, seeds and settings of which no batch can be made: arrays hold no light-path
/// layers, irradiance or motion vectors, and a time limit would end pictures at different samples.
void check_batch(const CameraBatch& batch, const RenderSettings& settings);

/// Returns whether the pictures of a chunk are one job; otherwise, as if they are denoised, they are rendered one after
/// the other.
bool is_one_job(const RenderSettings& settings);

/// Consecutive pictures of a batch in memory of the device: [picture][row][column][channel].
struct BatchArrays {
    struct Layer {
        AovBits group;
        uint32_t channels;
        Buffer<float> values;
    };

    uint32_t first = 0, pictures = 0;
    Buffer<float> color; // RGB, or RGBA if the settings are transparent, denoised if they say so; empty without samples
    Buffer<float> noisy; // `color` before it was denoised; empty if it is not
    std::vector<Layer> layers;
    Buffer<PixelIds> ids;
    std::vector<Hash128> noisy_hashes; // picture_hash() of each picture in `noisy`; else empty
    std::string denoiser;              // Denoiser::name of what made `color`

    /// Allocates what is missing for `count` pictures; a caller may have taken buffers. Throws Error(OutOfMemory).
    void fit(Queue& queue, const RenderSettings& settings, uint32_t count);
};

/// Memory of a chunk of pictures besides its arrays and the integrator's queues.
struct BatchMemory {
    BatchMemory(Queue& queue, const CameraBatch& batch, const RenderSettings& settings, uint32_t at_once);

    Buffer<CameraRays> cameras;
    Buffer<uint32_t> seeds;
    Buffer<MotionKey> motions; // keys of cameras that move while the shutter is open
    std::optional<Film> film;  // the tall picture; none if pictures are rendered one after the other
};

/// Predicted device memory, in bytes, of a scene and of a batch that is rendered in chunks of `at_once` pictures, with
/// one set of arrays.
std::size_t predicted_batch_bytes(const PreparedScene& scene, const CameraBatch& batch, const RenderSettings& settings,
                                  uint32_t at_once, bool on_cuda);
/// Returns the memory that a scene and a batch may take: `requested`, or on a GPU what is free together with what the
/// queue has taken, and on the CPU as memory_to_render_in.
MemoryLimit batch_memory(const Queue& queue, const RenderSettings& settings, std::optional<std::size_t> requested);
/// Returns how many pictures to render at once: as many as keep the device busy, or fewer if they would exceed `limit`
/// bytes, but at least one.
uint32_t pictures_at_once(const PreparedScene& scene, const CameraBatch& batch, const RenderSettings& settings,
                          std::size_t limit, bool on_cuda);

} // namespace pertev
