#include "render/noisy_frame.h"

#include <cstring>
#include <utility>

#include "base/error.h"
#include "device/launch.h"
#include "render/film_stages.h"

namespace pertev {

NoisyFrame::NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light)
    : NoisyFrame(queue, width, height, splits_light,
                 Buffer<Float4>(queue, std::size_t(width) * height * arrays(splits_light), "noisy frame")) {}

NoisyFrame::NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light, Buffer<Float4> own)
    : NoisyFrame(queue, width, height, splits_light, own.data()) {
    numbers_ = std::move(own);
}

NoisyFrame::NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light, Float4* numbers)
    : queue_(&queue), width_(width), height_(height), invalid_(queue, 1, "invalid samples") {
    const std::size_t pixels = std::size_t(width) * height;
    Float4* next = numbers;
    for (Float4** array : {&view_.light, &view_.emission, &view_.hit, &view_.normal, &view_.albedo, &view_.gloss}) {
        *array = next;
        next += pixels;
    }
    if (splits_light) view_.diffuse = next;
    begin();
}

void NoisyFrame::show(FilmView& view) const {
    view.invalid = invalid_.data();
    view.window = {.width = width_, .height = height_};
    view.frame = view_;
}

FilmView NoisyFrame::film_view() const {
    FilmView view = {};
    show(view);
    return view;
}

FilmView NoisyFrame::film_view(RowBand rows) const {
    FilmView view = film_view();
    if (rows != RowBand{0, height_}) view.window = {width_, 0, rows.first, width_, rows.count()};
    return view;
}

std::vector<RowArray> NoisyFrame::rows() const {
    std::vector<RowArray> all;
    for (std::size_t i = 0; i < arrays(splits_light()); ++i) {
        all.push_back({view_.light + i * width_ * height_, width_ * sizeof(Float4), height_});
    }
    return all;
}

void NoisyFrame::clear() {
    queue_->fill(view_.light, 0xff, count() * sizeof(Float4)); // AddFrames::kNoSample
    invalid_.zero();
}

bool NoisyFrame::is_like(const FilmTarget& other) const {
    const auto* const same = dynamic_cast<const NoisyFrame*>(&other);
    return same != nullptr && same->width_ == width_ && same->height_ == height_ &&
           same->splits_light() == splits_light();
}

void NoisyFrame::add(const FilmTarget& other) {
    PERTEV_CHECK(is_like(other));
    add_bytes(0, other.bytes());
}

void NoisyFrame::read(std::size_t first, std::span<std::byte> to) const {
    PERTEV_CHECK(first == 0 && to.size() == byte_count());
    queue_->copy_to_host(to.data(), view_.light, to.size() - sizeof(uint64_t));
    const uint64_t invalid = invalid_samples();
    std::memcpy(&to.back() + 1 - sizeof invalid, &invalid, sizeof invalid);
}

void NoisyFrame::add_bytes(std::size_t first, std::span<const std::byte> from) {
    PERTEV_CHECK(first == 0 && from.size() == byte_count());
    const NoisyFrame copy(*queue_, width_, height_, splits_light());
    queue_->copy_to_device(copy.view_.light, from.data(), from.size() - sizeof(uint64_t));
    const uint32_t pixels = width_ * height_;
    launch(*queue_, "add_frames", pixels,
           AddFrames{copy.view_.light, view_.light, pixels, static_cast<uint32_t>(arrays(splits_light()))});
    uint64_t theirs = 0;
    std::memcpy(&theirs, &from.back() + 1 - sizeof theirs, sizeof theirs);
    const uint64_t invalid = invalid_samples() + theirs;
    invalid_.upload({&invalid, 1});
    queue_->wait(); // the copy must be finished before its source is freed
}

} // namespace pertev
