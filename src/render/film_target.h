#pragma once

// A film is a list of targets. A target holds one kind of result (exact sums, ids, counts) in its own memory on the
// film's device. Films with different samples of one picture are added target by target. A target can be saved as
// bytes and restored from them; neither depends on the device.

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
    std::string name; // layer and channels are named as in kAovTable
    std::vector<std::string> channels;
    Image image;
};

class FilmTarget {
public:
    virtual ~FilmTarget() = default;
    /// Name of the kind of target; unique within a film.
    virtual const char* name() const = 0;
    /// Resets the target to its state without samples.
    virtual void clear() = 0;
    /// Sets the target's memory in the view of those who add samples.
    virtual void show(FilmView& view) const = 0;
    /// Returns whether `other` has the same kind, name and size.
    virtual bool is_like(const FilmTarget& other) const = 0;
    /// Adds the contents of `other`, which holds other samples, from any queue. Throws std::logic_error unless
    /// is_like() holds.
    virtual void add(const FilmTarget& other) = 0;
    /// Layers of the picture, for a film that is `width` columns wide and has `samples` samples per pixel.
    virtual std::vector<FilmLayer> layers(uint32_t width, uint64_t samples) const {
        static_cast<void>(width), static_cast<void>(samples);
        return {};
    }
    virtual std::vector<std::byte> bytes() const = 0;
    /// Restores the target from `bytes`. Throws std::logic_error if their number is wrong.
    virtual void set_bytes(std::span<const std::byte> bytes) = 0;
};

/// A target that is an array of elements, each with all bytes `kEmpty` at first. The stage `Add{from, to}` adds another
/// film's elements.
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
        queue_->wait(); // the copy must be finished before its source is freed
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

protected:
    Queue& queue() const { return *queue_; }

private:
    Queue* queue_;
    const char* name_;
    Buffer<T> elements_;
};

} // namespace pertev
