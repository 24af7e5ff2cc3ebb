#pragma once

// A film is a list of targets. A target holds what samples leave of one kind (exact sums, ids, counts), in memory of
// its own on the film's device. Films that hold other samples of one picture are added target by target, and a target
// is kept as bytes from which it is made again; neither depends on the device.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "device/buffer.h"
#include "device/launch.h"
#include "image/image.h"
#include "render/film_view.h"

namespace pertev {

/// One layer of the finished picture: its name, channel names and pixels.
struct FilmLayer {
    std::string name; // as kAovTable names layer and channels
    std::vector<std::string> channels;
    Image image;
};

class FilmTarget {
public:
    virtual ~FilmTarget() = default;
    /// The same of targets that hold the same kind of thing; no two targets of a film share one.
    virtual const char* name() const = 0;
    /// As if no sample had been taken.
    virtual void clear() = 0;
    /// Tells those who add samples where it lies.
    virtual void show(FilmView& view) const = 0;
    /// Returns whether `other` is of the same kind, name and size.
    virtual bool is_like(const FilmTarget& other) const = 0;
    /// Takes what `other` holds of other samples, from any queue. Throws std::logic_error unless it is like this one.
    virtual void add(const FilmTarget& other) = 0;
    /// Resolves to layers of the picture, of a film of `width` columns that has so many samples of each pixel. The
    /// film itself resolves its own targets.
    virtual std::vector<FilmLayer> layers(uint32_t width, uint64_t samples) const {
        static_cast<void>(width), static_cast<void>(samples);
        return {};
    }
    virtual std::vector<std::byte> bytes() const = 0;
    /// Becomes the target that `bytes` were of. Throws std::logic_error where their number is wrong.
    virtual void set_bytes(std::span<const std::byte> bytes) = 0;
};

/// A target of `count` elements, each of which starts with all bytes `kEmpty` and takes another film's by the stage
/// `Add{from, to}`.
template <class T, class Add, unsigned char kEmpty>
class ElementTarget : public FilmTarget {
public:
    ElementTarget(Queue& queue, std::size_t count, const char* name)
        : queue_(&queue), name_(name), elements_(queue, count, name) {
        clear();
    }

    const char* name() const override { return name_; }
    const Buffer<T>& elements() const { return elements_; }
    void clear() override { elements_.fill(kEmpty); }

    bool is_like(const FilmTarget& other) const override {
        const auto* const same = dynamic_cast<const ElementTarget*>(&other);
        return same != nullptr && std::string(same->name_) == name_ && same->elements_.size() == elements_.size();
    }

    void add(const FilmTarget& other) override {
        PERTEV_CHECK(is_like(other));
        const auto* const from = static_cast<const ElementTarget*>(&other);
        const std::size_t all = elements_.size(), at_once = std::min(std::size_t(1) << 20, all);
        const bool is_here = queue_ == from->queue_;
        std::vector<T> on_host(is_here ? 0 : at_once);
        Buffer<T> copy;
        if (!is_here) copy = Buffer<T>(*queue_, at_once, "film to be added");
        for (std::size_t first = 0; first < all; first += at_once) {
            const std::size_t count = std::min(at_once, all - first);
            const T* theirs = from->elements_.data() + first;
            if (!is_here) {
                from->queue_->copy_to_host(on_host.data(), theirs, count * sizeof(T));
                copy.upload({on_host.data(), count});
                theirs = copy.data();
            }
            launch(*queue_, "add_films", static_cast<uint32_t>(count), Add{theirs, elements_.data() + first});
        }
        queue_->wait(); // before the copy goes
    }

    std::vector<std::byte> bytes() const override {
        const std::vector<T> values = elements_.download();
        const auto raw = std::as_bytes(std::span<const T>(values));
        return {raw.begin(), raw.end()};
    }

    void set_bytes(std::span<const std::byte> bytes) override {
        PERTEV_CHECK(bytes.size() == elements_.size() * sizeof(T));
        std::vector<T> values(elements_.size());
        if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
        elements_.upload(values);
        queue_->wait();
    }

private:
    Queue* queue_;
    const char* name_;
    Buffer<T> elements_;
};

} // namespace pertev
