#pragma once

// Renders a picture by several devices together. Each has the scene and a thread, and takes slices of samples from a
// common counter. The exact films are added on the host, beside the rendering; the last ones first on the caller's
// device, to which they are copied directly where that can be. The picture has the bytes of one device's.
//
// A device that fails costs what it took since its film was last added (kFoldSeconds), which the others render again.
// A device that is too small for the scene is left out. In both cases there is a warning.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "session/devices/device_worker.h"

namespace pertev {

class RenderOnDevices final : public SharedRender {
public:
    /// Takes the devices, of which the first is that of the caller's PictureRenderer; the others copy its scene at the
    /// first render(). The queues and the scene outlive this, and the scene must not change without change_scene().
    RenderOnDevices(std::span<const std::shared_ptr<Queue>> queues, const PreparedScene& scene, DeviceHooks hooks = {});

    Queue& film_queue() override { return film_queue_; }
    void change_scene(const PreparedScene& scene, uint32_t parts) override;
    SharedSamples render(const SharedPicture& picture, SampleRange range, uint32_t before, Film& into,
                         Sink& sink) override;

    /// The devices that have not failed, of which the first is the caller's unless that has.
    std::vector<DeviceWorker*> workers() const;
    const DeviceHooks& hooks() const { return hooks_; }
    /// Returns the seconds in which the slowest device took the scene.
    double upload_seconds() const;
    /// Seconds of the last render() after its last sample, in which the last films were added.
    double sum_seconds() const { return sum_seconds_; }

private:
    void open_copy_paths(Sink& sink);
    void drive(SharedRun& run, const SharedPicture& picture, SampleRange range, uint32_t before, Film& into,
               Sink& sink);
    void fold(SharedRun& run, const FilledFilm& film, Film& into);
    void fold_last(SharedRun& run, std::vector<FilledFilm> films, Film& into);
    void release(SharedRun& run, const FilledFilm& film);
    void report_losses(SharedRun& run, Sink& sink);

    Queue film_queue_;
    DeviceHooks hooks_;
    std::vector<std::unique_ptr<DeviceWorker>> workers_; // without those that were lost in earlier calls
    bool into_is_empty_ = false;                         // the film to which films are added has no samples yet
    double sum_seconds_ = 0;
    bool has_copy_paths_ = false;
    std::vector<std::vector<std::byte>> landing_; // a film's targets on the host, before they are added
};

} // namespace pertev
