#include "render/noisy_frame.h"

#include <utility>

namespace pertev {

NoisyFrame::NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light)
    : NoisyFrame(queue, width, height, splits_light,
                 Buffer<Float4>(queue, std::size_t(width) * height * arrays(splits_light), "noisy frame")) {}

NoisyFrame::NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light, Buffer<Float4> own)
    : NoisyFrame(queue, width, height, splits_light, own.data()) {
    numbers_ = std::move(own);
}

NoisyFrame::NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light, Float4* numbers)
    : width_(width), height_(height), invalid_(queue, 1, "invalid samples") {
    const std::size_t pixels = std::size_t(width) * height;
    Float4* next = numbers;
    for (Float4** array : {&view_.light, &view_.emission, &view_.place, &view_.normal, &view_.albedo, &view_.gloss}) {
        *array = next;
        next += pixels;
    }
    if (splits_light) view_.diffuse = next;
    begin();
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
