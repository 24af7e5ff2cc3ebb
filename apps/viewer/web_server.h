#pragma once

// One port that speaks HTTP and WebSocket, by Boost.Beast, which web_server.cpp alone sees. It knows requests, sizes
// and connections, and nothing of pictures: the page's files lie in the program, everything else is asked of
// `WebEvents`. It has one thread of its own, from which all events come.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/viewer/request_checks.h"

namespace pertev {

/// A file of the page, in the program.
struct PageFile {
    std::string_view path; // "/main.js"
    std::string_view type; // "text/javascript"
    std::string_view text;
};

class WebEvents {
public:
    virtual ~WebEvents() = default;
    /// A WebSocket opened. False: there are too many.
    virtual bool opened(uint32_t client) = 0;
    /// It says something. Not empty: why it is to be dropped.
    virtual std::string said(uint32_t client, std::string_view text) = 0;
    /// A text that was given to send_text has gone.
    virtual void text_was_sent(uint32_t client) = 0;
    virtual void closed(uint32_t client) = 0;
    /// A picture is to be saved as "png" or "exr". `reply` may be called from any thread, once; no bytes: that failed.
    virtual void save(const std::string& format, std::function<void(std::vector<std::byte>)> reply) = 0;
    /// Every now and then. Gives the clients that are to be dropped.
    virtual std::vector<uint32_t> tick() = 0;
};

struct WebLimits {
    std::size_t connections = 64;
    uint32_t header_bytes = 8192, message_bytes = 1024;
    int patience_s = 10; // for a request to come, or an answer to go
    int silence_s = 30;  // of a WebSocket that does not even answer a ping
};

class WebServer {
public:
    /// Listens at once; port 0 takes any that is free. `files` and `events` outlive it. Throws Error(BadInput) where
    /// that host and port cannot be had.
    WebServer(const std::string& host, uint16_t port, ServerIdentity identity, std::vector<PageFile> files,
              WebEvents& events, const WebLimits& limits = {});
    /// Says goodbye to everybody, and ends.
    ~WebServer();
    WebServer(const WebServer&) = delete;
    WebServer& operator=(const WebServer&) = delete;

    uint16_t port() const;

    // From any thread. To a client that is gone: nothing happens.
    void send_text(uint32_t client, std::string text);
    void send_picture(uint32_t client, std::shared_ptr<const std::vector<uint8_t>> message);

private:
    struct Inside;
    std::unique_ptr<Inside> inside_;
};

} // namespace pertev
