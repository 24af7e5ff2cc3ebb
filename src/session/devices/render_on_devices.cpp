#include "session/devices/render_on_devices.h"

#include <algorithm>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "device/peer_copy.h"
#include "session/render_progress.h"

namespace pertev {
namespace {

constexpr double kProgressSeconds = 0.1; // between two reports
constexpr double kStopSeconds = 0.02;    // between two looks whether the caller stops, for a viewer's sake

} // namespace

RenderOnDevices::RenderOnDevices(std::span<const std::shared_ptr<Queue>> queues, const PreparedScene& scene,
                                 DeviceHooks hooks)
    : film_queue_(Queue::make_cpu()), hooks_(std::move(hooks)) {
    workers_.push_back(std::make_unique<DeviceWorker>(0, *queues.front()));
    for (std::size_t i = 1; i < queues.size(); ++i) {
        workers_.push_back(std::make_unique<DeviceWorker>(i, *queues[i], scene));
    }
}

void RenderOnDevices::change_scene(const PreparedScene& scene, uint32_t parts) {
    for (const auto& worker : workers_) worker->change_scene(scene, parts);
}

std::vector<DeviceWorker*> RenderOnDevices::workers() const {
    std::vector<DeviceWorker*> all;
    for (const auto& worker : workers_) all.push_back(worker.get());
    return all;
}

double RenderOnDevices::upload_seconds() const {
    double seconds = 0;
    for (const auto& worker : workers_) seconds = std::max(seconds, worker->upload_seconds());
    return seconds;
}

SharedSamples RenderOnDevices::render(const SharedPicture& picture, SampleRange range, uint32_t before, Film& into,
                                      Sink& sink) {
    PERTEV_CHECK(!workers_.empty());
    SharedRun run(range, picture.settings, workers_.size());
    std::vector<std::thread> threads;
    try {
        open_copy_paths(sink);
        for (std::size_t i = 0; i < workers_.size(); ++i) {
            workers_[i]->set_number(i);
            threads.emplace_back([&, i] { workers_[i]->render(run, picture, range.count(), into, hooks_); });
        }
        drive(run, picture, range, before, into, sink);
    } catch (...) {
        run.fail(std::current_exception());
    }
    for (std::thread& thread : threads) thread.join();
    const uint32_t count = run.result();
    const RunState state = run.state();
    std::erase_if(workers_, [&](const auto& worker) { return run.is_lost(worker->number()); });
    sum_seconds_ = state.seconds - run.last_slice_seconds();
    return {count, state.rays, state.seconds, run.first_seconds()};
}

/// Opens the paths on which films and the scene are copied, and names those of GPUs.
void RenderOnDevices::open_copy_paths(Sink& sink) {
    if (std::exchange(has_copy_paths_, true)) return;
    Queue& to = workers_.front()->queue();
    std::string paths;
    for (const auto& worker : workers_) {
        if (worker == workers_.front()) continue;
        allow_copies(to, worker->queue());
        allow_copies(worker->queue(), to);
        if (!worker->queue().is_cuda()) continue;
        paths += fmt::format("{} {} {}", paths.empty() ? "" : ",", worker->name(),
                             name_of_path(copy_path(worker->queue(), to)));
    }
    if (!paths.empty()) sink.note(fmt::format("films are copied to {} from{}", workers_.front()->name(), paths));
}

/// Adds films and reports until all devices have left.
void RenderOnDevices::drive(SharedRun& run, const SharedPicture& picture, SampleRange range, uint32_t before,
                            Film& into, Sink& sink) {
    into_is_empty_ = before == 0;
    landing_.resize(into.targets().size());
    for (std::size_t i = 0; i < landing_.size(); ++i) landing_[i].resize(into.targets()[i]->byte_count());
    const bool on_cpu = std::ranges::none_of(workers_, [](const auto& worker) { return worker->queue().is_cuda(); });
    const uint32_t all = before + range.count();
    uint32_t most_done = 0; // a lost device does not take the progress back
    const auto report = [&] {
        const RunState state = run.state();
        most_done = std::max(most_done, state.done);
        if (state.made_share < 1 && most_done == 0) {
            return sink.goes_on(made_progress(before, all, state.made_share, state.seconds, state.rays));
        }
        return sink.goes_on(
            progress_of(picture.settings, before + most_done, all, state.seconds, state.made_seconds, state.rays));
    };
    std::vector<FilledFilm> last;
    Stopwatch since_report;
    while (!run.have_all_left()) {
        std::optional<FilledFilm> film = run.wait_for_film(kStopSeconds, !last.empty());
        if (film) last.push_back(std::move(*film));
        // The last films wait for each other.
        if (!last.empty() && !run.is_ending()) fold_last(run, std::exchange(last, {}), into);
        report_losses(run, sink);
        if (since_report.seconds() < kProgressSeconds) {
            if (sink.should_stop()) run.stop(on_cpu);
            continue;
        }
        since_report.restart();
        if (!report()) run.stop(on_cpu);
    }
    if (!run.is_dropped()) report();
}

/// Adds a device's film to the sum. It is on the host before the first number is added, so that a device that fails
/// meanwhile does not affect the result.
void RenderOnDevices::fold(SharedRun& run, const FilledFilm& film, Film& into) {
    const auto& targets = film.film->targets();
    try {
        if (into_is_empty_) { // saves a pass over the first film
            for (std::size_t i = 0; i < targets.size(); ++i) into.targets()[i]->copy(*targets[i]);
        } else {
            for (std::size_t i = 0; i < targets.size(); ++i) targets[i]->read(0, landing_[i]);
        }
    } catch (const Error& error) {
        if (error.code() != ErrorCode::DeviceFault) throw;
        if (into_is_empty_) into.clear();
        run.lose(film, error);
        return run.release(film);
    }
    if (!std::exchange(into_is_empty_, false)) {
        for (std::size_t i = 0; i < targets.size(); ++i) into.targets()[i]->add_bytes(0, landing_[i]);
    }
    run.add_to_sum(film);
    release(run, film);
}

/// Adds films of several devices to the sum, by way of the caller's device if one of them is its film.
void RenderOnDevices::fold_last(SharedRun& run, std::vector<FilledFilm> films, Film& into) {
    const auto first = std::ranges::find(films, workers_.front()->number(), &FilledFilm::device);
    if (first != films.end()) {
        FilledFilm sum = *first;
        std::erase_if(films, [&](const FilledFilm& film) {
            if (film.film == sum.film) return true;
            if (!workers_.front()->add(*sum.film, *film.film)) return false;
            sum.slices.insert(sum.slices.end(), film.slices.begin(), film.slices.end());
            sum.done += film.done;
            sum.rays = sum.rays + film.rays;
            release(run, film);
            return true;
        });
        fold(run, sum, into);
    }
    for (const FilledFilm& film : films) fold(run, film, into);
}

/// Gives a film whose samples are elsewhere back to its device.
void RenderOnDevices::release(SharedRun& run, const FilledFilm& film) {
    try {
        workers_[film.device]->clear(*film.film);
    } catch (const Error& error) {
        run.lose({.device = film.device, .film = nullptr, .slices = {}, .rays = {}}, error);
    }
    run.release(film);
}

void RenderOnDevices::report_losses(SharedRun& run, Sink& sink) {
    for (const auto& [number, error] : run.take_losses()) {
        const std::string name = workers_[number]->name();
        if (error.code() == ErrorCode::OutOfMemory) {
            sink.warn({"device", name, fmt::format("has too little memory and is left out: {}", error.what())});
        } else {
            sink.warn(
                {"device", name, fmt::format("failed, and the others render its samples again: {}", error.what())});
        }
    }
}

} // namespace pertev
