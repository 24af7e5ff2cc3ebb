#include "session/devices/frames_on_devices.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "session/devices/device_worker.h"

namespace pertev {
namespace {

/// Stops the part of a frame on a CPU once the caller does, or once the frame is lost.
struct PartSink final : Sink {
    PartSink(Sink& caller, const std::atomic<bool>& lost) : of_caller(caller), is_lost(lost) {}
    bool should_stop() override { return is_lost || of_caller.should_stop(); }
    Sink& of_caller;
    const std::atomic<bool>& is_lost;
};

bool is_of_device(const Error& error) {
    return error.code() == ErrorCode::DeviceFault || error.code() == ErrorCode::OutOfMemory;
}

} // namespace

/// A device that helps the caller's.
struct FramesOnDevices::Follower {
    Follower(std::size_t number_of, Queue& its, const PreparedScene& scene)
        : number(number_of), queue(its), copy(its, scene), frames(copy.pictures()), thread([&its] { stay_near(its); }) {
    }

    std::size_t number; // among all devices that were named
    Queue& queue;
    SceneCopy copy;
    FrameSequence frames;
    DeviceThread thread; // ends first
};

/// A device's part of a frame, once its thread is done.
struct FramesOnDevices::Part {
    bool is_whole = false;
    double seconds = 0;
    std::optional<Error> failure; // the device has failed
    std::exception_ptr error;     // something else has

    /// Keeps the exception that is being handled.
    void keep_exception() {
        try {
            throw;
        } catch (const Error& thrown) {
            if (is_of_device(thrown)) {
                failure = thrown;
            } else {
                error = std::current_exception();
            }
        } catch (...) {
            error = std::current_exception();
        }
    }
};

FramesOnDevices::FramesOnDevices(std::span<const std::shared_ptr<Queue>> queues, const PreparedScene& scene,
                                 AfterLoss after_loss, FrameHooks hooks)
    : queue_(*queues.front()), after_loss_(after_loss), hooks_(std::move(hooks)) {
    for (std::size_t i = 1; i < queues.size(); ++i) {
        followers_.push_back(std::make_unique<Follower>(i, *queues[i], scene));
    }
}

FramesOnDevices::~FramesOnDevices() = default;

void FramesOnDevices::change_scene(const PreparedScene& scene, uint32_t parts) {
    for (const auto& follower : followers_) follower->copy.change(scene, parts);
}

void FramesOnDevices::take_scene(FrameSequence& leader, const RenderSettings& settings, Sink& sink) {
    std::vector<Part> parts(devices());
    for (std::size_t i = 0; i < followers_.size(); ++i) {
        Follower& follower = *followers_[i];
        follower.thread.start([&follower, &part = parts[i + 1], &leader, &settings] {
            try {
                const UseThreads use(follower.queue.threads());
                follower.copy.update(leader.pictures().scene(), settings, false);
                follower.queue.wait();
            } catch (...) {
                part.keep_exception();
            }
        });
    }
    for (const auto& follower : followers_) follower->thread.wait();
    for (const Part& part : parts) {
        if (part.error) std::rethrow_exception(part.error);
    }
    leave_out_failed(parts, sink);
}

/// Makes the team of the devices that have not failed.
void FramesOnDevices::form_team() {
    if (team_) return;
    std::vector<Queue*> queues = {&queue_};
    for (const auto& follower : followers_) queues.push_back(&follower->queue);
    team_ = std::make_unique<RowTeam>(queues);
}

bool FramesOnDevices::render(FrameSequence& leader, const FrameTask& task, Sink& sink) {
    const bool has_history = leader.has_history(), scene_has_changed = leader.scene_has_changed();
    for (;;) {
        form_team();
        std::vector<Part> parts(devices());
        const bool is_whole = render_together(leader, task, sink, parts);
        for (const Part& part : parts) {
            if (part.error) std::rethrow_exception(part.error);
        }
        if (std::ranges::none_of(parts, [](const Part& part) { return part.failure.has_value(); })) {
            if (is_whole) collect(leader, &FrameSequence::rows_of_result);
            return is_whole;
        }
        leader.begin_again(scene_has_changed);
        if (parts.front().failure) throw *parts.front().failure;
        leave_out_failed(parts, sink);
        if (has_history && after_loss_ == AfterLoss::Throw) {
            throw Error(ErrorCode::DeviceFault, "device", "",
                        "a device failed in the middle of a frame; the next one begins a sequence without it");
        }
    }
}

/// Lets all devices make their parts. Returns whether the frame is whole.
bool FramesOnDevices::render_together(FrameSequence& leader, const FrameTask& task, Sink& sink,
                                      std::vector<Part>& parts) {
    RowTeam& team = *team_;
    team.begin();
    std::atomic<bool> is_lost = false;
    PartSink part_sink(sink, is_lost);
    const auto make_part = [&](Part& part, std::size_t number, std::size_t named, Queue& queue, auto&& sequence) {
        try {
            const UseThreads use(queue.threads());
            FrameSequence& frames = sequence();
            if (hooks_.before_frame) hooks_.before_frame(named);
            const Stopwatch watch;
            part.is_whole = frames.render_rows(task, devices() > 1 ? &team.member(number) : nullptr, part_sink);
            queue.wait();
            part.seconds = watch.seconds() - team.waited(number);
            return;
        } catch (const FrameAbandoned&) {
        } catch (...) {
            part.keep_exception();
        }
        is_lost = true;
        team.abandon();
    };
    for (std::size_t i = 0; i < followers_.size(); ++i) {
        Follower& follower = *followers_[i];
        follower.frames.follow(leader);
        follower.thread.start([&make_part, &parts, &follower, &task, &leader, i] {
            make_part(parts[i + 1], i + 1, follower.number, follower.queue, [&]() -> FrameSequence& {
                follower.copy.update(leader.pictures().scene(), task.settings, follower.frames.has_moved());
                return follower.frames;
            });
        });
    }
    make_part(parts[0], 0, 0, queue_, [&]() -> FrameSequence& { return leader; });
    for (const auto& follower : followers_) follower->thread.wait();
    std::vector<double> seconds;
    for (const Part& part : parts) seconds.push_back(part.seconds);
    if (!is_lost) team.end(seconds);
    return std::ranges::all_of(parts, &Part::is_whole);
}

/// Goes on without the devices that have failed.
void FramesOnDevices::leave_out_failed(const std::vector<Part>& parts, Sink& sink) {
    std::vector<std::unique_ptr<Follower>> left;
    for (std::size_t i = 0; i < followers_.size(); ++i) {
        const std::optional<Error>& failure = parts[i + 1].failure;
        if (!failure) {
            left.push_back(std::move(followers_[i]));
        } else {
            sink.warn({"device", name_of_device(followers_[i]->queue),
                       fmt::format("failed, and the others make frames without it: {}", failure->what())});
        }
    }
    team_.reset();
    followers_ = std::move(left);
}

void FramesOnDevices::collect(FrameSequence& leader, std::vector<RowArray> (FrameSequence::*arrays)() const) {
    const std::vector<RowArray> into = (leader.*arrays)();
    for (std::size_t i = 0; i < followers_.size(); ++i) {
        team_->copy(0, into, i + 1, (followers_[i]->frames.*arrays)());
    }
    queue_.wait(); // others change these rows in the next frame
}

FrameCounts FramesOnDevices::counts_of_others() {
    FrameCounts sum;
    for (const auto& follower : followers_) {
        const FrameCounts counts = follower->frames.counts();
        sum = {sum.rays + counts.rays, sum.invalid_samples + counts.invalid_samples};
    }
    return sum;
}

} // namespace pertev
