#include "apps/viewer/control_holder.h"

#include <algorithm>
#include <utility>

namespace pertev {

void ControlHolder::give(uint32_t client) {
    holder_ = client;
    kept_for_.clear();
    for (Seat& seat : seats_) {
        if (seat.client != client) continue;
        seat.wants_control = false;
        seat.request.clear();
    }
}

void ControlHolder::join(uint32_t client, const std::string& key, double now_s) {
    const auto holder = std::ranges::find(seats_, holder_, &Seat::client);
    const bool held_it = holder != seats_.end() && !key.empty() && holder->key == key;
    seats_.push_back({client, key, false, {}, 0});
    if (held_it) return give(client);
    tick(now_s);
    if (holder_ != 0) return;
    if (kept_for_.empty() || (!key.empty() && key == kept_for_)) give(client);
}

void ControlHolder::leave(uint32_t client, double now_s) {
    const auto seat = std::ranges::find(seats_, client, &Seat::client);
    if (seat == seats_.end()) return;
    if (holder_ == client) {
        holder_ = 0;
        kept_for_ = seat->key;
        gone_s_ = now_s;
    }
    seats_.erase(seat);
    tick(now_s);
}

void ControlHolder::request_control(uint32_t client) {
    const auto seat = std::ranges::find(seats_, client, &Seat::client);
    if (seat == seats_.end() || holder_ == client) return;
    seat->wants_control = true;
    if (holder_ == 0) give(client);
}

bool ControlHolder::hand(uint32_t from, uint32_t to, double now_s) {
    if (!steers(from) || std::ranges::find(seats_, to, &Seat::client) == seats_.end()) return false;
    give(to);
    handed_by_ = from;
    handed_s_ = now_s;
    return true;
}

ControlHolder::Request ControlHolder::request(uint32_t client, const std::string& what, double now_s) {
    const auto seat = std::ranges::find(seats_, client, &Seat::client);
    if (seat == seats_.end() || steers(client)) return Request::None;
    if (client == handed_by_ && now_s - handed_s_ < kHandingOver) return Request::None;
    seat->requested_s = now_s;
    return std::exchange(seat->request, what) == what ? Request::Known : Request::New;
}

bool ControlHolder::tick(double now_s) {
    bool has_changed = false;
    for (Seat& seat : seats_) {
        if (seat.request.empty() || now_s - seat.requested_s < kRequestStays) continue;
        seat.request.clear();
        has_changed = true;
    }
    if (holder_ != 0 || seats_.empty()) return has_changed;
    const bool waits = !kept_for_.empty() && now_s - gone_s_ < kPatience;
    if (waits) return has_changed;
    give(seats_.front().client);
    return true;
}

} // namespace pertev
