#include "apps/viewer/request_checks.h"

#include <algorithm>

#include <fmt/format.h>

#include "apps/viewer/access_token.h"

namespace pertev {
namespace {

constexpr std::size_t kLongestTarget = 1024; // bytes; ours are far shorter

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool equal_in_any_case(std::string_view a, std::string_view b) {
    return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

bool is_port(std::string_view text) {
    return text.size() <= 5 && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

bool is_name_letter(char c) {
    return (c >= '0' && c <= '9') || (lower(c) >= 'a' && lower(c) <= 'z') || c == '-' || c == '.' || c == '_';
}

/// --host in the form of a Host header: an IPv6 address has brackets there.
std::string as_header(std::string_view own) {
    const bool is_ipv6 = own.find(':') != std::string_view::npos && !own.starts_with('[');
    return is_ipv6 ? "[" + std::string(own) + "]" : std::string(own);
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
    return text;
}

/// The value of the only part "name=value", where `separator` separates parts.
std::optional<std::string_view> only_value(std::string_view text, char separator, std::string_view name) {
    std::optional<std::string_view> found;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(separator), text.size());
        const std::string_view part = trimmed(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::size_t equals = part.find('=');
        if (equals == std::string_view::npos || part.substr(0, equals) != name) continue;
        if (found) return std::nullopt;
        found = part.substr(equals + 1);
    }
    return found;
}

bool is_plain_target(std::string_view target) {
    return !target.empty() && target.front() == '/' && target.size() <= kLongestTarget &&
           std::ranges::all_of(target, [](char c) { return c > ' ' && c < 0x7f; });
}

} // namespace

std::optional<std::string_view> host_of(std::string_view authority) {
    if (authority.empty() || authority.size() > 255) return std::nullopt;
    std::size_t end = 0;
    if (authority.front() == '[') {
        end = authority.find(']');
        if (end == std::string_view::npos || end < 3) return std::nullopt;
        const bool is_address = std::ranges::all_of(authority.substr(1, end - 1), [](char c) {
            return (c >= '0' && c <= '9') || (lower(c) >= 'a' && lower(c) <= 'f') || c == ':' || c == '.';
        });
        if (!is_address) return std::nullopt;
        ++end;
    } else {
        while (end < authority.size() && is_name_letter(authority[end])) ++end;
        if (end == 0) return std::nullopt;
    }
    if (end < authority.size()) {
        if (authority[end] != ':' || end + 1 == authority.size() || !is_port(authority.substr(end + 1))) {
            return std::nullopt;
        }
    }
    return authority.substr(0, end);
}

bool is_own_host(std::string_view header, std::string_view own) {
    const std::optional<std::string_view> host = host_of(header);
    if (!host) return false;
    for (const std::string_view known : {"localhost", "127.0.0.1", "[::1]"}) {
        if (equal_in_any_case(*host, known)) return true;
    }
    return !own.empty() && equal_in_any_case(*host, as_header(own));
}

bool is_same_origin(std::string_view origin, std::string_view host_header) {
    for (const std::string_view scheme : {"http://", "https://"}) { // https: a TLS proxy is in front
        if (origin.starts_with(scheme)) {
            return !host_header.empty() && equal_in_any_case(origin.substr(scheme.size()), host_header);
        }
    }
    return false;
}

std::optional<std::string_view> cookie_named(std::string_view header, std::string_view name) {
    return only_value(header, ';', name);
}

std::optional<std::string_view> query_value(std::string_view query, std::string_view name) {
    return only_value(query, '&', name);
}

std::string cookie_text(const ServerIdentity& server) {
    return fmt::format("{}={}; Path=/; HttpOnly; {}", server.cookie_name, server.cookie_value,
                       server.in_frames ? "SameSite=None; Secure; Partitioned" : "SameSite=Strict");
}

RequestVerdict check_request(const RequestText& request, const ServerIdentity& server) {
    RequestVerdict verdict;
    const auto refuse = [&](int status, const char* reason) {
        verdict.status = status;
        verdict.reason = reason;
        return verdict;
    };
    if (!request.is_single) return refuse(400, "A header occurs twice.");
    if (!is_own_host(request.host, server.host)) return refuse(403, "This server has another name.");
    if (request.method != "GET") return refuse(405, "Only GET is supported.");
    if (!is_plain_target(request.target)) return refuse(400, "Not a valid path.");
    // Browsers do not apply the same-origin rule to WebSockets, so the page's origin must be checked.
    if ((request.is_upgrade || !request.origin.empty()) && !is_same_origin(request.origin, request.host)) {
        return refuse(403, "Requests of another origin are refused.");
    }
    const std::size_t mark = std::min(request.target.find('?'), request.target.size());
    verdict.path = request.target.substr(0, mark);
    verdict.query = request.target.substr(std::min(mark + 1, request.target.size()));
    const std::optional<std::string_view> cookie = cookie_named(request.cookie, server.cookie_name);
    if (cookie && equal_in_constant_time(*cookie, server.cookie_value)) {
        verdict.status = 200;
        return verdict;
    }
    const std::optional<std::string_view> token = query_value(verdict.query, "token");
    if (verdict.path == "/" && !request.is_upgrade && token && equal_in_constant_time(*token, server.token)) {
        verdict.status = 200;
        verdict.gives_cookie = true;
        return verdict;
    }
    return refuse(403, "Open the address that pertev view printed: it contains the key.");
}

} // namespace pertev
