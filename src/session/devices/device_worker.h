#pragma once

// A device that renders a picture with others: its scene, integrator and films. It has a queue of its own for its
// films, so that a film is copied to the host while the next one is being rendered.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "session/devices/scene_copy.h"
#include "session/devices/shared_run.h"
#include "session/post_steps.h"
#include "session/shared_render.h"

namespace pertev {

/// Seconds after which a device hands its film over, and thus what a failing device costs at most. A film is added
/// beside the rendering and delays none of it.
inline constexpr double kFoldSeconds = 5;

/// Lets the calling thread run near the queue's GPU; does nothing for a CPU's queue.
void stay_near(const Queue& queue);
std::string name_of_device(const Queue& queue); // cuda:1, for people

/// Hooks for tests. The device's thread calls them; a test throws in them what a failing device would.
struct DeviceHooks {
    std::function<void(std::size_t device)> before_samples;
    std::function<void(std::size_t device, SampleRange slice)> after_slice;
    double fold_s = kFoldSeconds;
};

class DeviceWorker {
public:
    /// Makes the worker of the caller's device, which has the scene; `queue` outlives it.
    DeviceWorker(std::size_t number, Queue& queue) : number_(number), queue_(queue) {}
    /// Makes the worker of another device, which gets the scene at the first render().
    DeviceWorker(std::size_t number, Queue& queue, const PreparedScene& scene) : number_(number), queue_(queue) {
        own_scene_.emplace(queue, scene);
    }

    /// Takes parts of the scene as they are at the next render(). The caller's device has them.
    void change_scene(const PreparedScene& scene, uint32_t parts);
    /// Returns what renders pictures of these settings on the device, once its scene is as it should be; `of_caller` on
    /// the caller's device. Throws as DeviceScene::set.
    PictureRenderer& pictures_of(PictureRenderer& of_caller, const RenderSettings& settings);
    /// Seconds of uploading; 0 on the caller's device.
    double upload_seconds() const { return own_scene_ ? own_scene_->upload_seconds() : 0; }
    std::string name() const; // cuda:1, for people
    /// The device's number in a run.
    std::size_t number() const { return number_; }
    void set_number(std::size_t number) { number_ = number; }
    // The caller's thread calls these for films that were handed over.

    /// Clears a film of the device. Throws Error(DeviceFault).
    void clear(Film& film);
    /// Adds `other`, a film of another device, to a film of this one, and returns true; or returns false if one of the
    /// devices has failed, or if this one has no memory for it.
    bool add(Film& to, const Film& other);
    Queue& queue() const { return queue_; }

    /// Takes slices of the run until it ends; a thread's function. `count` is the number of samples of all devices, and
    /// `into` the film to which those of the devices are added, which are like it.
    void render(SharedRun& run, const SharedPicture& picture, uint32_t count, const Film& into,
                const DeviceHooks& hooks);

private:
    void take_slices(SharedRun& run, const SharedPicture& picture, PictureRenderer& pictures, Integrator& integrator,
                     Sink& drops, const DeviceHooks& hooks);
    void make_films(const SharedPicture& picture, const Film& into);
    void begin_steps(const SharedPicture& picture, PictureRenderer& pictures, Sink& drops);
    void add_samples(Integrator& integrator, const SharedPicture& picture, SampleRange slice, Sink& drops);
    void add_moments(Integrator& integrator, const SharedPicture& picture, SampleRange slice);
    Film& other_film() { return films_[1] && &*films_[0] == held_.film ? *films_[1] : *films_[0]; }

    std::size_t number_;
    Queue& queue_;
    std::optional<SceneCopy> own_scene_;
    std::optional<Queue> film_queue_;
    std::optional<Film> films_[2];    // one is filled while the other is added to the sum; one alone if memory is short
    std::optional<Film> sample_film_; // one sample, for its moments
    std::optional<Film> landing_;     // a film of another device, before it is added; on the caller's device alone
    FilledFilm held_;                 // the contents of the film that is being filled
    std::optional<PostSteps> steps_;  // denoised pictures have them
    const PictureRenderer* steps_of_ = nullptr; // they belong to its picture of this number
    uint64_t steps_number_ = 0;
};

} // namespace pertev
