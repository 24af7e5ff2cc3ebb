#pragma once

// An acceptance rule for tests.

#include <cstdint>

#include "base/host_device.h"

namespace pertev::test {

/// Acceptance by a pure function of the primitive and the position on it, like an alpha cut-out.
struct AcceptSome {
    HD bool operator()(uint32_t instance, uint32_t primitive, float u, float) const {
        return (primitive * 2654435761u + instance) % 3 != 0 || u > 0.5f;
    }
};

} // namespace pertev::test
