#include "device_scene/part_arrays.h"

#include <cstring>

#include "device/shared_uploads.h"

namespace pertev {
namespace {

constexpr std::size_t kAlignment = 256; // alignment of cudaMalloc

std::size_t aligned(std::size_t bytes) { return (bytes + kAlignment - 1) / kAlignment * kAlignment; }

} // namespace

std::size_t PartArrays::bytes() const {
    std::size_t bytes = 0;
    for (const Array& array : arrays_) bytes += aligned(array.values.size());
    return bytes;
}

void PartArrays::set_pointers(const std::byte* base) const {
    std::size_t offset = 0;
    for (const Array& array : arrays_) {
        const void* const pointer = base == nullptr || array.values.empty() ? nullptr : base + offset;
        std::memcpy(array.target, &pointer, sizeof pointer); // all data pointers have the same form
        offset += aligned(array.values.size());
    }
}

void PartArrays::upload(Queue& queue, Buffer<std::byte>& buffer, const std::string& name) const {
    if (buffer.size() < bytes()) {
        set_pointers(nullptr);
        buffer = Buffer<std::byte>(); // freed before the new one, so that both need not fit
        buffer = Buffer<std::byte>(queue, bytes(), name);
    }
    set_pointers(buffer.data());
    std::size_t offset = 0;
    for (const Array& array : arrays_) {
        if (!array.values.empty()) {
            upload_array(queue, buffer.data() + offset, array.values);
        }
        offset += aligned(array.values.size());
    }
}

} // namespace pertev
