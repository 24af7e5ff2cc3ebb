#include "python/out_arrays.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <optional>

#include <nanobind/ndarray.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "python/argument_fields.h"

namespace nb = nanobind;

namespace pertev {
namespace {

/// Returns the group of layers that an attribute is named for; null if there is none.
const AovGroup* group_named(std::string_view name) {
    const auto* const found = std::ranges::find_if(
        kAovTable, [&](const AovGroup& group) { return name == (group.bit == kAovIds ? group.name : group.layer); });
    return found == std::end(kAovTable) ? nullptr : found;
}

/// Returns how many numbers a pixel has in the array of this name; none if there is no such array.
std::optional<std::size_t> channels_of(const std::string& name, const RenderSettings& settings) {
    if (is_picture(name)) return settings.transparent ? 4 : 3;
    if (const AovGroup* group = group_named(name)) {
        if ((settings.aovs & group->bit) == 0) return std::nullopt;
        return channel_names(*group).size();
    }
    const std::vector<std::string> light = light_layers_of(settings);
    if (std::ranges::find(light, name) == light.end()) return std::nullopt;
    return 3;
}

/// Returns the names of all arrays that a picture of these settings has.
std::vector<std::string> array_names_of(const RenderSettings& settings) {
    std::vector<std::string> names = {"color", "noisy"};
    for (const AovGroup& group : kAovTable)
        if ((settings.aovs & group.bit) != 0) names.emplace_back(group.bit == kAovIds ? group.name : group.layer);
    std::ranges::move(light_layers_of(settings), std::back_inserter(names));
    return names;
}

std::string dtype_name(nb::dlpack::dtype type) {
    using DtypeCode = nb::dlpack::dtype_code;
    const auto code = static_cast<DtypeCode>(type.code);
    if (code == DtypeCode::Bool) return "bool";
    const char* const kind = code == DtypeCode::Int       ? "int"
                             : code == DtypeCode::UInt    ? "uint"
                             : code == DtypeCode::Float   ? "float"
                             : code == DtypeCode::Bfloat  ? "bfloat"
                             : code == DtypeCode::Complex ? "complex"
                                                          : "another type of ";
    return fmt::format("{}{}", kind, type.bits);
}

constexpr const char* kReadOnly = "the array is read-only; expected one that can be written";

/// Returns whether the value is an array of JAX, none of which may change, though their DLPack does not say so.
bool is_of_jax(nb::handle value) {
    const nb::object module = nb::getattr(value.type(), "__module__", nb::none());
    if (!nb::isinstance<nb::str>(module)) return false;
    const std::string name = nb::str(module).c_str();
    const std::string package = name.substr(0, name.find('.'));
    return package == "jax" || package == "jaxlib";
}

/// Returns why an array that is no writable one of the host in the order of C cannot be filled.
std::string fault_of_array(nb::handle value) {
    nb::ndarray<nb::ro> array;
    if (!nb::try_cast(value, array, false)) {
        const nb::object dtype = nb::getattr(value, "dtype", nb::none());
        return fmt::format("{}{} is not an array with DLPack or the buffer protocol",
                           nb::type_name(value.type()).c_str(),
                           dtype.is_none() ? "" : fmt::format(" of {}", nb::str(dtype).c_str()));
    }
    if (array.device_type() == nb::device::cuda::value)
        return fmt::format("the array is on cuda:{}; expected one in the CPU's memory", array.device_id());
    if (array.device_type() != nb::device::cpu::value)
        return "the array is on another device; expected one in the CPU's memory";
    nb::ndarray<nb::device::cpu> writable;
    if (!nb::try_cast(value, writable, false)) return kReadOnly;
    return "the array is not C-contiguous; expected rows one after the other, without gaps";
}

std::size_t bytes_of(const OutArray& array) {
    std::size_t bytes = sizeof(float);
    for (const std::size_t length : array.shape) bytes *= length;
    return bytes;
}

/// Reads a film in the host's memory, once for all means.
void read_on_host(const Film& film, bool transparent, std::span<const OutArray> arrays) {
    const uint32_t pixels = film.width() * film.height();
    const auto floats_of = [](const OutArray& array) { return reinterpret_cast<float*>(array.memory); };
    const OutArray* picture = nullptr;
    std::vector<Film::LayerMemory> layers;
    for (const OutArray& array : arrays) {
        if (array.name == "ids") {
            std::memcpy(array.memory, film.view().ids, bytes_of(array));
        } else if (!is_picture(array.name)) {
            layers.push_back({group_named(array.name)->bit, floats_of(array)});
        } else if (picture == nullptr) {
            picture = &array;
        }
    }
    film.resolve_into(picture != nullptr ? floats_of(*picture) : nullptr, transparent, layers, pixels);
    for (const OutArray& array : arrays) { // color and noisy are the same
        if (is_picture(array.name) && array.memory != picture->memory)
            std::memcpy(array.memory, picture->memory, bytes_of(array));
    }
}

} // namespace

bool is_picture(std::string_view name) { return name == "color" || name == "noisy"; }

std::vector<OutArray> out_arrays(const nb::dict& out) {
    std::vector<OutArray> arrays;
    arrays.reserve(out.size());
    for (const auto& [key, value] : out) {
        OutArray& made = arrays.emplace_back();
        made.name = text_argument(key, "out");
        made.array = nb::borrow(value);
        if (is_of_jax(value)) {
            made.fault = kReadOnly;
            continue;
        }
        nb::ndarray<nb::c_contig, nb::device::cpu> array;
        if (!nb::try_cast(value, array, false)) {
            made.fault = fault_of_array(value);
            continue;
        }
        if (reinterpret_cast<std::uintptr_t>(array.data()) % alignof(float) != 0) {
            made.fault = "the array's address is not a multiple of 4";
            continue;
        }
        made.memory = static_cast<std::byte*>(array.data());
        for (std::size_t axis = 0; axis < array.ndim(); ++axis) made.shape.push_back(array.shape(axis));
        made.dtype = dtype_name(array.dtype());
    }
    return arrays;
}

const OutArray* find_array(std::span<const OutArray> arrays, std::string_view name) {
    const auto found = std::ranges::find(arrays, name, &OutArray::name);
    return found == arrays.end() ? nullptr : &*found;
}

void check_arrays(std::span<const OutArray> arrays, const RenderSettings& settings) {
    for (const OutArray& array : arrays) {
        const std::optional<std::size_t> channels = channels_of(array.name, settings);
        if (!channels) {
            throw Error(ErrorCode::BadInput, "out", array.name,
                        fmt::format("the picture has no such array; with these settings it has {}",
                                    fmt::join(array_names_of(settings), ", ")));
        }
        const std::size_t shape[] = {settings.window().height, settings.window().width, *channels};
        const std::span expected(shape, *channels > 1 ? 3 : 2);
        const char* const dtype = array.name == "ids" ? "uint32" : "float32";
        std::string fault = array.fault;
        if (fault.empty() && array.dtype != dtype) {
            fault = fmt::format("the array's dtype is {}; expected {}", array.dtype, dtype);
        } else if (fault.empty() && !std::ranges::equal(array.shape, expected)) {
            fault = fmt::format("the array's shape is ({}); expected ({})", fmt::join(array.shape, ", "),
                                fmt::join(expected, ", "));
        }
        if (!fault.empty()) throw Error(ErrorCode::BadInput, "out", array.name, fault);
    }
}

void copy_into(std::span<const OutArray> arrays, const RenderResult& result) {
    for (const OutArray& array : arrays) {
        const void* from = result.ids.data();
        if (array.name == "color" && result.denoised) {
            from = result.denoised->pixels.data();
        } else if (is_picture(array.name)) {
            from = result.picture.pixels.data();
        } else if (array.name != "ids") {
            from = layer_named(result, array.name).pixels.data();
        }
        std::memcpy(array.memory, from, bytes_of(array));
    }
}

void take_back(std::span<const OutArray> arrays, RenderResult& result) {
    for (const OutArray& array : arrays) {
        const auto fill = [&](auto& values) {
            values.resize(bytes_of(array) / sizeof(values[0]));
            std::memcpy(values.data(), array.memory, bytes_of(array));
        };
        if (array.name == "ids") {
            fill(result.ids);
        } else if (array.name == "color" && result.denoised) {
            fill(result.denoised->pixels);
        } else if (is_picture(array.name)) {
            fill(result.picture.pixels);
        } else {
            const AovGroup* const group = group_named(array.name);
            const Image& size = result.picture;
            const std::vector<std::string> channels =
                group != nullptr ? channel_names(*group) : std::vector<std::string>{"R", "G", "B"};
            FilmLayer& layer = result.layers.emplace_back(FilmLayer{array.name, channels, {}});
            layer.image = {size.width, size.height, static_cast<uint32_t>(channels.size()), {}};
            fill(layer.image.pixels);
        }
    }
}

bool FilmReader::reads(std::span<const OutArray> arrays, const RenderSettings& settings) {
    if (settings.is_denoised() || settings.range().count() == 0) return false;
    return std::ranges::all_of(arrays, [](const OutArray& array) {
        const AovGroup* const group = group_named(array.name);
        return is_picture(array.name) || (group != nullptr && group->bit != kAovMotion);
    });
}

void FilmReader::read(Session& session, const std::shared_ptr<Queue>& queue, std::span<const OutArray> arrays) {
    const Film& film = session.film();
    const uint32_t pixels = film.width() * film.height();
    const bool transparent = session.settings().transparent;
    const UseThreads use(queue->threads());
    Queue& of_film = session.pictures().film_queue(); // one of the CPU if several devices have rendered
    if (!of_film.is_cuda()) return read_on_host(film, transparent, arrays);
    for (const OutArray& array : arrays) {
        const std::size_t bytes = bytes_of(array);
        if (queue_ != queue || on_device_.size() < bytes) {
            on_device_ = {};
            queue_ = queue;
            on_device_ = {*queue, bytes, "arrays to be filled"};
        }
        std::byte* const to = on_device_.data();
        if (is_picture(array.name)) {
            film.resolve_into(reinterpret_cast<float*>(to), transparent, {}, pixels);
        } else if (array.name == "ids") {
            of_film.copy_on_device(to, film.view().ids, bytes);
        } else {
            const Film::LayerMemory layer = {group_named(array.name)->bit, reinterpret_cast<float*>(to)};
            film.resolve_into(nullptr, false, {&layer, 1}, pixels);
        }
        of_film.copy_to_host(array.memory, to, bytes);
    }
}

} // namespace pertev
