#pragma once

// Arrays of the host that one device has, so that another device copies them from there in place of uploading them
// again. Arrays are known by their address on the host, so only such take part as stay there unchanged (lasts()).

#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "device/queue.h"

namespace pertev {

class SharedUploads {
public:
    explicit SharedUploads(Queue& queue) : queue_(&queue) {}

    /// Forgets all arrays. It must be called before memory to which they were uploaded is freed or overwritten.
    void clear() { lasting_.clear(), uploaded_.clear(); }
    /// Lets an array of the host be remembered once it is uploaded, if it is large.
    void lasts(std::span<const std::byte> host) {
        if (host.size() >= kWorthIt) lasting_.insert(host.data());
    }

    /// While it exists, upload_array() on this thread remembers arrays in `to`, and takes those that `from` has from
    /// its device; null: from the host.
    class Scope {
    public:
        Scope(SharedUploads& to, const SharedUploads* from);
        ~Scope();
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;
    };

private:
    static constexpr std::size_t kWorthIt = 4096; // bytes of an array from which on a copy is sought

    friend void upload_array(Queue& queue, void* device, std::span<const std::byte> host, bool lasts);

    bool copy(Queue& to, void* device, std::span<const std::byte> host) const;

    Queue* queue_;
    std::set<const void*> lasting_;
    std::map<std::pair<const void*, std::size_t>, const void*> uploaded_; // by address and size: where it is
};

/// Uploads an array by `queue`. `lasts` means that SharedUploads::lasts() is true of it.
void upload_array(Queue& queue, void* device, std::span<const std::byte> host, bool lasts = false);

} // namespace pertev
