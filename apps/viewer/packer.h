#pragma once

// The thread that encodes pictures for each client's link and passes them to the server: JPEG while something moves
// or samples accumulate, PNG for the last picture. A version that several clients need is encoded once.

#include <atomic>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "apps/viewer/audience.h"
#include "apps/viewer/jpeg_encoder.h"
#include "apps/viewer/web_server.h"

namespace pertev {

class Packer {
public:
    /// The arguments must outlive this object. `now_s` returns seconds of the audience's clock. `jpeg_queue`: see
    /// JpegEncoder.
    Packer(Audience& audience, WebServer& server, std::function<double()> now_s, Queue* jpeg_queue);
    /// Ends the thread.
    ~Packer();
    Packer(const Packer&) = delete;
    Packer& operator=(const Packer&) = delete;

    /// Time and size of the last JPEG.
    double milliseconds() const { return milliseconds_; }
    std::size_t bytes() const { return bytes_; }
    /// The encoder that made the last JPEG.
    const char* encoder() const { return encoder_name_; }

private:
    void run();
    void send_picture(const SendJob& job, JpegEncoder& encoder);
    std::shared_ptr<const std::vector<std::byte>> jpeg_of(const SendJob& job, JpegEncoder& encoder);
    std::shared_ptr<const std::vector<std::byte>> png_of(const SendJob& job);

    Audience& audience_;
    WebServer& server_;
    std::function<double()> now_s_;
    Queue* jpeg_queue_;
    struct Packed {
        uint32_t number = 0;
        int quality = 0;
        float scale = 0;
        std::shared_ptr<const std::vector<std::byte>> bytes;
    };
    std::vector<Packed> jpegs_; // versions of one picture
    Packed png_;
    std::atomic<double> milliseconds_{0};
    std::atomic<std::size_t> bytes_{0};
    std::atomic<const char*> encoder_name_{""};
    std::atomic<bool> is_ending_{false};
    std::thread thread_;
};

/// The picture at 1/`factor` of its size, as means of pixels; remaining columns and rows at the right and lower
/// border count with the last. Factor 1 returns the picture itself.
Rgba8Image shrunk(const Rgba8Image& picture, uint32_t factor);

} // namespace pertev
