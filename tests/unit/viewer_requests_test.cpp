// Checks of requests to the viewer (apps/viewer/request_checks.h), and that no text breaks the checks.

#include <cstdlib>

#include <doctest/doctest.h>

#include "apps/viewer/access_token.h"
#include "apps/viewer/request_checks.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

using namespace pertev;
using namespace pertev::test;

namespace {

const ServerIdentity kServer = {"render1.lan", "0123456789abcdef", "pertev-1a2b", "fedcba9876543210"};

/// An accepted request. Each test invalidates one part of it.
RequestText good_request() {
    return {.method = "GET", .target = "/main.js", .host = "localhost:8080", .cookie = "pertev-1a2b=fedcba9876543210"};
}

} // namespace

TEST_CASE("the constant-time comparison agrees with the usual one") {
    CHECK(equal_in_constant_time("abc", "abc"));
    CHECK_FALSE(equal_in_constant_time("abd", "abc"));
    CHECK_FALSE(equal_in_constant_time("ab", "abc"));
    CHECK_FALSE(equal_in_constant_time("abcabc", "abc"));
    CHECK_FALSE(equal_in_constant_time("", "abc"));
    CHECK_FALSE(equal_in_constant_time("", ""));
}

TEST_CASE("tokens have the requested length and differ") {
    CHECK(make_token().size() == 32);
    CHECK(make_token(4).size() == 8);
    CHECK(make_token() != make_token());
}

TEST_CASE(
    "a given token comes from a file or the environment, and one that could be guessed or needs escapes is refused") {
    const auto refused = [](const std::string& text) {
        const std::filesystem::path file = scratch_folder() / "token";
        write_text(file, text);
        return is_about(thrown_error([&] { given_token(file); }), ErrorCode::BadInput, "token_file");
    };
    for (const char* text :
         {"", "\n", "0123456789abcde", "0123456789abcdef&", "0123456789 abcdef", "0123456789abcdef\nx"}) {
        CHECK_MESSAGE(refused(text), text);
    }
    CHECK(refused(std::string(129, 'a')));
    const std::filesystem::path file = scratch_folder() / "token";
    write_text(file, "ABCdef-_0123456789\r\n");
    CHECK(given_token(file) == "ABCdef-_0123456789");
    CHECK(given_token("") == "");
    ::setenv("PERTEV_TOKEN", "0123456789abcdef", 1);
    CHECK(given_token("") == "0123456789abcdef");
    CHECK(given_token(file) == "ABCdef-_0123456789");
    ::setenv("PERTEV_TOKEN", "short", 1);
    CHECK(is_about(thrown_error([] { given_token(""); }), ErrorCode::BadInput, "token_file"));
    ::unsetenv("PERTEV_TOKEN");
    CHECK(thrown_error([] { given_token("/nowhere/token"); }).has_value());
}

TEST_CASE("the server's names are accepted in any case and with any port, and others are not") {
    for (const char* host : {"localhost", "LOCALHOST:1", "127.0.0.1:8080", "[::1]", "[::1]:65535", "Render1.LAN:9"}) {
        CHECK_MESSAGE(is_own_host(host, "render1.lan"), host);
    }
    for (const char* host : {"", "evil.com", "localhost.evil.com", "localhost:", "localhost:80a", "127.0.0.1.evil.com",
                             "user@localhost", "localhost/", "::1", "[::1", "[::1]x", "[]", "127.0.0.2",
                             "localhost:123456", "local host", "localhost:80:80"}) {
        CHECK_MESSAGE(!is_own_host(host, "render1.lan"), host);
    }
    CHECK(is_own_host("[fe80::1]:80", "fe80::1"));
    CHECK_FALSE(is_own_host("render1.lan", "127.0.0.1"));
}

TEST_CASE("an origin is the same only with the same host and port") {
    CHECK(is_same_origin("http://localhost:8080", "localhost:8080"));
    CHECK(is_same_origin("http://LOCALHOST:8080", "localhost:8080"));
    CHECK(is_same_origin("https://viewer.lan", "viewer.lan"));
    for (const char* origin : {"", "null", "http://localhost:8081", "http://localhost", "ftp://localhost:8080",
                               "http://localhost:8080.evil.com", "localhost:8080", "http://"}) {
        CHECK_MESSAGE(!is_same_origin(origin, "localhost:8080"), origin);
    }
}

TEST_CASE("a cookie is found among others by its whole name, but not if it occurs twice") {
    CHECK(cookie_named("a=1; pertev-1=x; b=2", "pertev-1") == "x");
    CHECK(cookie_named("pertev-1=", "pertev-1") == "");
    CHECK(cookie_named("pertev-1=x=y", "pertev-1") == "x=y");
    CHECK_FALSE(cookie_named("xpertev-1=x", "pertev-1"));
    CHECK_FALSE(cookie_named("pertev-1=x; pertev-1=y", "pertev-1"));
    CHECK_FALSE(cookie_named("pertev-1", "pertev-1"));
    CHECK_FALSE(cookie_named("", "pertev-1"));
    CHECK(query_value("a=1&token=t", "token") == "t");
    CHECK_FALSE(query_value("token=t&token=t", "token"));
}

TEST_CASE("a request with the cookie is answered, and one with the token gets the cookie") {
    const RequestVerdict with_cookie = check_request(good_request(), kServer);
    CHECK(with_cookie.status == 200);
    CHECK(with_cookie.path == "/main.js");
    CHECK_FALSE(with_cookie.gives_cookie);

    RequestText first = good_request();
    first.cookie = "";
    first.target = "/?token=0123456789abcdef";
    CHECK(check_request(first, kServer).status == 200);
    CHECK(check_request(first, kServer).gives_cookie);
    first.target = "/?token=0123456789abcdee";
    CHECK(check_request(first, kServer).status == 403);
    first.target = "/main.js?token=0123456789abcdef"; // only the page accepts the token
    CHECK(check_request(first, kServer).status == 403);
    first.target = "/?token=";
    CHECK(check_request(first, kServer).status == 403);
}

TEST_CASE("each invalid part of a request refuses it") {
    const auto status_with = [](auto spoil) {
        RequestText request = good_request();
        spoil(request);
        const RequestVerdict verdict = check_request(request, kServer);
        CHECK(verdict.reason.empty() == (verdict.status == 200));
        return verdict.status;
    };
    CHECK(status_with([](RequestText& r) { r.cookie = ""; }) == 403);
    CHECK(status_with([](RequestText& r) { r.cookie = "pertev-1a2b=fedcba987654321"; }) == 403);
    CHECK(status_with([](RequestText& r) { r.cookie = "pertev-9999=fedcba9876543210"; }) == 403);
    CHECK(status_with([](RequestText& r) { r.host = "evil.com"; }) == 403);
    CHECK(status_with([](RequestText& r) { r.host = ""; }) == 403);
    CHECK(status_with([](RequestText& r) { r.origin = "http://evil.com"; }) == 403);
    CHECK(status_with([](RequestText& r) { r.origin = "http://localhost:8080"; }) == 200);
    CHECK(status_with([](RequestText& r) { r.is_upgrade = true; }) == 403); // has no origin
    CHECK(status_with([](RequestText& r) { r.method = "POST"; }) == 405);
    CHECK(status_with([](RequestText& r) { r.is_single = false; }) == 400);
    CHECK(status_with([](RequestText& r) { r.target = "main.js"; }) == 400);
    CHECK(status_with([](RequestText& r) { r.target = "/a b"; }) == 400);
    CHECK(status_with([](RequestText& r) { r.target = ""; }) == 400);
}

TEST_CASE("no random request crashes the checks or is accepted") {
    test::Random random(3);
    const std::string_view pieces[] = {"localhost", ":", "8080", "[::1]", "http://", "pertev-1a2b", "=", ";", " ", "/",
                                       "?token=",   "&", "evil", "\x80",  "\0x",     "GET",         "]", "[", "%", "."};
    const auto text = [&] {
        std::string made;
        for (uint32_t i = random.below(8); i > 0; --i) made += pieces[random.below(std::size(pieces))];
        return made;
    };
    const int rounds = static_cast<int>(test::effort(10'000, 1'000'000));
    for (int i = 0; i < rounds; ++i) {
        const std::string method = text(), target = text(), host = text(), origin = text(), cookie = text();
        RequestText request = good_request();
        request.cookie = cookie;
        if (i % 2 == 0) request.method = method;
        if (i % 3 == 0) request.target = target;
        if (i % 5 == 0) request.host = host;
        if (i % 7 == 0) request.origin = origin;
        REQUIRE(check_request(request, kServer).status != 200); // none of the pieces contains the secret
    }
}
