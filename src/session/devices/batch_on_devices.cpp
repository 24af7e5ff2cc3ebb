#include "session/devices/batch_on_devices.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "base/error.h"
#include "device/peer_copy.h"
#include "session/devices/one_device.h"

namespace pertev {
namespace {

constexpr uint32_t kChunksOfDevice = 4; // so that the last one is not waited for long

/// The chunks of a batch that are still to be rendered, and what became of the others.
class ChunkRun final : public Sink {
public:
    ChunkRun(uint32_t pictures, uint32_t chunk) : pictures_(pictures), chunk_(chunk) {}

    /// Returns the first picture of a chunk; nothing if none is left or the run stops.
    std::optional<uint32_t> take() {
        const std::lock_guard lock(mutex_);
        if (stops_) return std::nullopt;
        if (!lost_.empty()) {
            const uint32_t first = lost_.back();
            lost_.pop_back();
            return first;
        }
        if (next_ >= pictures_) return std::nullopt;
        return std::exchange(next_, next_ + std::min(chunk_, pictures_ - next_));
    }
    void add_done(uint32_t pictures) {
        const std::lock_guard lock(mutex_);
        done_ += pictures;
        changed_.notify_all();
    }
    /// Queues `chunk`, if there is one, for another round without the device, and records why the device is lost.
    void lose(std::optional<uint32_t> chunk, std::size_t device, const Error& why) {
        const std::lock_guard lock(mutex_);
        if (chunk) lost_.push_back(*chunk);
        losses.emplace_back(device, why);
    }
    void fail(std::exception_ptr why) {
        const std::lock_guard lock(mutex_);
        if (!failure) failure = std::move(why);
        stops_ = true;
    }
    void stop() { stops_ = true; }
    bool should_stop() override { return stops_; }
    void leave() {
        const std::lock_guard lock(mutex_);
        ++left_;
        changed_.notify_all();
    }
    /// Waits a while for a change. Returns how many pictures are done, and whether `threads` of them have left.
    std::pair<uint32_t, bool> wait(std::size_t threads) {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, std::chrono::milliseconds(100), [&] { return left_ == threads; });
        return {done_, left_ == threads};
    }
    void begin_round() { left_ = 0; }
    bool is_done() const { return done_ == pictures_; }

    // For the caller's thread, between rounds.
    std::vector<std::pair<std::size_t, Error>> losses;
    std::exception_ptr failure;

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    uint32_t pictures_, chunk_, next_ = 0, done_ = 0;
    std::size_t left_ = 0;
    std::vector<uint32_t> lost_;
    std::atomic<bool> stops_ = false;
};

/// Copies a chunk to its place among all pictures.
void copy_chunk(Queue& to, BatchArrays& all, Queue& from, const BatchArrays& part, std::size_t pixels_of_picture) {
    const std::size_t first = part.first * pixels_of_picture, pixels = part.pictures * pixels_of_picture;
    const auto copy = [&]<class T>(const Buffer<T>& into, const Buffer<T>& source, std::size_t channels) {
        copy_between(to, into.data() + first * channels, from, source.data(), pixels * channels * sizeof(T));
    };
    const std::size_t channels = all.color.size() / (all.pictures * pixels_of_picture);
    if (part.color.size() > 0) copy(all.color, part.color, channels);
    if (!part.noisy_hashes.empty()) copy(all.noisy, part.noisy, channels);
    for (std::size_t i = 0; i < part.layers.size(); ++i) {
        copy(all.layers[i].values, part.layers[i].values, part.layers[i].channels);
    }
    if (part.ids.size() > 0) copy(all.ids, part.ids, 1);
    std::ranges::copy(part.noisy_hashes, all.noisy_hashes.begin() + part.first);
}

/// A batch whose chunks several devices render.
class BatchOnDevices {
public:
    BatchOnDevices(RenderOnDevices& together, PictureRenderer& pictures, const CameraBatch& batch,
                   const RenderSettings& settings, uint32_t chunk, BatchArrays& arrays)
        : together_(together), pictures_(pictures), batch_(batch), settings_(settings), chunk_(chunk), arrays_(arrays),
          workers_(together.workers()), run_(batch.count(), chunk) {}

    /// Renders rounds until all pictures are done or `sink` stops: another one for chunks of a device that failed.
    SharedBatch render(Sink& sink) {
        while (!run_.is_done() && !run_.should_stop()) {
            render_round(sink);
            if (run_.failure) std::rethrow_exception(run_.failure);
            leave_out_lost(sink);
        }
        return std::move(result_);
    }

private:
    /// Lets each device render chunks, in a thread of its own, until none is left.
    void render_round(Sink& sink) {
        run_.begin_round();
        std::vector<std::thread> threads;
        try {
            for (DeviceWorker* const worker : workers_) threads.emplace_back([this, worker] { render_on(*worker); });
            for (bool have_left = false; !have_left;) {
                const auto [done, all_have] = run_.wait(threads.size());
                have_left = all_have;
                const double share = static_cast<double>(done) / batch_.count();
                if (!sink.goes_on({.doing = "pictures", .share = share})) run_.stop();
            }
        } catch (...) {
            run_.fail(std::current_exception());
        }
        for (std::thread& thread : threads) thread.join();
    }

    /// Renders chunks on the worker's device. A device's own error gives its chunk back; others end the run.
    void render_on(DeviceWorker& worker) {
        std::optional<uint32_t> taken;
        try {
            render_chunks(worker, taken);
        } catch (const Error& error) {
            if (is_its_own(error)) {
                run_.lose(taken, worker.number(), error);
            } else {
                run_.fail(std::current_exception());
            }
        } catch (...) {
            run_.fail(std::current_exception());
        }
        run_.leave();
    }

    /// Renders chunks until none is left. Keeps the first picture of the chunk that is being rendered in `taken`.
    void render_chunks(DeviceWorker& worker, std::optional<uint32_t>& taken) {
        stay_near(worker.queue());
        const UseThreads use(worker.queue().threads());
        PictureRenderer& own = worker.pictures_of(pictures_, settings_);
        if (together_.hooks().before_samples) together_.hooks().before_samples(worker.number());
        Queue landing = another_queue(pictures_.queue());
        BatchRender of_device(own, batch_, settings_, chunk_);
        BatchArrays part;
        while ((taken = run_.take())) {
            of_device.go_to(*taken);
            if (!of_device.next(part, run_)) break;
            worker.queue().wait();
            if (together_.hooks().after_slice)
                together_.hooks().after_slice(worker.number(), {part.first, part.first + part.pictures});
            copy_chunk(landing, arrays_, worker.queue(), part, std::size_t(settings_.width) * settings_.height);
            if (!part.denoiser.empty()) {
                const std::lock_guard lock(result_mutex_);
                arrays_.denoiser = part.denoiser;
            }
            run_.add_done(part.pictures);
        }
        const std::lock_guard lock(result_mutex_);
        result_.rays = result_.rays + of_device.rays();
        result_.invalid_samples += of_device.invalid_samples();
    }

    /// Removes the devices that failed in this round, with a warning. Throws the error if it is the last device's.
    void leave_out_lost(Sink& sink) {
        for (const auto& [number, error] : std::exchange(run_.losses, {})) {
            const auto lost = std::ranges::find(workers_, number, &DeviceWorker::number);
            if (workers_.size() == 1) throw error;
            sink.warn({"device", (*lost)->name(),
                       "failed, and the others render its pictures: " + std::string(error.what())});
            workers_.erase(lost);
        }
    }

    RenderOnDevices& together_;
    PictureRenderer& pictures_;
    const CameraBatch& batch_;
    const RenderSettings& settings_;
    uint32_t chunk_; // pictures that a device renders at once
    BatchArrays& arrays_;
    std::vector<DeviceWorker*> workers_; // that have not failed
    ChunkRun run_;
    std::mutex result_mutex_;
    SharedBatch result_;
};

} // namespace

SharedBatch render_batch(RenderOnDevices& together, PictureRenderer& pictures, const CameraBatch& batch,
                         const RenderSettings& settings, uint32_t at_once, BatchArrays& arrays, Sink& sink) {
    const auto pieces = static_cast<uint32_t>(together.workers().size()) * kChunksOfDevice;
    const uint32_t chunk = std::clamp((batch.count() + pieces - 1) / pieces, 1u, at_once);
    Queue& first_queue = pictures.queue();
    arrays.fit(first_queue, settings, batch.count());
    arrays.first = 0, arrays.pictures = batch.count();
    arrays.noisy_hashes.assign(settings.is_denoised() ? batch.count() : 0, {});
    first_queue.wait(); // others write into the arrays
    return BatchOnDevices(together, pictures, batch, settings, chunk, arrays).render(sink);
}

} // namespace pertev
