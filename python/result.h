#pragma once

// A rendered picture as Python sees it: arrays that share the memory of the result, and what is known about it.

#include <memory>

#include <nanobind/nanobind.h>

#include "python/out_arrays.h"
#include "session/writing/picture_metadata.h"
#include "settings/render_settings.h"

namespace pertev {

struct PythonResult {
    PythonResult(RenderResult rendered, std::shared_ptr<const PictureRecord> of)
        : result(std::move(rendered)), record(std::move(of)) {}
    /// A picture that was merged of film files.
    PythonResult(RenderResult rendered, PictureFacts of)
        : result(std::move(rendered)), merged(std::make_shared<const PictureFacts>(std::move(of))) {}

    RenderResult result; // without what `out` has, if there are such arrays, and without layers then
    std::vector<OutArray> out;
    std::shared_ptr<const PictureRecord> record; // null for a merged picture
    std::shared_ptr<const PictureFacts> merged;  // null for others
    std::string hash;                            // made at the first request, before which no array was given away
    const std::string& known_hash();
    std::span<const PixelIds> ids() const;
    PictureFacts facts() const { return merged ? *merged : facts_of(*record, ids()); }
    /// Returns the result with what its arrays hold now.
    RenderResult whole() const;
};

/// Returns the camera's place, 16 numbers of a matrix, and its 9 of focal lengths and principal point. Throws
/// AttributeError for an orthographic camera, which has none of these.
std::vector<double> pose_of(const PictureRecord& record);
std::vector<double> intrinsics_of(const PictureRecord& record);

/// Returns pictures of one size, in rows of `columns`, as PNG for notebooks, at the exposure that fits all.
std::vector<std::byte> png_of(std::span<const Image> pictures, uint32_t columns);

/// Returns metadata by their names, without their prefix; texts of JSON as what they hold.
nanobind::dict info_of_metadata(const ExrMetadata& metadata);

void define_result(nanobind::module_& module);

} // namespace pertev
