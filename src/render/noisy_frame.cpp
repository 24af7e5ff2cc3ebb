#include "render/noisy_frame.h"

namespace pertev {
namespace {

constexpr std::size_t arrays(bool splits_light) { return splits_light ? 7 : 6; }

} // namespace

NoisyFrame::NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light)
    : width_(width), height_(height),
      numbers_(queue, std::size_t(width) * height * arrays(splits_light), "noisy frame"),
      invalid_(queue, 1, "invalid samples") {
    const std::size_t pixels = std::size_t(width) * height;
    Float4* next = numbers_.data();
    for (Float4** array : {&view_.light, &view_.emission, &view_.place, &view_.normal, &view_.albedo, &view_.gloss}) {
        *array = next;
        next += pixels;
    }
    if (splits_light) view_.diffuse = next;
    begin();
}

std::size_t NoisyFrame::predicted_bytes(uint32_t width, uint32_t height, bool splits_light) {
    return std::size_t(width) * height * arrays(splits_light) * sizeof(Float4) + sizeof(uint64_t);
}

FilmView NoisyFrame::film_view() const {
    FilmView view = {};
    view.invalid = invalid_.data();
    view.width = width_;
    view.height = height_;
    view.frame = view_;
    return view;
}

} // namespace pertev
