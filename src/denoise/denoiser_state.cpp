#include "denoise/denoiser_state.h"

#include <cstring>

#include "base/error.h"
#include "scene/projection_features.h"

namespace pertev {
namespace {

constexpr uint32_t kVersion = 2;

/// Calls `visit` for each number of the head, in their order.
template <class Head, class Visit>
void visit_numbers(Head& head, const Visit& visit) {
    auto& camera = head.camera;
    auto& transform = camera.world_from_camera;
    visit(head.samples), visit(head.features);
    for (auto* axis : {&transform.row0, &transform.row1, &transform.row2, &transform.translation})
        visit(axis->x), visit(axis->y), visit(axis->z);
    visit(camera.half_width), visit(camera.half_height), visit(camera.inv_width), visit(camera.inv_height);
    visit(camera.centre.x), visit(camera.centre.y);
}

} // namespace

void DenoiserHead::write(std::span<uint32_t> words) const {
    std::size_t at = 0;
    const auto put = [&](const auto& number) {
        static_assert(sizeof number == sizeof(uint32_t));
        std::memcpy(&words[at++], &number, sizeof number);
    };
    put(kVersion);
    put(static_cast<uint32_t>(has_gloss));
    put(static_cast<uint32_t>(camera.projection));
    visit_numbers(*this, put);
    PERTEV_CHECK(at <= kWords);
    std::fill(words.begin() + static_cast<std::ptrdiff_t>(at), words.begin() + kWords, 0u);
}

DenoiserHead DenoiserHead::read(std::span<const uint32_t> words) {
    DenoiserHead head;
    std::size_t at = 0;
    const auto take = [&](auto& number) { std::memcpy(&number, &words[at++], sizeof number); };
    uint32_t version = 0, gloss = 0, projection = 0;
    if (words.size() >= kWords) {
        take(version), take(gloss), take(projection);
        visit_numbers(head, take);
    }
    head.has_gloss = gloss != 0;
    const std::optional<Projection> kind = projection_of_picture(projection);
    const bool is_sound = version == kVersion && gloss <= 1 && kind && head.samples > 0 && head.features > 0;
    if (!is_sound) throw Error(ErrorCode::BadInput, "what the denoiser has gathered is missing or damaged");
    head.camera.projection = *kind;
    return head;
}

void save_pixels(Queue& queue, std::span<const PixelWords> arrays, std::size_t pixels, std::size_t first,
                 std::size_t count, std::span<uint32_t> to) {
    PERTEV_CHECK(first + count <= pixels);
    for (const PixelWords& array : arrays) {
        const auto* const from = static_cast<const uint32_t*>(array.data) + first * array.words;
        if (count > 0)
            queue.copy_to_host(to.data() + first * array.words, from, count * array.words * sizeof(uint32_t));
        to = to.subspan(pixels * array.words);
    }
}

void restore_pixels(Queue& queue, std::span<const PixelWords> arrays, std::size_t pixels, std::size_t first,
                    std::size_t count, std::span<const uint32_t> from) {
    for (const PixelWords& array : arrays) {
        const std::size_t before = first * array.words;
        queue.copy_to_device(static_cast<uint32_t*>(array.data) + before, from.data() + before,
                             count * array.words * sizeof(uint32_t));
        from = from.subspan(pixels * array.words);
    }
}

bool DenoiserTarget::is_like(const FilmTarget& other) const {
    const auto* const same = dynamic_cast<const DenoiserTarget*>(&other);
    return same != nullptr && same->count_ == count_;
}

void DenoiserTarget::add(const FilmTarget& other) {
    PERTEV_CHECK(is_like(other));
    add_bytes(0, other.bytes());
}

void DenoiserTarget::read(std::size_t first, std::span<std::byte> to) const {
    PERTEV_CHECK(first % stride() == 0 && to.size() % stride() == 0 && first + to.size() <= byte_count());
    if (first == 0) read_ = now_ ? now_() : DenoiserState();
    const DenoiserState& words = now_ ? read_ : words_;
    if (words.empty()) {
        std::vector<uint32_t> missing(to.size() / stride());
        fill_missing(first / stride(), missing);
        std::memcpy(to.data(), missing.data(), to.size());
    } else {
        std::memcpy(to.data(), reinterpret_cast<const std::byte*>(words.data()) + first, to.size());
    }
    if (first + to.size() == byte_count()) read_ = {};
}

/// Fills words from number `first` on as no sample would leave them.
void DenoiserTarget::fill_missing(std::size_t first, std::span<uint32_t> to) const {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = first + i < sums_from_ ? kMissingWord : 0;
}

void DenoiserTarget::add_bytes(std::size_t first, std::span<const std::byte> from) {
    PERTEV_CHECK(first % stride() == 0 && from.size() % stride() == 0 && first + from.size() <= byte_count());
    if (words_.empty()) {
        words_.resize(count_);
        fill_missing(0, words_);
    }
    const std::size_t begin = first / stride(), end = begin + from.size() / stride();
    const std::size_t sums = std::clamp(sums_from_, begin, end);
    const auto source = [&](std::size_t word) { return &from[(word - begin) * stride()]; };
    for (std::size_t word = begin; word < sums; ++word) {
        if (words_[word] == kMissingWord) std::memcpy(&words_[word], source(word), stride());
    }
    PERTEV_CHECK((sums - sums_from_) % 2 == 0 && (end - sums) % 2 == 0); // blocks hold whole sums
    for (std::size_t word = sums; word < end; word += 2) {
        uint64_t sum = 0, more = 0;
        std::memcpy(&sum, &words_[word], sizeof sum);
        std::memcpy(&more, source(word), sizeof more);
        sum += more;
        std::memcpy(&words_[word], &sum, sizeof sum);
    }
}

} // namespace pertev
