#pragma once

// A rendered picture as Python sees it: arrays that share the memory of the result, and what is known about it.

#include <memory>

#include <nanobind/nanobind.h>

#include "session/writing/picture_metadata.h"
#include "settings/render_settings.h"

namespace pertev {

struct PythonResult {
    PythonResult(RenderResult rendered, std::shared_ptr<const PictureRecord> of)
        : result(std::move(rendered)), record(std::move(of)) {}

    RenderResult result;
    std::shared_ptr<const PictureRecord> record;
    std::string hash; // made at the first request, before which no array was given away
    const std::string& known_hash();
};

void define_result(nanobind::module_& module);

} // namespace pertev
