#include "apps/viewer/web_server.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <map>
#include <optional>
#include <thread>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include <fmt/format.h>

#include "base/error.h"

namespace pertev {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using boost::system::error_code;

using Response = http::response<http::string_body>;
using Request = http::request<http::empty_body>;

std::string_view view_of(boost::beast::string_view text) { return {text.data(), text.size()}; }

/// Adds security headers to an answer: no other site may use it, only our scripts run, and no other page shows it in a
/// frame unless `in_frames`.
void add_safety(Response& response, bool in_frames) {
    response.set(http::field::server, "pertev");
    response.set(http::field::cache_control, "no-store");
    response.set("Content-Security-Policy",
                 fmt::format("default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
                             "connect-src 'self'; base-uri 'none'; form-action 'none'{}",
                             in_frames ? "" : "; frame-ancestors 'none'"));
    response.set("X-Content-Type-Options", "nosniff");
    if (!in_frames) response.set("X-Frame-Options", "DENY");
    response.set("Referrer-Policy", "no-referrer");
    response.set("Cross-Origin-Opener-Policy", "same-origin");
    response.set("Cross-Origin-Resource-Policy", "same-origin");
}

Response answer(unsigned status, std::string_view type, std::string body) {
    Response response(static_cast<http::status>(status), 11);
    response.set(http::field::content_type, boost::beast::string_view(type.data(), type.size()));
    response.body() = std::move(body);
    return response;
}

Response refusal(int status, const std::string& reason) {
    return answer(static_cast<unsigned>(status), "text/plain; charset=utf-8", reason + "\n");
}

} // namespace

struct WebServer::Inside {
    class Connection;
    class Socket;

    Inside(ServerIdentity given_identity, std::vector<PageFile> given_files, WebEvents& given_events,
           const WebLimits& given_limits)
        : identity(std::move(given_identity)), files(std::move(given_files)), events(given_events),
          limits(given_limits) {}

    void listen(const std::string& host, uint16_t port);
    void accept();
    void tick();
    void stop();

    const ServerIdentity identity;
    const std::vector<PageFile> files;
    WebEvents& events;
    const WebLimits limits;
    // Destroyed after the context, which closes the remaining connections.
    std::atomic<std::size_t> connections = 0;
    uint32_t last_client = 0;
    std::map<uint32_t, std::weak_ptr<Socket>> sockets;
    bool is_stopping = false;
    asio::io_context context{1};
    tcp::acceptor acceptor{context};
    asio::steady_timer timer{context};
    std::thread thread;
};

/// An open WebSocket.
class WebServer::Inside::Socket : public std::enable_shared_from_this<Socket> {
public:
    Socket(Inside& server, beast::tcp_stream stream, uint32_t client)
        : server_(server), stream_(std::move(stream)), client_(client) {}
    ~Socket() { --server_.connections; }

    void accept(const Request& request) {
        stream_.set_option(websocket::stream_base::timeout{std::chrono::seconds(server_.limits.patience_s),
                                                           std::chrono::seconds(server_.limits.silence_s), true});
        stream_.set_option(websocket::stream_base::decorator(
            [](websocket::response_type& response) { response.set(http::field::server, "pertev"); }));
        stream_.read_message_max(server_.limits.message_bytes);
        stream_.auto_fragment(false);
        stream_.async_accept(request, [self = shared_from_this()](error_code fault) {
            if (fault) return self->leave();
            self->is_open_ = true;
            if (!self->server_.events.opened(self->client_)) {
                self->is_counted_ = false;
                return self->drop(websocket::close_code::try_again_later, "there are too many clients");
            }
            self->is_counted_ = true;
            self->read();
        });
    }

    struct Message {
        std::string text;
        std::shared_ptr<const std::vector<uint8_t>> picture; // used if there is no text
    };

    void send(Message message) {
        if (!is_open_) return;
        waiting_.push_back(std::move(message)); // senders wait for acknowledgements, so these are few
        if (waiting_.size() == 1) write();
    }

    void drop(websocket::close_code code, const std::string& reason) {
        if (!std::exchange(is_open_, false)) return;
        leave();
        stream_.async_close({code, reason}, [self = shared_from_this()](error_code) {});
    }

private:
    void leave() {
        if (std::exchange(is_counted_, false)) server_.events.closed(client_);
        server_.sockets.erase(client_);
    }

    void fail() {
        is_open_ = false;
        leave();
        error_code ignored;
        beast::get_lowest_layer(stream_).socket().close(ignored);
    }

    void read() {
        stream_.async_read(buffer_, [self = shared_from_this()](error_code fault, std::size_t) {
            if (fault) return self->fail();
            const auto data = self->buffer_.cdata();
            const std::string text(static_cast<const char*>(data.data()), data.size());
            self->buffer_.consume(self->buffer_.size());
            const std::string why = self->stream_.got_text() ? self->server_.events.received(self->client_, text)
                                                             : "only text messages are read";
            if (!why.empty()) return self->drop(websocket::close_code::policy_error, why);
            if (self->is_open_) self->read();
        });
    }

    void write() {
        const Message& message = waiting_.front();
        stream_.binary(message.picture != nullptr);
        const auto bytes = message.picture ? asio::buffer(*message.picture) : asio::buffer(message.text);
        stream_.async_write(bytes, [self = shared_from_this()](error_code fault, std::size_t) {
            if (fault) return self->fail();
            const bool was_text = self->waiting_.front().picture == nullptr;
            self->waiting_.pop_front();
            if (was_text && self->is_counted_) self->server_.events.text_was_sent(self->client_);
            if (!self->waiting_.empty() && self->is_open_) self->write();
        });
    }

    Inside& server_;
    websocket::stream<beast::tcp_stream> stream_;
    beast::flat_buffer buffer_;
    std::deque<Message> waiting_;
    uint32_t client_;
    bool is_open_ = false, is_counted_ = false;
};

/// An HTTP connection, until it becomes a WebSocket.
class WebServer::Inside::Connection : public std::enable_shared_from_this<Connection> {
public:
    Connection(Inside& server, tcp::socket socket) : server_(server), stream_(std::move(socket)) {
        ++server_.connections;
        error_code ignored;
        stream_.socket().set_option(tcp::no_delay(true), ignored);
    }
    ~Connection() {
        if (!is_handed_on_) --server_.connections;
    }

    void read() {
        parser_.emplace();
        parser_->header_limit(server_.limits.header_bytes);
        parser_->body_limit(0);
        stream_.expires_after(std::chrono::seconds(server_.limits.patience_s));
        http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code fault, std::size_t) {
            if (!fault) return self->handle();
            if (fault == http::error::header_limit || fault == http::error::body_limit) {
                return self->reply(refusal(413, "The request is too large."), false);
            }
            if (fault == http::error::end_of_stream || fault == beast::error::timeout ||
                fault.category() != http::make_error_code(http::error::bad_method).category()) {
                return self->close();
            }
            self->reply(refusal(400, "Not an HTTP request."), false);
        });
    }

private:
    void handle() {
        const Request request = parser_->release();
        const RequestVerdict verdict = check_request(text_of(request), server_.identity);
        const bool keeps = request.keep_alive();
        if (verdict.status != 200) return reply(refusal(verdict.status, verdict.reason), false);
        if (verdict.path == "/socket") {
            if (!websocket::is_upgrade(request)) return reply(refusal(400, "A WebSocket is expected here."), keeps);
            return become_socket(request);
        }
        if (websocket::is_upgrade(request)) return reply(refusal(404, "No WebSocket is served here."), keeps);
        if (verdict.path == "/save") return save(verdict, keeps);
        const auto file = std::ranges::find(server_.files, std::string_view(verdict.path), &PageFile::path);
        if (file == server_.files.end()) return reply(refusal(404, "Not found."), keeps);
        Response response = answer(200, file->type, std::string(file->text));
        if (verdict.gives_cookie) response.set(http::field::set_cookie, cookie_text(server_.identity));
        reply(std::move(response), keeps);
    }

    RequestText text_of(const Request& request) const {
        RequestText text;
        text.method = view_of(request.method_string());
        text.target = view_of(request.target());
        text.host = view_of(request[http::field::host]);
        text.origin = view_of(request[http::field::origin]);
        text.cookie = view_of(request[http::field::cookie]);
        for (const auto name : {http::field::host, http::field::origin, http::field::cookie}) {
            text.is_single = text.is_single && request.count(name) <= 1;
        }
        text.is_upgrade = request.count(http::field::upgrade) > 0;
        return text;
    }

    void become_socket(const Request& request) {
        stream_.expires_never();
        is_handed_on_ = true;
        const uint32_t client = ++server_.last_client;
        const auto socket = std::make_shared<Socket>(server_, std::move(stream_), client);
        server_.sockets[client] = socket;
        socket->accept(request);
    }

    void save(const RequestVerdict& verdict, bool keeps) {
        const std::string format(query_value(verdict.query, "format").value_or(""));
        if (format != "png" && format != "exr") return reply(refusal(404, "Pictures are saved as png or exr."), keeps);
        stream_.expires_never(); // the picture may take its time
        server_.events.save(format, [self = shared_from_this(), format, keeps](std::vector<std::byte> bytes) {
            asio::post(self->server_.context, [self, format, keeps, bytes = std::move(bytes)] {
                if (bytes.empty()) return self->reply(refusal(500, "There is no picture to save."), keeps);
                Response response = answer(200, format == "png" ? "image/png" : "image/x-exr",
                                           std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
                response.set(http::field::content_disposition, "attachment; filename=\"pertev." + format + "\"");
                self->reply(std::move(response), keeps);
            });
        });
    }

    void reply(Response response, bool keeps) {
        add_safety(response, server_.identity.in_frames);
        response.keep_alive(keeps);
        response.prepare_payload();
        response_ = std::move(response);
        stream_.expires_after(std::chrono::seconds(server_.limits.patience_s));
        http::async_write(stream_, response_, [self = shared_from_this(), keeps](error_code fault, std::size_t) {
            if (fault || !keeps) return self->close();
            self->read();
        });
    }

    void close() {
        error_code ignored;
        stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
        stream_.socket().close(ignored);
    }

    Inside& server_;
    beast::tcp_stream stream_;
    beast::flat_buffer buffer_;
    std::optional<http::request_parser<http::empty_body>> parser_;
    Response response_;
    bool is_handed_on_ = false;
};

void WebServer::Inside::listen(const std::string& host, uint16_t port) {
    error_code fault;
    const std::string plain = host.starts_with('[') && host.ends_with(']') ? host.substr(1, host.size() - 2) : host;
    const auto found = tcp::resolver(context).resolve(plain, std::to_string(port), tcp::resolver::passive, fault);
    const auto fail = [&] {
        throw Error(ErrorCode::BadInput, "host", host,
                    fmt::format("cannot listen there with `port={}`: {}", port, fault.message()));
    };
    if (fault || found.empty()) fail();
    const tcp::endpoint endpoint = found.begin()->endpoint();
    acceptor.open(endpoint.protocol(), fault);
    if (fault) fail();
    acceptor.set_option(asio::socket_base::reuse_address(true), fault);
    acceptor.bind(endpoint, fault);
    if (fault) fail();
    acceptor.listen(asio::socket_base::max_listen_connections, fault);
    if (fault) fail();
}

void WebServer::Inside::accept() {
    acceptor.async_accept([this](error_code fault, tcp::socket socket) {
        if (fault == asio::error::operation_aborted || is_stopping) return;
        // If there are too many connections, it is closed at once; if file handles are exhausted, accepting pauses.
        if (!fault && connections < limits.connections) {
            std::make_shared<Connection>(*this, std::move(socket))->read();
        }
        accept();
    });
}

void WebServer::Inside::tick() {
    timer.expires_after(std::chrono::milliseconds(500));
    timer.async_wait([this](error_code fault) {
        if (fault || is_stopping) return;
        for (const uint32_t client : events.tick()) {
            const auto found = sockets.find(client);
            const auto socket = found == sockets.end() ? nullptr : found->second.lock();
            if (socket) socket->drop(websocket::close_code::policy_error, "no hello");
        }
        tick();
    });
}

void WebServer::Inside::stop() {
    is_stopping = true;
    error_code ignored;
    acceptor.close(ignored);
    timer.cancel();
    const auto all = sockets; // dropping modifies the list
    for (const auto& [client, socket] : all) {
        if (const auto open = socket.lock()) open->drop(websocket::close_code::going_away, "pertev view has ended");
    }
    timer.expires_after(std::chrono::milliseconds(150)); // for goodbyes to be sent
    timer.async_wait([this](error_code) { context.stop(); });
}

WebServer::WebServer(const std::string& host, uint16_t port, ServerIdentity identity, std::vector<PageFile> files,
                     WebEvents& events, const WebLimits& limits)
    : inside_(std::make_unique<Inside>(std::move(identity), std::move(files), events, limits)) {
    inside_->listen(host, port);
    inside_->accept();
    inside_->tick();
    inside_->thread = std::thread([inside = inside_.get()] { inside->context.run(); });
}

WebServer::~WebServer() {
    asio::post(inside_->context, [inside = inside_.get()] { inside->stop(); });
    inside_->thread.join();
}

uint16_t WebServer::port() const { return inside_->acceptor.local_endpoint().port(); }

void WebServer::send_text(uint32_t client, std::string text) {
    asio::post(inside_->context, [inside = inside_.get(), client, text = std::move(text)]() mutable {
        const auto found = inside->sockets.find(client);
        if (found == inside->sockets.end()) return;
        if (const auto socket = found->second.lock()) socket->send({std::move(text), nullptr});
    });
}

void WebServer::send_picture(uint32_t client, std::shared_ptr<const std::vector<uint8_t>> message) {
    asio::post(inside_->context, [inside = inside_.get(), client, message = std::move(message)]() mutable {
        const auto found = inside->sockets.find(client);
        if (found == inside->sockets.end()) return;
        if (const auto socket = found->second.lock()) socket->send({"", std::move(message)});
    });
}

} // namespace pertev
