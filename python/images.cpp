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
#include "python/result.h"
#include "python/unlocked.h"
#include "session/writing/check_outputs.h"
#include "session/writing/write_picture.h"

namespace nb = nanobind;

namespace pertev {
namespace {

/// Returns a picture of (height, width) or (height, width, channels) with 1 to 4 channels. Throws Error(BadInput) for
/// integers.
Image image_of(nb::handle value, const std::string& name) {
    const ArrayArgument array(value, name);
    if (array.is_whole()) array.fail("the array's dtype is no float; a picture is linear Rec. 709");
    const std::size_t channels = array.axes() == 2 ? 1 : array.axes() == 3 ? array.length(2) : 0;
    if (channels < 1 || channels > 4) {
        array.fail("expected the shape (height, width), or (height, width, channels) with 1 to 4 channels");
    }
    if (array.length(0) > UINT32_MAX || array.length(1) > UINT32_MAX) array.fail("the image is too large");
    if (array.length(0) == 0 || array.length(1) == 0) array.fail("the image has no pixels");
    return {static_cast<uint32_t>(array.length(1)), static_cast<uint32_t>(array.length(0)),
            static_cast<uint32_t>(channels), array.floats()};
}

nb::object read(const std::string& path) {
    Image image = result_of([&](PythonSink& sink) {
        Image read = read_image(path, sink);
        sink.check();
        return read;
    });
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
    run_unlocked([&](PythonSink&) { write_image(path, image, options); });
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
    run_unlocked([&](PythonSink&) {
        image_format_for(path);
        RenderResult written = result.whole(); // the copy loses its layers
        refuse_faults(write_picture(paths, facts, written), 0, false);
    });
}

nb::object tone_map_array(nb::handle array, const std::string& curve, float exposure) {
    const Image picture = image_of(array, "picture");
    const ToneMap shape = curve_of(curve);
    Rgba8Image image = result_of([&](PythonSink&) { return tone_map_image(picture, shape, exposure); });
    return owned_array(std::move(image.pixels), {image.height, image.width, 4});
}

/// Returns a picture that can be compared.
Image compared(nb::handle value, const std::string& name) {
    Image image = image_of(value, name);
    if (image.channels >= 3) return image;
    throw Error(ErrorCode::BadInput, name, "", fmt::format("expected 3 or 4 channels, not {}", image.channels));
}

struct Differences {
    bool equal = false;
    double rel_mse = 0, trimmed = 0, mse = 0, flip = 0, hdr_flip = 0;
};

Differences differences(Image a, Image b, uint32_t blocks, Sink& sink) {
    check_comparable(a, b);
    Differences made = {.equal = picture_hash(a) == picture_hash(b)};
    if (blocks > 1) {
        a = block_means(a, blocks);
        b = block_means(b, blocks);
    }
    made.rel_mse = relative_error(a, b, 1.0).rel_mse;
    made.trimmed = relative_error(a, b).rel_mse;
    made.mse = mean_squared_error(a, b);
    sink.check();
    made.flip = flip(a, b).mean;
    sink.check();
    made.hdr_flip = hdr_flips({&a}, b, kDefaultPixelsPerDegree, &sink).front().mean;
    return made;
}

nb::dict compare(nb::handle picture, nb::handle reference, uint32_t blocks) {
    if (blocks == 0) throw Error(ErrorCode::BadInput, "blocks", "0", "expected at least 1");
    Image a = compared(picture, "picture"), b = compared(reference, "reference");
    if (a.width != b.width || a.height != b.height) {
        throw Error(ErrorCode::BadInput, "reference", fmt::format("{}x{}", b.width, b.height),
                    fmt::format("expected the picture's size, {}x{}", a.width, a.height));
    }
    const Differences made =
        result_of([&](PythonSink& sink) { return differences(std::move(a), std::move(b), blocks, sink); });
    nb::dict result;
    result["rel_mse"] = made.rel_mse;
    result["rel_mse_98"] = made.trimmed;
    result["mse"] = made.mse;
    result["flip"] = made.flip;
    result["hdr_flip"] = made.hdr_flip;
    result["equal"] = made.equal;
    return result;
}

} // namespace

void define_images(nb::module_& module) {
    module.def("read", &read);
    module.def("write", &write, nb::arg("path"), nb::arg("picture").none(), nb::arg("curve"), nb::arg("exposure"));
    module.def("write_result", &write_result);
    module.def("tone_map", &tone_map_array, nb::arg("picture").none(), nb::arg("curve"), nb::arg("exposure"));
    module.def("compare", &compare, nb::arg("picture").none(), nb::arg("reference").none(), nb::arg("blocks"));
}

} // namespace pertev
