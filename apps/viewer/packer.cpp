#include "apps/viewer/packer.h"

#include <algorithm>
#include <chrono>
#include <exception>

#include "apps/viewer/panel_phrases.h"
#include "apps/viewer/panel_text.h"
#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "image/write_png.h"

namespace pertev {
namespace {

using Bytes = std::shared_ptr<const std::vector<std::byte>>;

constexpr int kFullColor = 85; // from this quality on, chroma has full resolution

uint32_t shrink_factor(float scale) { return static_cast<uint32_t>(std::max(1.0f, 1 / scale)); }

} // namespace

Rgba8Image shrunk(const Rgba8Image& picture, uint32_t factor) {
    if (factor <= 1) return picture;
    Rgba8Image small = {std::max(1u, picture.width / factor), std::max(1u, picture.height / factor), {}};
    small.pixels.resize(std::size_t(small.width) * small.height * 4);
    for (uint32_t y = 0; y < small.height; ++y) {
        for (uint32_t x = 0; x < small.width; ++x) {
            const uint32_t x1 = std::min(picture.width, (x + 1) * factor),
                           y1 = std::min(picture.height, (y + 1) * factor);
            uint32_t sums[4] = {}, count = 0;
            for (uint32_t v = y * factor; v < y1; ++v) {
                for (uint32_t u = x * factor; u < x1; ++u, ++count) {
                    const uint8_t* pixel = &picture.pixels[(std::size_t(v) * picture.width + u) * 4];
                    for (int c = 0; c < 4; ++c) sums[c] += pixel[c];
                }
            }
            uint8_t* out = &small.pixels[(std::size_t(y) * small.width + x) * 4];
            for (int c = 0; c < 4; ++c) out[c] = static_cast<uint8_t>((sums[c] + count / 2) / count);
        }
    }
    return small;
}

Packer::Packer(Audience& audience, WebServer& server, std::function<double()> now_s, Queue* jpeg_queue)
    : audience_(audience), server_(server), now_s_(std::move(now_s)), jpeg_queue_(jpeg_queue),
      thread_([this, threads = Threads()] {
          const UseThreads use(threads);
          run();
      }) {}

Packer::~Packer() {
    is_ending_ = true;
    thread_.join();
}

void Packer::run() {
    JpegEncoder encoder(jpeg_queue_);
    while (!is_ending_) {
        const std::optional<SendJob> job = audience_.next_job(std::chrono::milliseconds(50), now_s_);
        if (!job) continue;
        if (job->picture == nullptr) {
            server_.send_text(job->client, job->text);
        } else {
            try {
                send_picture(*job, encoder);
            } catch (const std::exception& error) { // usually out of memory; the next picture may fit again
                audience_.notify(0, notice_text("error", panel_phrase(error.what())));
                std::this_thread::sleep_for(std::chrono::seconds(1));
            }
        }
    }
}

Bytes Packer::jpeg_of(const SendJob& job, JpegEncoder& encoder) {
    if (!jpegs_.empty() && jpegs_.front().number != job.picture->number) jpegs_.clear();
    for (const Packed& packed : jpegs_) {
        if (packed.quality == job.quality && packed.scale == job.scale) return packed.bytes;
    }
    const Stopwatch watch;
    const Rgba8Image& image = job.picture->frame.image;
    const uint32_t factor = shrink_factor(job.scale);
    const bool half_chroma = job.quality < kFullColor;
    const auto bytes = std::make_shared<const std::vector<std::byte>>(
        factor == 1 ? encoder.encode(image, job.quality, half_chroma)
                    : encoder.encode(shrunk(image, factor), job.quality, half_chroma));
    encoder_name_ = encoder.name();
    milliseconds_ = 1e3 * watch.seconds();
    bytes_ = bytes->size();
    jpegs_.push_back({job.picture->number, job.quality, job.scale, bytes});
    return bytes;
}

Bytes Packer::png_of(const SendJob& job) {
    if (png_.number != job.picture->number) {
        png_.bytes = std::make_shared<const std::vector<std::byte>>(encode_png(job.picture->frame.image));
        png_.number = job.picture->number;
    }
    return png_.bytes;
}

void Packer::send_picture(const SendJob& job, JpegEncoder& encoder) {
    const ShownFrame& frame = job.picture->frame;
    const Bytes packed = job.is_piece ? png_of(job) : jpeg_of(job, encoder);
    const std::size_t left = packed->size() - job.offset, count = job.is_piece ? std::min(job.piece_bytes, left) : left;
    FrameHeader header;
    header.kind = job.is_piece ? PictureKind::Piece : PictureKind::Jpeg;
    header.flags = frame.is_final ? kFrameIsFinal : uint16_t(0);
    header.input = job.picture->input;
    header.samples = frame.samples;
    const uint32_t factor = job.is_piece ? 1 : shrink_factor(job.scale);
    header.width = static_cast<uint16_t>(std::max(1u, frame.image.width / factor));
    header.height = static_cast<uint16_t>(std::max(1u, frame.image.height / factor));
    header.full_width = static_cast<uint16_t>(frame.full_width);
    header.full_height = static_cast<uint16_t>(frame.full_height);
    header.offset = static_cast<uint32_t>(job.offset);
    header.total = static_cast<uint32_t>(packed->size());
    header.frame = audience_.picture_leaves(job, count, packed->size(), now_s_());
    const auto head = bytes_of(header);
    const auto message = std::make_shared<std::vector<uint8_t>>(head.begin(), head.end());
    const auto* data = reinterpret_cast<const uint8_t*>(packed->data()) + job.offset;
    message->insert(message->end(), data, data + count);
    server_.send_picture(job.client, message);
}

} // namespace pertev
