#pragma once

// A port that speaks HTTP and WebSocket, by Boost.Beast, which only web_server.cpp includes. It handles requests,
// sizes and connections, and knows nothing about pictures: the page's files are in the program, and `WebEvents`
// handles everything else. It has its own thread, from which all events come.

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
/// Returns the files of the page, which embed_page.cmake embeds in the program.
std::vector<PageFile> page_files();

class WebEvents {
public:
    virtual ~WebEvents() = default;
    /// A WebSocket has opened. Returns false if there are too many.
    virtual bool opened(uint32_t client) = 0;
    /// A message has arrived. Returns why the client must be dropped, or empty.
    virtual std::string received(uint32_t client, std::string_view text) = 0;
    /// A text passed to send_text has been sent.
    virtual void text_was_sent(uint32_t client) = 0;
    virtual void closed(uint32_t client) = 0;
    /// Saves a picture as "png" or "exr". `reply` may be called from any thread, once, without bytes on failure.
    virtual void save(const std::string& format, std::function<void(std::vector<std::byte>)> reply) = 0;
    /// Called regularly. Returns the clients that must be dropped.
    virtual std::vector<uint32_t> tick() = 0;
};

struct WebLimits {
    std::size_t connections = 64;
    uint32_t header_bytes = 8192, message_bytes = 1024;
    int patience_s = 10; // for a request to arrive, or an answer to be sent
    int silence_s = 30;  // for a WebSocket that does not even answer a ping
};

class WebServer {
public:
    /// Listens at once; port 0 selects any free port. `files` and `events` outlive it. Throws Error(BadInput) if the
    /// host and port are unavailable.
    WebServer(const std::string& host, uint16_t port, ServerIdentity identity, std::vector<PageFile> files,
              WebEvents& events, const WebLimits& limits = {});
    /// Says goodbye to all clients and ends.
    ~WebServer();
    WebServer(const WebServer&) = delete;
    WebServer& operator=(const WebServer&) = delete;

    uint16_t port() const;

    // Any thread may call these. They do nothing for a client that is gone.
    void send_text(uint32_t client, std::string text);
    void send_picture(uint32_t client, std::shared_ptr<const std::vector<uint8_t>> message);

private:
    struct Inside;
    std::unique_ptr<Inside> inside_;
};

} // namespace pertev
