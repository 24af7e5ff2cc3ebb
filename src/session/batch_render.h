#pragma once

// Renders a batch of pictures in chunks that fit into memory. The pictures of a chunk are one job for path tracing, so
// that small ones do not wait for their own rounds. For use:
//     DeviceScene scene(queue);
//     scene.set(prepared, settings);
//     PictureRenderer pictures(scene);
//     BatchRender render(pictures, batch, settings, pictures_at_once(prepared, batch, settings, limit, on_cuda));
//     for (BatchArrays arrays; render.next(arrays);) use(arrays);

#include "session/camera_batch.h"
#include "session/film_render.h"

namespace pertev {

class BatchRender {
public:
    /// Allocates memory for chunks of `at_once` pictures; `pictures` outlives it, and its scene must not change while
    /// it renders. Throws what check_batch does, and Error(OutOfMemory).
    BatchRender(PictureRenderer& pictures, CameraBatch batch, const RenderSettings& settings, uint32_t at_once);

    /// Renders the next chunk into `arrays`. The device may still write them on return: later work of the queue's
    /// stream, or Queue::wait(), sees them complete. Returns false without a chunk when the batch is done, or when
    /// `sink`, which hears of each chunk, stops; a chunk that it stops is rendered again by the next call. Throws what
    /// PictureRenderer::begin and the sink throw.
    bool next(BatchArrays& arrays, Sink& sink = nobody());
    bool next(BatchArrays& arrays, Sink&& sink) { return next(arrays, sink); }

    /// Lets the next chunk begin with this picture of the batch.
    void go_to(uint32_t picture) { done_ = picture; }
    /// Number of the first picture of the next chunk.
    uint32_t done() const { return done_; }
    const RayCounts& rays() const { return rays_; }
    uint64_t invalid_samples() const { return invalid_samples_; }

private:
    PictureView view_of_chunk(uint32_t count);
    bool render_together(BatchArrays& arrays, Sink& sink);
    bool render_in_turn(BatchArrays& arrays, Sink& sink);
    bool add_samples(const PictureView& picture, Sink& sink);
    void resolve(Film& film, uint32_t pictures, uint32_t at, BatchArrays& arrays);

    PictureRenderer& pictures_;
    const CameraBatch batch_;
    const RenderSettings settings_; // the settings of each picture
    const uint32_t at_once_;
    BatchMemory memory_;
    std::optional<FilmRender> in_turn_; // if pictures are rendered one after the other
    uint32_t done_ = 0;
    RayCounts rays_;
    uint64_t invalid_samples_ = 0;
};

} // namespace pertev
