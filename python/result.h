#pragma once

// A rendered picture as Python sees it: arrays that share the memory of the result, and what is known about it.

#include <nanobind/nanobind.h>

#include "session/writing/picture_metadata.h"
#include "settings/render_settings.h"

namespace pertev {

struct PythonResult {
    RenderResult result;
    ExrMetadata metadata; // that an EXR with this picture has
    std::string hash;
};

void define_result(nanobind::module_& module);

} // namespace pertev
