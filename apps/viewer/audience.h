#pragma once

// The clients: who is connected and who steers, what must be sent to each, and the capacity of its link. Thread-safe.
// Memory does not grow with a client that does not read: at most two pictures and one text are in flight to each, and
// only the newest picture and state are queued.

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "apps/viewer/control_holder.h"
#include "apps/viewer/frame_header.h"
#include "apps/viewer/frame_source.h"
#include "apps/viewer/inbox.h"
#include "apps/viewer/link_pace.h"

namespace pertev {

/// A picture that was published.
struct PublishedFrame {
    ShownFrame frame;
    uint32_t number = 0; // starts at 1
    uint32_t input = 0;
};

/// The next thing to send to one client.
struct SendJob {
    uint32_t client = 0;
    std::string text;                              // if not empty, this text
    std::shared_ptr<const PublishedFrame> picture; // otherwise this picture: as JPEG,
    int quality = 80;
    float scale = 1;
    bool is_piece = false; // sent as a piece of a PNG, not as a JPEG
    std::size_t offset = 0, piece_bytes = 0;
};

class Audience {
public:
    static constexpr std::size_t kMaxClients = 16;
    static constexpr double kMessagesPerSecond = 400; // per client, on average; bursts may have twice as many

    /// `inbox` outlives it. `welcome` is the first text that each client gets.
    Audience(Inbox& inbox, std::string welcome) : inbox_(inbox), welcome_(std::move(welcome)) {}

    // The network's thread calls these. Times are seconds of a steady clock.

    /// Returns false if there are too many clients.
    bool open(uint32_t client, double now_s);
    /// Handles a message. Returns empty on success, else why the client must be dropped.
    std::string received(uint32_t client, std::string_view text, double now_s);
    void text_was_sent(uint32_t client);
    void close(uint32_t client, double now_s);
    /// Must be called regularly. Returns the clients that have not said hello in time.
    std::vector<uint32_t> tick(double now_s);

    // The render's thread calls these.

    void publish(ShownFrame frame, uint32_t input);
    /// Sends the panel's state to all clients; a queued one is replaced.
    void report_state(std::string text);
    /// Sends an answer to one client; 0: to all.
    void notify(uint32_t client, const std::string& text);
    bool is_anyone_there() const;
    /// Returns whether some client is ready but has not got the last picture.
    bool is_behind(double now_s) const;

    // The thread that packs pictures calls these.

    /// Waits for something to send until the timeout. The result counts as in flight. `now_s` is the clock of the
    /// other functions' times.
    std::optional<SendJob> next_job(std::chrono::milliseconds timeout, const std::function<double()>& now_s);
    /// Records that an encoded picture is sent. `total_bytes` is the size of the whole file of a piece. Returns the
    /// number of the message.
    uint32_t picture_leaves(const SendJob& job, std::size_t bytes, std::size_t total_bytes, double now_s);
    /// Transfer time of the last picture, and its encoding; for the panel.
    struct LinkNumbers {
        uint32_t client;
        int quality;
        float scale;
        double round_trip_s, bytes_per_second;
    };
    std::vector<LinkNumbers> links() const;

private:
    struct Client {
        bool has_joined = false;
        double opened_s = 0;
        double allowance = 2 * kMessagesPerSecond, counted_s = 0;
        LinkPace pace;
        uint32_t seen = 0; // number of the last picture sent
        std::size_t offset = 0;
        bool has_png = false; // whether the client has the whole PNG of the last picture
        bool text_under_way = false, wants_welcome = true, wants_clients = true;
        uint64_t state_seen = 0;
        std::deque<std::string> notices;
        double refused_at_s = -1e9; // when it was last sent the reason why it cannot steer
    };
    std::string clients_text(uint32_t you) const;
    std::optional<SendJob> text_job(uint32_t id, Client& client);
    std::optional<SendJob> picture_job(uint32_t id, Client& client, double now_s);
    std::optional<SendJob> job_for_anyone(double now_s);
    double next_send_at_s(double now_s) const;
    void clients_changed();
    void put_text(Client& client, std::string text);
    bool may_speak(Client& client, double now_s);
    void note_request(uint32_t id, Client& client, const ClientMessage& message, double now_s);

    Inbox& inbox_;
    const std::string welcome_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::map<uint32_t, Client> clients_;
    uint32_t last_served_ = 0; // clients are served round robin
    ControlHolder control_;
    std::shared_ptr<const PublishedFrame> latest_;
    uint32_t published_ = 0, serial_ = 0;
    std::string state_;
    uint64_t state_number_ = 0;
};

} // namespace pertev
