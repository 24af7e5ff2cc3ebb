#include "python/result.h"

#include <algorithm>
#include <span>

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <fmt/format.h>

#include "base/error.h"
#include "image/auto_exposure.h"
#include "image/picture_hash.h"
#include "image/tone_map_image.h"
#include "image/write_png.h"
#include "python/owned_array.h"
#include "python/transform_values.h"
#include "python/unlocked.h"
#include "render/camera_view.h"
#include "render/film_channels.h"
#include "session/writing/metadata_json.h"
#include "session/writing/write_picture.h"

namespace nb = nanobind;

namespace pertev {
namespace {

/// Returns an array of shape (height, width, channels), or (height, width) of one channel, in the memory of `owner`.
template <class Value>
nb::object array_of(Value* values, const Image& size, std::size_t channels, nb::handle owner) {
    const std::size_t shape[] = {size.height, size.width, channels};
    return nb::cast(nb::ndarray<nb::numpy, Value>(values, channels > 1 ? 3 : 2, shape, owner));
}

/// Returns the hash, which is made without the interpreter's lock at the first request.
const std::string& hash_of(PythonResult& self) {
    if (!self.hash.empty()) return self.hash;
    std::string made = result_of([&](PythonSink&) { return picture_hash(self.result.picture).hex(); });
    if (self.hash.empty()) self.hash = std::move(made); // else another thread has made it, and may have changed arrays
    return self.hash;
}

/// Returns the result, whose hash is known before its arrays can be changed.
PythonResult& hashed(nb::handle owner) {
    PythonResult& result = nb::cast<PythonResult&>(owner);
    hash_of(result);
    return result;
}

nb::object array_of(Image& image, nb::handle owner) {
    return array_of(image.pixels.data(), image, image.channels, owner);
}

nb::object noisy_of(nb::handle owner) {
    PythonResult& self = hashed(owner);
    const OutArray* array = find_array(self.out, "noisy");
    if (array == nullptr && self.result.picture.pixels.empty()) array = find_array(self.out, "color");
    return array != nullptr ? array->array : array_of(self.result.picture, owner);
}

nb::object color_of(nb::handle owner) {
    PythonResult& self = hashed(owner);
    if (const OutArray* array = find_array(self.out, "color")) return array->array;
    return self.result.denoised ? array_of(*self.result.denoised, owner) : array_of(self.result.picture, owner);
}

/// Returns the layers by their names; `id` is of uint32.
nb::dict layers_of(nb::handle owner) {
    PythonResult& self = hashed(owner);
    nb::dict layers;
    for (const OutArray& array : self.out) {
        if (!is_picture(array.name)) layers[array.name == "ids" ? "id" : array.name.c_str()] = array.array;
    }
    for (FilmLayer& layer : self.result.layers) layers[layer.name.c_str()] = array_of(layer.image, owner);
    if (!self.result.ids.empty()) {
        static_assert(sizeof(PixelIds) == 3 * sizeof(uint32_t));
        layers["id"] = array_of(&self.result.ids.front().instance, self.result.picture, 3, owner);
    }
    return layers;
}

/// Returns a layer that is read as an attribute. Throws AttributeError if it was not requested.
nb::object layer_of(nb::handle owner, const char* name) {
    const nb::dict layers = layers_of(owner);
    if (!layers.contains(name)) {
        throw nb::attribute_error(fmt::format("there is no layer '{}'; request it by layers=['{}']", name,
                                              std::string(name) == "id" ? "ids" : name)
                                      .c_str());
    }
    return layers[name];
}

nb::dict info_of(PythonResult& self) {
    return info_of_metadata(file_metadata(self.facts(), self.result, hash_of(self)));
}

/// Returns the record of a rendered picture. Throws AttributeError for a merged one.
const PictureRecord& record_of(const PythonResult& self) {
    if (!self.record) throw nb::attribute_error("a merged picture has its camera in `info` alone");
    return *self.record;
}

/// Returns the picture as PNG for notebooks, at the exposure that fits it.
nb::bytes png_of_result(const PythonResult& self) {
    const std::vector<std::byte> png = result_of([&](PythonSink&) {
        const RenderResult whole = self.whole();
        return png_of({whole.denoised ? &*whole.denoised : &whole.picture, 1}, 1);
    });
    return nb::bytes(reinterpret_cast<const char*>(png.data()), png.size());
}

/// Metadata that are texts of JSON.
constexpr std::string_view kJsonTexts[] = {"pertev.settings",   "pertev.made_up",   "pertev.left_out",
                                           "pertev.instances",  "pertev.materials", "pertev.reconstruction",
                                           "pertev.row_samples"};

} // namespace

std::vector<double> pose_of(const PictureRecord& record) {
    return values_of(record.camera.camera.world_from_camera, record.camera.origin);
}

std::vector<double> intrinsics_of(const PictureRecord& record) {
    const Camera& camera = record.camera.camera;
    if (has_parallel_rays(camera.projection)) throw nb::attribute_error("an orthographic camera has no K");
    const auto width = static_cast<double>(record.settings.width), height = static_cast<double>(record.settings.height);
    const double focal = 0.5 * height / static_cast<double>(half_view_height(camera));
    const Intrinsics k = camera.intrinsics.value_or(
        Intrinsics{focal, focal, 0.5 * width, 0.5 * height, record.settings.width, record.settings.height});
    const double x = width / k.width, y = height / k.height;
    const PixelWindow window = record.settings.window(); // pixels of a crop count from its own corner
    return {x * k.focal_x, 0, x * k.centre_x - window.x, 0, y * k.focal_y, y * k.centre_y - window.y, 0, 0, 1};
}

std::vector<std::byte> png_of(std::span<const Image> pictures, uint32_t columns) {
    const Image& first = pictures.front();
    const auto rows = static_cast<uint32_t>((pictures.size() + columns - 1) / columns);
    Image image = {first.width * columns, first.height * rows, first.channels, {}};
    image.pixels.resize(std::size_t(image.width) * image.height * image.channels);
    const std::size_t length = std::size_t(first.width) * first.channels; // numbers in a picture's row
    for (std::size_t k = 0; k < pictures.size(); ++k) {
        for (uint32_t row = 0; row < first.height; ++row) {
            const std::size_t line = (k / columns * first.height + row) * columns + k % columns;
            std::copy_n(pictures[k].pixels.data() + row * length, length, image.pixels.data() + line * length);
        }
    }
    const float stops = auto_exposure_stops(image, ToneMap::Agx);
    return encode_png(tone_map_image(image, ToneMap::Agx, stops), image.channels == 4);
}

nb::dict info_of_metadata(const ExrMetadata& metadata) {
    nb::dict info;
    const nb::object parse = nb::module_::import_("json").attr("loads");
    for (const auto& entry : metadata) {
        const std::string_view name = entry.first;
        constexpr std::string_view kOurs = "pertev.";
        const std::string* text = std::get_if<std::string>(&entry.second);
        const bool holds_json = text != nullptr && std::ranges::find(kJsonTexts, name) != std::end(kJsonTexts);
        info[std::string(name.starts_with(kOurs) ? name.substr(kOurs.size()) : name).c_str()] =
            parse(holds_json ? *text : metadata_json(entry));
    }
    return info;
}

const std::string& PythonResult::known_hash() {
    if (hash.empty()) hash = picture_hash(result.picture).hex();
    return hash;
}

std::span<const PixelIds> PythonResult::ids() const {
    const OutArray* array = find_array(out, "ids");
    if (array == nullptr) return result.ids;
    return {reinterpret_cast<const PixelIds*>(array->memory),
            std::size_t(result.picture.width) * result.picture.height};
}

RenderResult PythonResult::whole() const {
    RenderResult all = result;
    take_back(out, all);
    return all;
}

void define_result(nb::module_& module) {
    nb::class_<PythonResult> result(module, "Result", nb::is_final(), R"(A rendered picture.

Arrays share the memory of the result, which lives as long as one of them does, or are those of the caller
(`out` of render()). Row 0 is the top row.)");
    result.def_prop_ro(
        "color", &color_of,
        "float32 (height, width, 3), or 4 with transparent=True: linear Rec. 709, denoised if that was requested");
    result.def_prop_ro("noisy", &noisy_of,
                       "The mean of the samples, whether or not the picture was denoised; `hash` is of this array");
    result.def_prop_ro(
        "layers", [](nb::handle self) { return layers_of(self); }, "The requested layers by their names in an EXR");
    struct Named {
        const char *name, *layer, *text;
    };
    for (const Named& named :
         {Named{"albedo", "albedo", "float32 (height, width, 3): reflectance of the first surface"},
          Named{"normal", "normal", "float32 (height, width, 3): its shading normal, world space"},
          Named{"depth", "depth", "float32 (height, width): its distance along the camera's axis, metres"},
          Named{"distance", "distance", "float32 (height, width): its distance along the ray, metres"},
          Named{"position", "position", "float32 (height, width, 3): its position in the file's coordinates, metres"},
          Named{"motion", "motion", "float32 (height, width, 2): its motion since the frame before, pixels"},
          Named{"uv", "uv", "float32 (height, width, 2): its texture coordinates"},
          Named{"ids", "id", "uint32 (height, width, 3): its instance, primitive and material"}}) {
        result.def_prop_ro(
            named.name, [layer = named.layer](nb::handle self) { return layer_of(self, layer); }, named.text);
    }
    result.def_prop_ro("info", &info_of, "The metadata that an EXR of this picture has, without their prefix");
    result.def_prop_ro("hash", &hash_of, "The picture's hash, as `pertev render` and `pertev info` print it");
    result.def_prop_ro(
        "pose",
        [](const PythonResult& self) {
            return owned_array(pose_of(record_of(self)), {4, 4});
        },
        "float64 (4, 4): the camera's position and axes, world from camera; it looks along -z, and y is up");
    result.def_prop_ro(
        "K",
        [](const PythonResult& self) {
            return owned_array(intrinsics_of(record_of(self)), {3, 3});
        },
        "float64 (3, 3): focal lengths and principal point in pixels from the upper left corner");
    result.def("_repr_png_", &png_of_result);
    result.def("__reduce__", [](const PythonResult&) -> nb::object {
        throw nb::type_error("a Result is not pickled; send its arrays, or a file of pertev.write()");
    });
    result.def_prop_ro(
        "_first_pixel_seconds", [](const PythonResult& self) { return self.result.first_pixel_seconds; },
        "Seconds that Session::render took until each pixel had its first sample, for tests");
    result.def_prop_ro(
        "samples", [](const PythonResult& self) { return self.result.samples; },
        "Samples of each pixel, or of the rows with the most; fewer than requested if time_limit ended the render");
    result.def_prop_ro(
        "seconds", [](const PythonResult& self) { return self.result.render_seconds; }, "Seconds of rendering alone");
    result.def("__repr__", [](PythonResult& self) {
        const Image& picture = self.result.picture;
        return fmt::format("<pertev.Result {}x{}, {} spp, {}>", picture.width, picture.height, self.result.samples,
                           hash_of(self));
    });
}

} // namespace pertev
