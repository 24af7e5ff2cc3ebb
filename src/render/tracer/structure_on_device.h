#pragma once

// A structure where a walk of it runs. This is the one place that knows how a structure comes to a device.

#include <memory>

#include "device/buffer.h"
#include "render/tracer/built_structure.h"

namespace pertev {

/// On the host where that is the device, else a copy in one piece.
class StructureOnDevice {
public:
    /// `queue` outlives it. Throws Error(OutOfMemory).
    StructureOnDevice(Queue& queue, std::shared_ptr<const BuiltStructure> structure);

    const AnyTrees& trees() const { return trees_; }
    const BuiltStructure& built() const { return *structure_; }

private:
    template <class T>
    const T* moved(const T* on_host) const;
    template <class View>
    SceneTrees<View> moved_scene(SceneTrees<View> scene);

    std::shared_ptr<const BuiltStructure> structure_;
    AnyTrees trees_;
    Buffer<std::byte> memory_;
};

} // namespace pertev
