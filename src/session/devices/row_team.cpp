#include "session/devices/row_team.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "base/stopwatch.h"
#include "device/peer_copy.h"
#include "session/devices/one_device.h"

namespace pertev {
namespace {

constexpr uint32_t kWhole = 1u << 20;
constexpr uint32_t kRowsOfBand = 8; // bands begin at multiples, so that tiles of pixels stay whole
constexpr double kLeastShare = 0.1; // a device's rows are at least this part of an equal share

} // namespace

/// The view of one device's thread of the others.
class RowTeam::Member final : public RowExchange {
public:
    Member(RowTeam& team, std::size_t number, Queue& own, std::span<Queue* const> all)
        : queue(own), landing(another_queue(own)), team_(team), number_(number), readers_(all.size()) {
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (i == number) continue;
            allow_copies(queue, *all[i]);
            // The owner's queue belongs to the owner's thread.
            if (all[i]->is_cuda() && !queue.is_cuda()) readers_[i].emplace(another_queue(*all[i]));
        }
    }

    void begin() { waited = 0, turn_ = 0; }
    RowBand own_rows(uint32_t height) const override { return team_.rows_of(number_, height); }

    void take(const std::vector<RowArray>& arrays, RowBand rows) override {
        queue.wait(); // others take this device's rows
        publish(arrays);
        for (std::size_t i = 0; i < team_.members_.size(); ++i) {
            if (i == number_ || arrays.empty()) continue;
            copy_rows(queue, i, arrays, team_.bounds_, [&](uint32_t) { return rows; });
        }
    }

    void begin_taking_last(const std::vector<RowArray>& arrays) override {
        publish(arrays);
        for (std::size_t i = 0; i < team_.members_.size(); ++i) {
            if (i == number_) continue;
            copy_rows(landing, i, arrays, team_.bounds_before_, [](uint32_t height) { return RowBand{0, height}; });
        }
    }
    void finish_taking_last() override { landing.wait(); }

    bool any(bool here) override { return team_.has_cpu_ && wait_at_barrier(here); }

    /// Copies rows of arrays of device `owner`, of which none is being changed.
    template <class RowsOf>
    void copy_rows(Queue& by, std::size_t owner, const std::vector<RowArray>& into, const std::vector<RowArray>& from,
                   const Bounds& bounds, const RowsOf& rows_of) {
        PERTEV_CHECK(into.size() == from.size());
        Queue& source = readers_[owner] ? *readers_[owner] : team_.members_[owner]->queue;
        for (std::size_t i = 0; i < into.size(); ++i) {
            const RowBand rows = common_rows(rows_between(bounds, owner, into[i].height), rows_of(into[i].height));
            if (rows.is_empty()) continue;
            const std::size_t first = rows.first * into[i].row_bytes;
            start_copy_between(by, static_cast<std::byte*>(into[i].data) + first, source,
                               static_cast<const std::byte*>(from[i].data) + first, rows.count() * into[i].row_bytes);
        }
    }

    Queue& queue;
    Queue landing; // takes rows of the last frame while the other queue works
    double waited = 0;

private:
    /// Shows the others this device's arrays, and waits for theirs. Arrays of two calls are kept, because others may
    /// still read those of the last one.
    void publish(const std::vector<RowArray>& arrays) {
        turn_ ^= 1;
        published_[turn_] = arrays;
        wait_at_barrier(false);
    }
    bool wait_at_barrier(bool here) {
        const Stopwatch watch;
        const bool any = team_.wait_at_barrier(here);
        waited += watch.seconds();
        return any;
    }
    template <class RowsOf>
    void copy_rows(Queue& by, std::size_t owner, const std::vector<RowArray>& into, const Bounds& bounds,
                   const RowsOf& rows_of) {
        copy_rows(by, owner, into, team_.members_[owner]->published_[turn_], bounds, rows_of);
    }

    RowTeam& team_;
    std::size_t number_;
    std::vector<std::optional<Queue>> readers_; // queues that read the GPUs' memory, for a CPU
    std::vector<RowArray> published_[2];
    int turn_ = 0; // is the same on all devices between two barriers
};

RowTeam::RowTeam(std::span<Queue* const> queues) : shares_(queues.size(), 1.0 / static_cast<double>(queues.size())) {
    for (std::size_t i = 0; i < queues.size(); ++i) {
        members_.push_back(std::make_unique<Member>(*this, i, *queues[i], queues));
        has_cpu_ |= !queues[i]->is_cuda();
    }
}

RowTeam::~RowTeam() = default;

RowExchange& RowTeam::member(std::size_t number) { return *members_[number]; }
double RowTeam::waited(std::size_t number) const { return members_[number]->waited; }

RowBand RowTeam::rows_between(const Bounds& bounds, std::size_t number, uint32_t height) {
    const auto row_at = [&](uint32_t bound) {
        if (bound == kWhole) return height;
        const uint64_t band = (uint64_t(bound) * height / kRowsOfBand + kWhole / 2) / kWhole;
        return std::min(static_cast<uint32_t>(band) * kRowsOfBand, height);
    };
    return {row_at(bounds[number]), row_at(bounds[number + 1])};
}

void RowTeam::begin() {
    bounds_before_ = bounds_;
    bounds_ = {0};
    double sum = 0;
    for (const double share : shares_) {
        sum += share;
        bounds_.push_back(std::min(static_cast<uint32_t>(std::lround(sum * kWhole)), kWhole));
    }
    bounds_.back() = kWhole;
    arrived_ = 0;
    any_ = is_abandoned_ = false;
    for (const auto& member : members_) member->begin();
}

void RowTeam::abandon() {
    const std::lock_guard lock(mutex_);
    is_abandoned_ = true;
    changed_.notify_all();
}

void RowTeam::end(std::span<const double> seconds) {
    std::vector<double> rates;
    for (std::size_t i = 0; i < shares_.size(); ++i) rates.push_back(shares_[i] / std::max(seconds[i], 1e-6));
    const double all = std::accumulate(rates.begin(), rates.end(), 0.0), count = static_cast<double>(shares_.size());
    double sum = 0;
    for (std::size_t i = 0; i < shares_.size(); ++i) {
        // Half of the way, because times vary.
        shares_[i] = std::max(0.5 * (shares_[i] + rates[i] / all), kLeastShare / count);
        sum += shares_[i];
    }
    for (double& share : shares_) share /= sum;
}

/// Waits until all threads have called this. Returns whether any passed true.
bool RowTeam::wait_at_barrier(bool here) {
    std::unique_lock lock(mutex_);
    if (is_abandoned_) throw FrameAbandoned();
    any_ |= here;
    if (++arrived_ == members_.size()) {
        arrived_ = 0;
        result_ = std::exchange(any_, false);
        ++barriers_;
        changed_.notify_all();
        return result_;
    }
    const uint64_t barrier = barriers_;
    changed_.wait(lock, [&] { return barriers_ != barrier || is_abandoned_; });
    if (barriers_ == barrier) throw FrameAbandoned();
    return result_;
}

void RowTeam::copy(std::size_t to, const std::vector<RowArray>& into, std::size_t owner,
                   const std::vector<RowArray>& from) {
    Member& member = *members_[to];
    member.copy_rows(member.queue, owner, into, from, bounds_, [](uint32_t height) { return RowBand{0, height}; });
}

} // namespace pertev
