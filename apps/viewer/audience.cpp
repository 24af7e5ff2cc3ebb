#include "apps/viewer/audience.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "apps/viewer/panel_text.h"
#include "apps/viewer/request_text.h"
#include "base/json_text.h"

namespace pertev {
namespace {

constexpr std::size_t kMaxNotices = 8; // texts queued for one client; the oldest is dropped
constexpr double kGreeting = 10;       // seconds within which a client must say hello
constexpr double kRefusalEvery = 4;    // seconds between two answers to a client that does not steer
constexpr double kPiece = 0.2;         // seconds of the link that a piece of a PNG takes

} // namespace

bool Audience::open(uint32_t client, double now_s) {
    const std::lock_guard lock(mutex_);
    if (clients_.size() >= kMaxClients) return false;
    Client& entry = clients_[client];
    entry.opened_s = entry.counted_s = now_s;
    return true;
}

bool Audience::may_speak(Client& client, double now_s) {
    client.allowance = std::min(2 * kMessagesPerSecond,
                                client.allowance + kMessagesPerSecond * std::max(now_s - client.counted_s, 0.0));
    client.counted_s = now_s;
    client.allowance -= 1;
    return client.allowance >= 0;
}

std::string Audience::received(uint32_t id, std::string_view text, double now_s) {
    const std::lock_guard lock(mutex_);
    const auto found = clients_.find(id);
    if (found == clients_.end()) return "unknown";
    Client& client = found->second;
    if (!may_speak(client, now_s)) return "too many messages";
    std::optional<ClientMessage> message = parse_client_message(text);
    if (!message) return "this is not a message";
    if (!client.has_joined) {
        if (message->kind != MessageKind::Hello) return "no hello";
        client.has_joined = true;
        control_.join(id, message->key, now_s);
        clients_changed();
        inbox_.put(Joined{});
        return {};
    }
    if (message->kind == MessageKind::Hello) return "there was a second hello";
    if (message->kind == MessageKind::Ack) { // an acknowledgement of an outdated frame has no effect
        client.pace.acknowledged(message->frame, now_s, 1e-3 * static_cast<double>(message->milliseconds));
        changed_.notify_one();
        return {};
    }
    if (message->kind == MessageKind::RequestControl) {
        control_.request_control(id);
        clients_changed();
        return {};
    }
    if (message->kind == MessageKind::Hand) {
        if (control_.hand(id, message->client, now_s)) clients_changed();
        return {};
    }
    // A client that has just lost control may still send commands and is not dropped for that. Every client may
    // pick.
    if (!control_.steers(id)) note_request(id, client, *message, now_s);
    const bool may = control_.steers(id) || (message->kind == MessageKind::Pick && message->use == PickUse::Show);
    if (may && !inbox_.put(Steer{id, *std::move(message)}) && !inbox_.is_closed()) return "too many messages wait";
    return {};
}

/// Sends a client that does not steer the reason why its command is ignored, and the steering client the request.
void Audience::note_request(uint32_t id, Client& client, const ClientMessage& message, double now_s) {
    if (message.kind == MessageKind::Pick && message.use == PickUse::Show) return; // anyone may do that
    const std::string request = request_text(message);
    const ControlHolder::Request is =
        request.empty() ? ControlHolder::Request::None : control_.request(id, request, now_s);
    if (is == ControlHolder::Request::None) return;
    if (is == ControlHolder::Request::New) clients_changed();
    if (now_s - client.refused_at_s < kRefusalEvery) return; // a drag consists of many messages
    client.refused_at_s = now_s;
    const std::string why =
        control_.holder() != 0
            ? fmt::format("viewer {} steers, so this page cannot {}. Viewer {} sees your request and can hand over",
                          control_.holder(), request, control_.holder())
            : "the viewer that steered has left and may return within seconds. \"request control\" takes over";
    put_text(client, notice_text("why", why));
    changed_.notify_one();
}

void Audience::put_text(Client& client, std::string text) {
    if (client.notices.size() >= kMaxNotices) client.notices.pop_front();
    client.notices.push_back(std::move(text));
}

void Audience::text_was_sent(uint32_t client) {
    const std::lock_guard lock(mutex_);
    const auto found = clients_.find(client);
    if (found != clients_.end()) found->second.text_under_way = false;
    changed_.notify_one();
}

void Audience::close(uint32_t client, double now_s) {
    const std::lock_guard lock(mutex_);
    clients_.erase(client);
    control_.leave(client, now_s);
    clients_changed();
}

std::vector<uint32_t> Audience::tick(double now_s) {
    const std::lock_guard lock(mutex_);
    if (control_.tick(now_s)) clients_changed();
    std::vector<uint32_t> mute;
    for (const auto& [id, client] : clients_) {
        if (!client.has_joined && now_s - client.opened_s > kGreeting) mute.push_back(id);
    }
    return mute;
}

void Audience::clients_changed() {
    for (auto& [id, client] : clients_) client.wants_clients = true;
    changed_.notify_one();
}

void Audience::publish(ShownFrame frame, uint32_t input) {
    const std::lock_guard lock(mutex_);
    latest_ = std::make_shared<const PublishedFrame>(PublishedFrame{std::move(frame), ++published_, input});
    changed_.notify_one();
}

void Audience::report_state(std::string text) {
    const std::lock_guard lock(mutex_);
    state_ = std::move(text);
    ++state_number_;
    changed_.notify_one();
}

void Audience::notify(uint32_t to, const std::string& text) {
    const std::lock_guard lock(mutex_);
    for (auto& [id, client] : clients_) {
        if (to != 0 && id != to) continue;
        put_text(client, text);
    }
    changed_.notify_one();
}

bool Audience::is_anyone_there() const {
    const std::lock_guard lock(mutex_);
    return std::ranges::any_of(clients_, [](const auto& entry) { return entry.second.has_joined; });
}

bool Audience::is_behind(double now_s) const {
    const std::lock_guard lock(mutex_);
    return latest_ != nullptr && std::ranges::any_of(clients_, [&](const auto& entry) {
               const Client& client = entry.second;
               return client.has_joined && client.seen < latest_->number && client.pace.may_send(now_s);
           });
}

std::string Audience::clients_text(uint32_t you) const {
    std::string people;
    for (const ControlHolder::Seat& seat : control_.seats()) {
        people += fmt::format(R"({}{{"id":{},"asks":{},"request":{}}})", people.empty() ? "" : ",", seat.client,
                              seat.wants_control, json_string(seat.request));
    }
    return fmt::format(R"({{"type":"people","you":{},"steers":{},"people":[{}]}})", you, control_.holder(), people);
}

std::optional<SendJob> Audience::text_job(uint32_t id, Client& client) {
    if (client.text_under_way) return std::nullopt;
    SendJob job;
    job.client = id;
    if (client.wants_welcome) {
        client.wants_welcome = false;
        job.text = welcome_;
    } else if (client.wants_clients) {
        client.wants_clients = false;
        job.text = clients_text(id);
    } else if (!client.notices.empty()) {
        job.text = std::move(client.notices.front());
        client.notices.pop_front();
    } else if (client.state_seen != state_number_) {
        client.state_seen = state_number_;
        job.text = state_;
    } else {
        return std::nullopt;
    }
    client.text_under_way = true;
    return job;
}

std::optional<SendJob> Audience::picture_job(uint32_t id, Client& client, double now_s) {
    if (latest_ == nullptr || !client.pace.may_send(now_s)) return std::nullopt;
    SendJob job;
    job.client = id;
    job.picture = latest_;
    job.quality = client.pace.quality();
    job.scale = client.pace.scale();
    if (client.seen < latest_->number) {
        client.has_png = false;
        client.offset = 0;
        return job;
    }
    // Sends the last picture losslessly after everything before it has arrived.
    if (!latest_->frame.is_final || client.has_png || !client.pace.is_idle()) return std::nullopt;
    job.is_piece = true;
    job.offset = client.offset;
    job.piece_bytes = client.pace.piece_bytes(kPiece);
    return job;
}

/// Round robin, starting after the client served last.
std::optional<SendJob> Audience::job_for_anyone(double now_s) {
    std::vector<uint32_t> order;
    for (const auto& [id, client] : clients_) order.push_back(id);
    std::ranges::rotate(order, std::ranges::upper_bound(order, last_served_));
    for (const uint32_t id : order) {
        Client& client = clients_[id];
        if (!client.has_joined) continue;
        std::optional<SendJob> job = text_job(id, client);
        if (!job) job = picture_job(id, client, now_s);
        if (!job) continue;
        last_served_ = id;
        return job;
    }
    return std::nullopt;
}

/// Time when the first held-back picture may leave; infinity if there is none.
double Audience::next_send_at_s(double now_s) const {
    double at_s = std::numeric_limits<double>::infinity();
    for (const auto& [id, client] : clients_) {
        if (const double may_s = client.pace.may_send_at_s(); client.has_joined && may_s > now_s) {
            at_s = std::min(at_s, may_s);
        }
    }
    return at_s;
}

std::optional<SendJob> Audience::next_job(std::chrono::milliseconds timeout, const std::function<double()>& now_s) {
    std::unique_lock lock(mutex_);
    const double end_s = now_s() + std::chrono::duration<double>(timeout).count();
    while (true) {
        const double now = now_s();
        std::optional<SendJob> job = job_for_anyone(now);
        if (job || now >= end_s) return job;
        changed_.wait_for(lock, std::chrono::duration<double>(std::min(end_s, next_send_at_s(now)) - now));
    }
}

uint32_t Audience::picture_leaves(const SendJob& job, std::size_t bytes, std::size_t total_bytes, double now_s) {
    const std::lock_guard lock(mutex_);
    ++serial_;
    const auto found = clients_.find(job.client);
    if (found == clients_.end()) return serial_;
    Client& client = found->second;
    client.seen = job.picture->number;
    if (job.is_piece) {
        client.offset = job.offset + bytes;
        client.has_png = client.offset >= total_bytes;
    }
    client.pace.sent(serial_, bytes, now_s, job.is_piece);
    return serial_;
}

std::vector<Audience::LinkNumbers> Audience::links() const {
    const std::lock_guard lock(mutex_);
    std::vector<LinkNumbers> links;
    for (const auto& [id, client] : clients_) {
        links.push_back({id, client.pace.quality(), client.pace.scale(), client.pace.round_trip_s(),
                         client.pace.bytes_per_second()});
    }
    return links;
}

} // namespace pertev
