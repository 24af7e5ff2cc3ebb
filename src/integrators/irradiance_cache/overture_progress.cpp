#include "integrators/irradiance_cache/overture_progress.h"

#include <algorithm>
#include <cmath>

#include "integrators/irradiance_cache/overture_grid.h"

namespace pertev {
namespace {

constexpr double kNearlyAll = 0.999;

constexpr uint32_t kFewSubpaths = 256; // too few paths for a reliable share

double next_fall(double fall) { return fall * std::sqrt(fall) * std::sqrt(std::sqrt(fall)); }

} // namespace

uint32_t OvertureProgress::grid_count(uint32_t round) const {
    return make_overture_grid(round, width_, height_).count();
}

/// Expected rays of the rounds from `round` on, if the share `wanting` of the previous grid requested records.
double OvertureProgress::rays_from(uint32_t round, double wanting) const {
    double rays = 0, capacity = static_cast<double>(capacity_) - records_ - wanted_, falls_by = falls_by_;
    for (; round < kOvertureRounds; ++round) {
        const double subpaths = grid_count(round);
        falls_by = next_fall(falls_by);
        wanting *= falls_by;
        const double records = std::min(wanting * subpaths, std::max(capacity, 0.0));
        capacity -= records;
        rays += subpaths * rays_a_subpath_ + records * rays_a_record_;
    }
    return rays;
}

void OvertureProgress::begin_subpaths(uint64_t rays) {
    if (wanted_ > 0) rays_a_record_ = static_cast<double>(rays - began_at_) / wanted_;
    records_ += wanted_;
    wanted_ = 0;
    if (has_begun_) ++round_;
    has_begun_ = true;
    began_at_ = rays;
    expected_ = grid_count(round_) * rays_a_subpath_;
    later_ = rays_from(round_, wanting_) - expected_;
}

void OvertureProgress::begin_records(uint32_t wanted, uint64_t rays) {
    if (const uint32_t subpaths = grid_count(round_); subpaths > 0) {
        rays_a_subpath_ = static_cast<double>(rays - began_at_) / subpaths;
        const double wanting = static_cast<double>(wanted) / subpaths;
        falls_by_ = subpaths < kFewSubpaths ? 1 : wanting_ > 0 ? std::min(wanting / wanting_, 1.0) : 0;
        wanting_ = wanting;
    }
    wanted_ = wanted;
    began_at_ = rays;
    expected_ = wanted * rays_a_record_;
    later_ = rays_from(round_ + 1, wanting_);
}

double OvertureProgress::share(uint64_t rays) {
    const double left = std::max(expected_ - static_cast<double>(rays - began_at_), 0.0) + later_;
    const auto done = static_cast<double>(rays);
    if (done + left > 0) share_ = std::max(share_, std::min(done / (done + left), kNearlyAll));
    return share_;
}

} // namespace pertev
