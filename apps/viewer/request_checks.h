#pragma once

// Checks who may make requests to the viewer: pure functions of a request's text, so that they can be tested and
// fuzzed without a network. A stranger's page in the same browser can send requests here, so the requested name
// (Host: DNS rebinding), the requesting page (Origin) and a secret are checked separately.

#include <optional>
#include <string>
#include <string_view>

namespace pertev {

/// Identity of a running viewer.
struct ServerIdentity {
    std::string host;         // value of --host
    std::string token;        // part of the printed address
    std::string cookie_name;  // contains an id of this server, because all ports of a name share cookies
    std::string cookie_value; // the value that replaces the token
    bool in_frames = false;   // whether pages of others may show this one in a frame
};

/// A request's text. Missing headers are empty.
struct RequestText {
    std::string_view method, target;
    std::string_view host, origin, cookie;
    bool is_single = true;   // none of these headers is repeated
    bool is_upgrade = false; // requests a WebSocket
};

struct RequestVerdict {
    int status = 403;          // 200: answer it; 403, 404, 405 or 400: refuse
    std::string reason;        // why it is refused, in plain words
    std::string path;          // "/main.js"; without the query
    std::string query;         // after the "?", undecoded
    bool gives_cookie = false; // the token was right, so the cookie is set
};

/// The host of "name:port", "1.2.3.4" or "[::1]:80", brackets included; nothing for an invalid one, for one with a
/// user name, and for a port that is no number.
std::optional<std::string_view> host_of(std::string_view authority);
/// Returns whether a Host header names this server: localhost, 127.0.0.1, [::1] or `own`, case-insensitive, with any
/// port.
bool is_own_host(std::string_view header, std::string_view own);
/// Returns whether an Origin header is the page of exactly this host and port.
bool is_same_origin(std::string_view origin, std::string_view host_header);
/// The value of the cookie with this name; nothing if there is none, or more than one.
std::optional<std::string_view> cookie_named(std::string_view header, std::string_view name);
/// The undecoded value of `name=` in "a=1&name=2"; nothing if there is none, or more than one.
std::optional<std::string_view> query_value(std::string_view query, std::string_view name);

/// The Set-Cookie header. In a frame, browsers send a cookie only if it says that it is for other sites' pages too; it
/// is partitioned, so that each of them has its own.
std::string cookie_text(const ServerIdentity& server);

/// Returns whether a request is answered, and why not. Does not throw.
RequestVerdict check_request(const RequestText& request, const ServerIdentity& server);

} // namespace pertev
