#include "apps/viewer/viewer.h"

#include <chrono>
#include <thread>

#include <fmt/format.h>

#include "apps/viewer/access_token.h"
#include "apps/viewer/packer.h"
#include "apps/viewer/panel_text.h"
#include "apps/viewer/render_loop.h"

namespace pertev {
namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Connects the network and the audience.
class Reception final : public WebEvents {
public:
    Reception(Audience& audience, Inbox& inbox) : audience_(audience), inbox_(inbox) {}
    bool opened(uint32_t client) override { return audience_.open(client, now_s()); }
    std::string received(uint32_t client, std::string_view text) override {
        return audience_.received(client, text, now_s());
    }
    void text_was_sent(uint32_t client) override { audience_.text_was_sent(client); }
    void closed(uint32_t client) override { audience_.close(client, now_s()); }
    void save(const std::string& format, std::function<void(std::vector<std::byte>)> reply) override {
        if (!inbox_.put(Save{format, reply})) reply({});
    }
    std::vector<uint32_t> tick() override { return audience_.tick(now_s()); }

private:
    Audience& audience_;
    Inbox& inbox_;
};

/// While it exists, the source's work is stopped as soon as the viewer must end.
class EndWatch {
public:
    EndWatch(const std::function<bool()>& goes_on, FrameSource& source)
        : thread_([this, &goes_on, &source] {
              while (!is_over_) {
                  if (!goes_on()) source.abandon() = source.hurry() = true;
                  std::this_thread::sleep_for(std::chrono::milliseconds(20));
              }
          }) {}
    ~EndWatch() {
        is_over_ = true;
        thread_.join();
    }

private:
    std::atomic<bool> is_over_{false};
    std::thread thread_;
};

std::string address_of(const std::string& host, uint16_t port, const std::string& token) {
    const bool is_ipv6 = host.find(':') != std::string::npos && !host.starts_with('[');
    return fmt::format("http://{}:{}/?token={}", is_ipv6 ? "[" + host + "]" : host, port, token);
}

} // namespace

void run_viewer(const ViewerOptions& options, const ViewerStart& start, FrameSource& source,
                const std::function<void(const std::string& address)>& listening,
                const std::function<bool()>& goes_on) {
    const bool is_given = !options.token.empty(); // a given token is not in the program's output
    const ServerIdentity identity = {options.host, is_given ? options.token : make_token(), "pertev-" + make_token(4),
                                     make_token(), options.embed};
    Inbox inbox;
    inbox.raise(source.abandon(), source.hurry());
    inbox.expect(start.view);
    Audience audience(inbox, welcome_text(start));
    Reception reception(audience, inbox);
    WebServer server(options.host, options.port, identity, page_files(), reception, options.limits);
    listening(address_of(options.host, server.port(), is_given ? "" : identity.token));
    const EndWatch watch(goes_on, source);
    // In order: the packer ends before the inbox closes, and that before the server ends.
    struct Closing {
        Inbox& inbox;
        ~Closing() { inbox.close(); }
    } closing{inbox};
    Packer packer(audience, server, now_s, options.jpeg_queue);
    RenderLoop loop(start, source, inbox, audience, packer, now_s);
    loop.run(goes_on);
}

} // namespace pertev
