#pragma once

// A film is a list of targets. A target holds one kind of result (exact sums, ids, counts) in its own memory on the
// film's device. Films with different samples of one picture are added target by target. A target can be saved as
// bytes and restored from them; neither depends on the device.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "device/buffer.h"
#include "device/launch.h"
#include "device/peer_copy.h"
#include "image/image.h"
#include "render/film_view.h"
#include "render/row_samples.h"

namespace pertev {

/// A layer of the finished picture: name, channel names and pixels.
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
    /// Replaces the contents by those of `other`, from any queue whose work on them is done. Throws as add().
    virtual void copy(const FilmTarget& other) { set_bytes(other.bytes()); }
    /// Layers of the picture, for a film that is `width` columns wide and has these samples.
    virtual std::vector<FilmLayer> layers(uint32_t width, const RowSamples& samples) const {
        static_cast<void>(width), static_cast<void>(samples);
        return {};
    }

    /// Size of the contents, which do not depend on the device.
    virtual std::size_t byte_count() const = 0;
    /// Distance in bytes between two numbers of the same kind, such as the reds of two pixels. It divides byte_count().
    virtual std::size_t stride() const = 0;
    /// Copies the contents from byte `first` on to the host. `first` and the size are multiples of stride().
    virtual void read(std::size_t first, std::span<std::byte> to) const = 0;
    /// Adds contents that read() returned for another target, as add().
    virtual void add_bytes(std::size_t first, std::span<const std::byte> from) = 0;

    std::vector<std::byte> bytes() const {
        std::vector<std::byte> all(byte_count());
        read(0, all);
        return all;
    }
    /// Restores the target from all its bytes. Throws std::logic_error if their number is wrong.
    void set_bytes(std::span<const std::byte> all) {
        PERTEV_CHECK(all.size() == byte_count());
        clear();
        add_bytes(0, all);
    }
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
        const auto& from = static_cast<const ElementTarget&>(other);
        const std::size_t all = elements_.size();
        const bool is_here = queue_ == from.queue_;
        const std::size_t copied = is_here ? 0 : std::min(kAtOnce, all);
        std::vector<std::byte> on_host(copied * sizeof(T));
        const Buffer<T> copy(*queue_, copied, kCopy);
        for (std::size_t first = 0; first < all; first += kAtOnce) {
            const std::size_t count = std::min(kAtOnce, all - first);
            if (is_here) {
                add_elements(from.elements_.data() + first, first, count);
            } else {
                const std::span part(on_host.data(), count * sizeof(T));
                from.copy_elements(first, part);
                upload_and_add(copy, first, part);
            }
        }
        queue_->wait(); // the copy must be finished before its source is freed
    }

    void copy(const FilmTarget& other) override {
        PERTEV_CHECK(is_like(other));
        const auto& from = static_cast<const ElementTarget&>(other);
        copy_between(*queue_, elements_.data(), *from.queue_, from.elements_.data(), byte_count());
    }

    std::size_t byte_count() const override { return elements_.size() * sizeof(T); }
    std::size_t stride() const override { return sizeof(T); }
    void read(std::size_t first, std::span<std::byte> to) const override {
        PERTEV_CHECK(first % stride() == 0 && to.size() % stride() == 0 && first + to.size() <= byte_count());
        copy_elements(first / sizeof(T), to);
    }
    void add_bytes(std::size_t first, std::span<const std::byte> from) override {
        PERTEV_CHECK(first % stride() == 0 && from.size() % stride() == 0 && first + from.size() <= byte_count());
        const std::size_t most = std::min(kAtOnce * sizeof(T), from.size());
        const Buffer<T> copy(*queue_, most / sizeof(T), kCopy);
        for (std::size_t at = 0; at < from.size(); at += most) {
            upload_and_add(copy, (first + at) / sizeof(T), from.subspan(at, std::min(most, from.size() - at)));
        }
    }

protected:
    Queue& queue() const { return *queue_; }

private:
    static constexpr std::size_t kAtOnce = std::size_t(1) << 20; // elements
    static constexpr const char* kCopy = "film to be added";

    void add_elements(const T* from, std::size_t first, std::size_t count) {
        launch(*queue_, "add_films", static_cast<uint32_t>(count), Add{from, elements_.data() + first});
    }
    void copy_elements(std::size_t first, std::span<std::byte> to) const {
        if (!to.empty()) queue_->copy_to_host(to.data(), elements_.data() + first, to.size());
    }
    /// Adds `from` by way of `copy`, which is at least as long.
    void upload_and_add(const Buffer<T>& copy, std::size_t first, std::span<const std::byte> from) {
        queue_->copy_to_device(copy.data(), from.data(), from.size());
        add_elements(copy.data(), first, from.size() / sizeof(T));
        queue_->wait();
    }

    Queue* queue_;
    const char* name_;
    Buffer<T> elements_;
};

} // namespace pertev
