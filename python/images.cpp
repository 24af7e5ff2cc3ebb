#include "python/images.h"

#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "base/error.h"
#include "image/flip.h"
#include "image/metrics.h"
#include "image/picture_hash.h"
#include "image/read_image.h"
#include "image/tone_map_image.h"
#include "image/write_image.h"
#include "python/array_argument.h"
#include "python/owned_array.h"
#include "python/python_sink.h"
#include "python/result.h"
#include "session/writing/check_outputs.h"
#include "session/writing/write_picture.h"

namespace nb = nanobind;

namespace pertev {
namespace {

/// Returns a picture of (height, width) or (height, width, channels) with 1 to 4 channels.
Image image_of(nb::handle value, const std::string& name) {
    const ArrayArgument array(value, name);
    const std::size_t channels = array.axes() == 2 ? 1 : array.axes() == 3 ? array.length(2) : 0;
    if (channels < 1 || channels > 4) {
        array.fail("expected the shape (height, width), or (height, width, channels) with 1 to 4 channels");
    }
    if (array.length(0) > UINT32_MAX || array.length(1) > UINT32_MAX) array.fail("the image is too large");
    return {static_cast<uint32_t>(array.length(1)), static_cast<uint32_t>(array.length(0)),
            static_cast<uint32_t>(channels), array.floats()};
}

nb::object read(const std::string& path) {
    Messages messages;
    Image image;
    {
        const nb::gil_scoped_release unlocked;
        image = read_image(path, messages);
    }
    log_messages(messages);
    return owned_array(std::move(image.pixels), {image.height, image.width, image.channels});
}

ToneMap curve_of(const std::string& name) {
    const auto curve = value_named<ToneMap>(name);
    if (!curve) {
        throw Error(ErrorCode::BadInput, "curve", name,
                    fmt::format("expected one of {}", fmt::join(names_of<ToneMap>(), ", ")));
    }
    return *curve;
}

void write(const std::string& path, nb::handle array, const std::string& curve, float exposure) {
    const Image image = image_of(array, "picture");
    WriteImageOptions options;
    options.display = {curve_of(curve), exposure};
    options.transparent = image.channels == 2 || image.channels == 4;
    const nb::gil_scoped_release unlocked;
    write_image(path, image, options);
}

/// Writes a result with all that the format holds: its layers and metadata too.
void write_result(const std::string& path, const PythonResult& result, const std::string& curve, float exposure) {
    const std::vector<std::string> paths = {path};
    PictureFacts facts = result.facts();
    if (writes_tone_mapped(paths)) {
        facts.display = Display{curve_of(curve), exposure, {}};
        facts.shown = display_metadata(*facts.display);
    } else if (result.merged) {
        facts.shown.clear();
    }
    RenderResult written = result.whole(); // the copy loses its layers
    const nb::gil_scoped_release unlocked;
    image_format_for(path);
    const std::string failures = failures_of(write_picture(paths, facts, written));
    if (!failures.empty()) throw Error(ErrorCode::FileWrite, failures);
}

nb::object tone_map_array(nb::handle array, const std::string& curve, float exposure) {
    Rgba8Image image = tone_map_image(image_of(array, "picture"), curve_of(curve), exposure);
    return owned_array(std::move(image.pixels), {image.height, image.width, 4});
}

nb::dict compare(nb::handle picture, nb::handle reference, uint32_t blocks) {
    if (blocks == 0) throw Error(ErrorCode::BadInput, "blocks", "0", "expected at least 1");
    Image a = image_of(picture, "picture"), b = image_of(reference, "reference");
    check_comparable(a, b);
    const bool equal = picture_hash(a) == picture_hash(b);
    if (blocks > 1) {
        a = block_means(a, blocks);
        b = block_means(b, blocks);
    }
    double rel_mse = 0, trimmed = 0, mse = 0, flip_mean = 0, hdr_mean = 0;
    {
        const nb::gil_scoped_release unlocked;
        rel_mse = relative_error(a, b, 1.0).rel_mse;
        trimmed = relative_error(a, b).rel_mse;
        mse = mean_squared_error(a, b);
        flip_mean = flip(a, b).mean;
        hdr_mean = hdr_flip(a, b).mean;
    }
    nb::dict result;
    result["rel_mse"] = rel_mse;
    result["rel_mse_98"] = trimmed;
    result["mse"] = mse;
    result["flip"] = flip_mean;
    result["hdr_flip"] = hdr_mean;
    result["equal"] = equal;
    return result;
}

} // namespace

void define_images(nb::module_& module) {
    module.def("read", &read);
    module.def("write", &write);
    module.def("write_result", &write_result);
    module.def("tone_map", &tone_map_array);
    module.def("compare", &compare);
}

} // namespace pertev
