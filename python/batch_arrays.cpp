// Arrays of batches for other packages: NumPy's where the CPU rendered, else arrays on the GPU by DLPack and
// __cuda_array_interface__.

#include <algorithm>
#include <cmath>
#include <optional>

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <fmt/format.h>

#include "base/error.h"
#include "python/batch.h"
#include "python/owned_array.h"
#include "python/result.h"
#include "python/unlocked.h"

namespace nb = nanobind;

namespace pertev {
namespace {

/// An array in a GPU's memory. The work on it has ended, so no stream needs to wait for another.
struct DeviceArray {
    nb::object batch; // keeps the memory
    std::vector<std::size_t> shape;
    PythonBatch::Array array;
    int device;

    nb::object exported() const {
        const auto type = array.is_float ? nb::dtype<float>() : nb::dtype<uint32_t>();
        return nb::cast(nb::ndarray<nb::array_api>(array.values, shape.size(), shape.data(), batch, nullptr, type,
                                                   nb::device::cuda::value, device));
    }
};

/// Returns what `work` gives while no other thread fills the batch, without the interpreter's lock.
auto in_turn(const PythonBatch& batch, const auto& work) {
    return result_of([&](PythonSink& sink) {
        const std::unique_lock turn = batch.wait_for_turn(sink);
        return work();
    });
}

/// The arrays of a batch at one time.
struct Arrays {
    std::vector<PythonBatch::Array> all;
    std::vector<std::size_t> shape; // each array of one channel has it
    std::optional<int> cuda_device; // none: they are in the memory of the host
};

Arrays arrays_in_turn(const PythonBatch& batch) {
    return in_turn(batch, [&] {
        Arrays arrays = {batch.arrays(), batch.shape(), std::nullopt};
        if (!batch.is_empty() && batch.queue().is_cuda()) arrays.cuda_device = batch.queue().device_index();
        return arrays;
    });
}

nb::object array_of(const Arrays& of, const PythonBatch::Array& array, nb::handle self) {
    std::vector<std::size_t> shape = of.shape;
    if (array.channels > 1) shape.push_back(array.channels);
    if (of.cuda_device) return nb::cast(DeviceArray{nb::borrow(self), shape, array, *of.cuda_device});
    if (array.is_float) {
        return nb::cast(
            nb::ndarray<nb::numpy, float>(static_cast<float*>(array.values), shape.size(), shape.data(), self));
    }
    return nb::cast(
        nb::ndarray<nb::numpy, uint32_t>(static_cast<uint32_t*>(array.values), shape.size(), shape.data(), self));
}

nb::object array_named(nb::handle self, const Arrays& of, const std::string& name) {
    for (const PythonBatch::Array& array : of.all) {
        if (array.name == name) return array_of(of, array, self);
    }
    if (name == "color") throw nb::attribute_error("there is no array 'color'; request it by color=True");
    throw nb::attribute_error(fmt::format("there is no array '{}'; request it by layers=['{}']", name, name).c_str());
}

/// A value of each picture.
template <class Value>
struct OfPictures {
    bool is_single;
    std::vector<Value> all;
};

/// Returns what `of` gives for each picture, all of them of one call.
auto of_all(const PythonBatch& batch, const auto& of) {
    return in_turn(batch, [&] {
        OfPictures<decltype(of(0))> values = {batch.is_single(), {}};
        for (std::size_t k = 0; k < batch.count(); ++k) values.all.push_back(of(k));
        return values;
    });
}

/// Returns the object that `made` makes of the single picture's value, or a list of those of all pictures.
nb::object of_pictures(const auto& values, const auto& made) {
    if (values.is_single) return made(values.all.front());
    nb::list all;
    for (const auto& value : values.all) all.append(made(value));
    return all;
}

nb::object hashes_of(const PythonBatch& batch) {
    const auto hashes = of_all(batch, [&](std::size_t k) {
        if (const auto hash = batch.hash(k)) return *hash;
        throw nb::attribute_error("a hash is that of `color`, which was not requested");
    });
    return of_pictures(hashes, [](const std::string& hash) -> nb::object { return nb::str(hash.c_str()); });
}

nb::object infos_of(const PythonBatch& batch) {
    const auto metadata = of_all(batch, [&](std::size_t k) { return batch.metadata(k); });
    return of_pictures(metadata, [](const ExrMetadata& of) -> nb::object { return info_of_metadata(of); });
}

/// Returns an array of float64 of what `of` gives for the record of each picture, with `rows` rows.
nb::object of_records(const PythonBatch& batch, std::size_t rows, const auto& of) {
    const auto records = of_all(batch, [&](std::size_t k) { return batch.record_of(k); });
    std::vector<double> values;
    for (const PictureRecord& record : records.all) {
        const std::vector<double> own = of(record);
        values.insert(values.end(), own.begin(), own.end());
    }
    if (records.is_single) return owned_array(std::move(values), {rows, rows});
    return owned_array(std::move(values), {records.all.size(), rows, rows});
}

/// Returns the first pictures as PNG for notebooks, at most 16; none without colour.
nb::object png_of_batch(const PythonBatch& batch) {
    const std::vector<std::byte> png = in_turn(batch, [&] {
        if (!batch.has_color()) return std::vector<std::byte>();
        std::vector<Image> pictures;
        for (std::size_t k = 0; k < std::min<std::size_t>(batch.count(), 16); ++k) {
            RenderResult result = batch.picture(k).result;
            pictures.push_back(std::move(result.denoised ? *result.denoised : result.picture));
        }
        const auto columns = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(pictures.size()))));
        return png_of(pictures, columns);
    });
    if (png.empty()) return nb::none();
    return nb::bytes(reinterpret_cast<const char*>(png.data()), png.size());
}

/// Returns the array of means of samples, denoised or not.
nb::object noisy_of(nb::handle self) {
    const Arrays of = arrays_in_turn(nb::cast<const PythonBatch&>(self));
    const bool is_denoised = std::ranges::find(of.all, "noisy", &PythonBatch::Array::name) != of.all.end();
    return array_named(self, of, is_denoised ? "noisy" : "color");
}

PythonResult picture_of(const PythonBatch& batch, nb::handle index) {
    if (PyIndex_Check(index.ptr()) == 0)
        throw nb::type_error(fmt::format("number: expected a whole number, not {}", nb::repr(index).c_str()).c_str());
    const int64_t number = PyNumber_AsSsize_t(index.ptr(), PyExc_IndexError);
    if (number == -1 && PyErr_Occurred() != nullptr) throw nb::python_error();
    return in_turn(batch, [&] {
        const auto count = static_cast<int64_t>(batch.count());
        if (number < -count || number >= count)
            throw nb::index_error(fmt::format("there are {} pictures", count).c_str());
        if (!batch.has_color()) throw nb::attribute_error("a batch without colour has arrays alone");
        return batch.picture(static_cast<std::size_t>(number < 0 ? number + count : number));
    });
}

nb::dict arrays_of(nb::handle self) {
    nb::dict arrays;
    const Arrays of = arrays_in_turn(nb::cast<const PythonBatch&>(self));
    for (const PythonBatch::Array& array : of.all) arrays[array.name.c_str()] = array_of(of, array, self);
    return arrays;
}

/// Returns a copy of an array in the memory of the host, as NumPy's.
nb::object host_copy(const DeviceArray& self) {
    const PythonBatch& batch = nb::cast<const PythonBatch&>(self.batch);
    auto* bytes = new std::vector<std::byte>(in_turn(batch, [&] { return batch.download(self.array); }));
    const nb::capsule owner(bytes, [](void* p) noexcept { delete static_cast<std::vector<std::byte>*>(p); });
    const auto type = self.array.is_float ? nb::dtype<float>() : nb::dtype<uint32_t>();
    return nb::cast(nb::ndarray<nb::numpy>(bytes->data(), self.shape.size(), self.shape.data(), owner, nullptr, type));
}

nb::dict cuda_array_interface(const DeviceArray& self) {
    nb::dict description;
    description["shape"] = nb::tuple(nb::cast(self.shape));
    description["typestr"] = self.array.is_float ? "<f4" : "<u4";
    description["data"] = nb::make_tuple(reinterpret_cast<std::uintptr_t>(self.array.values), false);
    description["version"] = 3;
    description["strides"] = nb::none();
    description["stream"] = nb::none();
    return description;
}

} // namespace

void define_batch(nb::module_& module) {
    nb::class_<DeviceArray>(module, "DeviceArray", nb::is_final(),
                            R"(An array in a GPU's memory, for PyTorch, JAX, CuPy or Warp.

It has DLPack (`torch.from_dlpack(array)`) and `__cuda_array_interface__`, shares the memory of its BatchResult and keeps
it. Its contents are complete, so any stream may use it. Before `out=` fills it again, and before numpy(), work that is
queued on any stream of the device ends.)")
        .def("__dlpack__",
             [](const DeviceArray& self, const nb::kwargs& how) { return self.exported().attr("__dlpack__")(**how); })
        .def("__dlpack_device__",
             [](const DeviceArray& self) { return nb::make_tuple(int(nb::device::cuda::value), self.device); })
        .def_prop_ro("__cuda_array_interface__", &cuda_array_interface)
        .def("numpy", &host_copy, "A copy in the host's memory; numpy.asarray() makes one too.")
        .def(
            "__array__",
            [](const DeviceArray& self, const nb::object& dtype, const nb::object&) {
                const nb::object copy = host_copy(self);
                return dtype.is_none() ? copy : nb::object(copy.attr("astype")(dtype));
            },
            nb::arg("dtype") = nb::none(), nb::arg("copy") = nb::none())
        .def_prop_ro("shape", [](const DeviceArray& self) { return nb::tuple(nb::cast(self.shape)); })
        .def("__repr__", [](const DeviceArray& self) {
            return fmt::format("<pertev.DeviceArray {} on cuda:{}>", self.array.name, self.device);
        });
    nb::class_<PythonBatch> batch(module, "BatchResult", nb::is_final(),
                                  R"(Pictures of one scene by many cameras, or one on the device.

Arrays are of NumPy where the CPU rendered, else DeviceArrays, and share the memory of the result, which lives as long as one
of them does. The first axis counts the cameras (a single picture has no such axis), and row 0 of a picture is the top.)");
    struct Named {
        const char *name, *text;
    };
    for (const Named& named :
         {Named{"color", "float32 (N, height, width, 3), or 4 with transparent=True: linear Rec. 709, denoised if that "
                         "was requested"},
          Named{"albedo", "float32 (N, height, width, 3): reflectance of the first surface"},
          Named{"normal", "float32 (N, height, width, 3): its shading normal, world space"},
          Named{"depth", "float32 (N, height, width): its distance along the camera's axis, metres"},
          Named{"distance", "float32 (N, height, width): its distance along the ray, metres"},
          Named{"position", "float32 (N, height, width, 3): its position in the file's coordinates, metres"},
          Named{"ids", "uint32 (N, height, width, 3): its instance, primitive and material"}}) {
        batch.def_prop_ro(
            named.name,
            [name = named.name](nb::handle self) {
                return array_named(self, arrays_in_turn(nb::cast<const PythonBatch&>(self)), name);
            },
            named.text);
    }
    batch.def(nb::init<>())
        .def_prop_ro("arrays", &arrays_of, "All arrays by their names")
        .def_prop_ro(
            "info", &infos_of,
            "The metadata that an EXR of each picture has, without their prefix: a list of dictionaries, or one "
            "of a single picture")
        .def_prop_ro(
            "hash", &hashes_of,
            "The hash of each picture as `color` holds it now, or as it was before it was denoised: a list, or "
            "a text of a single picture")
        .def_prop_ro("noisy", &noisy_of, "The means of the samples, whether or not the pictures were denoised")
        .def_prop_ro(
            "pose", [](const PythonBatch& self) { return of_records(self, 4, &pose_of); },
            "float64 (N, 4, 4): positions and axes of the cameras, world from camera; they look along -z, and y is up")
        .def_prop_ro(
            "K", [](const PythonBatch& self) { return of_records(self, 3, &intrinsics_of); },
            "float64 (N, 3, 3): focal lengths and principal points in pixels from the upper left corner")
        .def_prop_ro(
            "samples", [](const PythonBatch& self) { return in_turn(self, [&] { return self.samples(); }); },
            "Samples of each pixel")
        .def("picture", &picture_of, nb::arg("number").none() = 0,
             nb::sig("def picture(self, number: int = 0) -> Result"),
             "A copy of one picture as a Result, in the host's memory")
        .def("_repr_png_", &png_of_batch)
        .def("__reduce__",
             [](const PythonBatch&) -> nb::object {
                 throw nb::type_error("a BatchResult is not pickled; send copies of its arrays");
             })
        .def_prop_ro(
            "seconds", [](const PythonBatch& self) { return in_turn(self, [&] { return self.seconds(); }); },
            "Seconds of rendering alone")
        .def("__len__", [](const PythonBatch& self) { return in_turn(self, [&] { return self.count(); }); })
        .def("__repr__", [](const PythonBatch& self) {
            return in_turn(self, [&] {
                const std::vector<std::size_t> shape = self.shape();
                return fmt::format("<pertev.BatchResult of {} pictures {}x{}>", self.count(), shape.back(),
                                   shape[shape.size() - 2]);
            });
        });
}

} // namespace pertev
