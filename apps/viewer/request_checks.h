#pragma once

// Who may ask the viewer for what: pure functions of a request's text, so that they can be tested and fuzzed without a
// network. A page of a stranger in the same browser can send requests here, so the name that was asked for (Host: DNS
// rebinding), the page that asks (Origin) and a secret are looked at, each by itself.

#include <optional>
#include <string>
#include <string_view>

namespace pertev {

/// What makes one running viewer different from every other.
struct ServerIdentity {
    std::string host;         // of --host
    std::string token;        // stands in the printed address
    std::string cookie_name;  // carries an id of this server: cookies are shared by all ports of a name
    std::string cookie_value; // what the token is exchanged for
};

/// A request's text as it came. Missing headers are empty.
struct RequestText {
    std::string_view method, target;
    std::string_view host, origin, cookie;
    bool is_single = true;   // no header of these stands twice
    bool is_upgrade = false; // asks for a WebSocket
};

struct RequestVerdict {
    int status = 403;          // 200: answer it; 403, 404, 405 or 400: refuse
    std::string reason;        // for a refusal, plain words
    std::string path;          // "/main.js"; without the query
    std::string query;         // behind the "?", undecoded
    bool gives_cookie = false; // the token was right: set the cookie
};

/// The host of "name:port", "1.2.3.4" or "[::1]:80", brackets included; nothing for what is none, for a user's name in
/// it, and for a port that is no number.
std::optional<std::string_view> host_of(std::string_view authority);
/// Whether a Host header names this server: localhost, 127.0.0.1, [::1] or `own`, in any case, with any port.
bool is_own_host(std::string_view header, std::string_view own);
/// Whether an Origin header is the page of this very host and port.
bool is_same_origin(std::string_view origin, std::string_view host_header);
/// The value of the cookie of this name; nothing where there is none, or more than one.
std::optional<std::string_view> cookie_named(std::string_view header, std::string_view name);
/// The value of `name=` in "a=1&name=2"; nothing where there is none, or more than one. Not decoded.
std::optional<std::string_view> query_value(std::string_view query, std::string_view name);

/// Throws nothing.
RequestVerdict check_request(const RequestText& request, const ServerIdentity& server);

} // namespace pertev
