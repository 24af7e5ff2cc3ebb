// The Python module `pertev._core`: the table of settings, rendering, errors. The package around it
// (python/pertev/__init__.py) makes texts of Python's values.

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <type_traits>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "apps/cli/commands.h"
#include "apps/cli/suggest_name.h"
#include "base/error.h"
#include "base/parallel_for.h"
#include "base/version.h"
#include "denoise/oidn/oidn_library.h"
#include "formats/builtin_scenes.h"
#include "formats/cameras/read_cameras.h"
#include "formats/gltf_writer/write_glb.h"
#include "image/write_image.h"
#include "python/array_argument.h"
#include "python/contents_hash.h"
#include "python/images.h"
#include "python/owned_array.h"
#include "python/python_sink.h"
#include "python/result.h"
#include "python/scene.h"
#include "python/scene_arrays.h"
#include "python/session.h"
#include "python/unlocked.h"
#include "scene/scene_origin.h"
#include "scene/validate/validate.h"
#include "session/degrees.h"
#include "session/photometry.h"
#include "session/pictures/check_options.h"
#include "session/pictures/merge_picture.h"
#include "settings/setting_table.h"

namespace nb = nanobind;

namespace pertev {
namespace {

/// Names the type of a setting's values: bool, int, float, size, vector, list, choice or text.
const char* type_of(const Setting& setting) {
    if (is_switch(setting)) return "bool";
    if (is_list(setting)) return "list";
    if (is_vector(setting)) return "vector";
    return read_field({}, setting, []<class Field>(const Field&) {
        using Value = std::remove_pointer_t<Field>;
        constexpr auto is_one_of = []<class... Types>() { return (std::is_same_v<Value, Types> || ...); };
        if (is_one_of.template operator()<uint32_t, std::optional<uint32_t>>()) return "int";
        if (is_one_of.template operator()<float, std::optional<float>, double, std::optional<double>>()) return "float";
        if (is_one_of.template operator()<std::optional<PictureSize>>()) return "size";
        return is_one_of.template operator()<NamedField>() ? "choice" : "text";
    });
}

/// Returns a row of the table as Python needs it.
nb::dict row_of(const Setting& setting) {
    nb::dict row;
    row["name"] = setting.name;
    row["group"] = std::string(name_of(setting.group));
    row["form"] = setting.form;
    row["sentence"] = setting.sentence;
    row["unit"] = setting.unit;
    row["choices"] = choices_of(setting);
    row["type"] = type_of(setting);
    row["excludes"] = setting.excludes;
    row["is_viewed"] = (setting.verbs & kView) != 0;
    row["default"] = texts_of(PictureOptions(), setting);
    return row;
}

/// Returns the settings of parts and checkpoints, which a call for a single picture has.
std::vector<nb::dict> settings_of_parts() {
    std::vector<nb::dict> rows;
    for (const Setting& setting : all_settings())
        if (setting.group == SettingGroup::Parts) rows.push_back(row_of(setting));
    return rows;
}

/// Returns the settings of any picture, or those of frames: `frames`, `turntable` and what needs these, whatever value
/// of another setting is needed beside them, except `continue`, which is about files.
std::vector<nb::dict> settings_of(bool frames) {
    std::vector<nb::dict> rows;
    std::set<std::string, std::less<>> of_sequences = {"frames", "turntable", "cameras", "stereo"};
    for (const Setting& setting : all_settings()) {
        std::vector<std::string> needs = words_of(setting.needs);
        std::erase_if(needs, [](const std::string& need) { return need.find('=') != std::string::npos; });
        const auto is_of_sequences = [&](const std::string& name) { return of_sequences.contains(name); };
        if (!needs.empty() && std::ranges::all_of(needs, is_of_sequences)) of_sequences.insert(setting.name);
        if ((setting.verbs & kRender) == 0 || is_of_sequences(setting.name) != frames) continue;
        if (setting.name != std::string_view("continue") && setting.group != SettingGroup::Parts)
            rows.push_back(row_of(setting));
    }
    return rows;
}

PythonResult render(PythonScene& scene, const std::string& settings_file, const SettingTexts& settings,
                    const std::vector<std::string>& outputs, const std::optional<nb::dict>& out) {
    std::vector<OutArray> arrays = out ? out_arrays(*out) : std::vector<OutArray>();
    PythonResult made = result_of([&](PythonSink& sink) {
        return scene.render({settings_file, settings, true}, outputs, arrays, sink);
    });
    made.out = std::move(arrays);
    return made;
}

PythonResult merge(const std::vector<std::string>& files, bool is_partial, const std::vector<std::string>& outputs,
                   const std::string& tone_map, const std::string& exposure) {
    if (files.empty()) throw Error(ErrorCode::BadInput, "files", "", "there is no film file");
    return result_of([&](PythonSink& sink) {
        PictureOptions options;
        if (!tone_map.empty()) set_value(options, *find_setting("tone_map"), std::vector{tone_map});
        if (!exposure.empty()) set_value(options, *find_setting("exposure"), std::vector{exposure});
        MergedPicture picture = merge_picture(files, is_partial, options, outputs, sink);
        PythonResult made(std::move(picture.result), std::move(picture.facts));
        if (outputs.empty()) return made;
        RenderResult written_result = made.result; // files take the layers out of it
        WrittenPicture written = write_picture(outputs, *made.merged, written_result);
        written.files.insert(written.files.end(), picture.films.begin(), picture.films.end());
        refuse_faults(written, made.result.invalid_samples, false);
        return made;
    });
}

/// Makes a scene of arrays if there are parts, else of a file.
void make_scene(PythonScene* scene, const std::string& name, const SettingTexts& settings, const nb::object& parts) {
    EditedScene source = {.name = name, .arrays = nullptr, .hash_of_arrays = "", .edits = {}};
    if (!parts.is_none()) {
        auto arrays = std::make_shared<Scene>(scene_of_arrays(nb::cast<nb::dict>(parts)));
        source.hash_of_arrays = result_of([&](PythonSink& sink) {
            validate(*arrays, name, sink);
            sink.check();
            return hash_of_contents(*arrays);
        });
        source.arrays = std::move(arrays);
    }
    new (scene) PythonScene(std::move(source), settings);
}

nb::object array_of(const PythonScene::Value& value) {
    if (value.shape.empty()) return nb::float_(value.values.front());
    return owned_array(value.values, value.shape);
}

nb::object parameter(PythonScene& scene, const std::string& path) {
    const auto value = result_of([&](PythonSink& sink) { return scene.value(path, sink); });
    return value ? array_of(*value) : nb::none();
}

/// Returns the numbers of each element of the first axis.
std::vector<std::vector<double>> rows_of(const ArrayArgument& array) {
    std::vector<std::vector<double>> rows;
    const std::vector<double> values = array.doubles();
    const std::size_t count = array.length(0), each = values.size() / std::max<std::size_t>(count, 1);
    for (std::size_t k = 0; k < count; ++k) {
        rows.emplace_back(values.begin() + static_cast<std::ptrdiff_t>(k * each),
                          values.begin() + static_cast<std::ptrdiff_t>((k + 1) * each));
    }
    return rows;
}

/// Returns the cameras of a call: `poses` (N, 4, 4) or (N, 3, 4), `intrinsics` (1 or N, 3, 3) or (1 or N, 4), and
/// `seeds` (1 or N,), each of which may be None; without poses it is a single picture.
CamerasArgument cameras_of(nb::handle poses, nb::handle intrinsics, nb::handle seeds, bool has_color) {
    constexpr std::size_t kAny = ArrayArgument::kAny;
    if (poses.is_none()) return {.poses = {}, .intrinsics = {}, .seeds = {}, .has_color = has_color, .is_single = true};
    const ArrayArgument places(poses, "cameras");
    if (!places.has_shape({kAny, 4, 4}) && !places.has_shape({kAny, 3, 4}))
        places.fail("expected (N, 4, 4) or (N, 3, 4)");
    CamerasArgument cameras;
    cameras.poses = rows_of(places.of_finite_numbers());
    cameras.has_color = has_color;
    const std::size_t count = cameras.poses.size();
    if (count == 0) places.fail("expected at least one camera");
    if (!intrinsics.is_none()) {
        const ArrayArgument array(intrinsics, "K");
        cameras.intrinsics = rows_of(array.of_finite_numbers());
        const std::size_t rows = cameras.intrinsics.size();
        const bool has_shape = array.has_shape({kAny, 3, 3}) || array.has_shape({kAny, 4});
        if (!has_shape || (rows != 1 && rows != count)) array.fail("expected (3, 3), or (N, 3, 3) for N cameras");
    }
    if (!seeds.is_none()) {
        const ArrayArgument array(seeds, "seeds");
        cameras.seeds = array.indices(std::size_t{1} << 32);
        if (array.axes() != 1 || (cameras.seeds.size() != 1 && cameras.seeds.size() != count)) {
            array.fail("expected one, or one for each camera");
        }
    }
    return cameras;
}

nb::object render_batch(PythonScene& scene, const std::string& settings_file, const SettingTexts& settings,
                        nb::handle poses, nb::handle intrinsics, nb::handle seeds, bool has_color, nb::object out) {
    const CamerasArgument cameras = cameras_of(poses, intrinsics, seeds, has_color);
    if (out.is_none()) out = nb::cast(PythonBatch());
    if (!nb::isinstance<PythonBatch>(out)) {
        throw Error(ErrorCode::BadInput, "out", "",
                    fmt::format("with `cameras` or `on_device` expected the BatchResult of an earlier call, not {}",
                                nb::type_name(out.type()).c_str()));
    }
    PythonBatch& batch = nb::cast<PythonBatch&>(out);
    run_unlocked([&](PythonSink& sink) { scene.render_batch({settings_file, settings}, cameras, batch, sink); });
    return out;
}

uint32_t batch_size(PythonScene& scene, const std::string& settings_file, const SettingTexts& settings,
                    nb::handle poses, nb::handle intrinsics, nb::handle seeds, bool has_color) {
    const CamerasArgument cameras = cameras_of(poses, intrinsics, seeds, has_color);
    return result_of([&](PythonSink& sink) { return scene.batch_size({settings_file, settings}, cameras, sink); });
}

bool set_parameter(PythonScene& scene, const std::string& path, nb::handle value) {
    const ArrayArgument array(value, path);
    PythonScene::Value given = {.shape = {}, .values = array.doubles()};
    for (std::size_t axis = 0; axis < array.axes(); ++axis) given.shape.push_back(array.length(axis));
    return result_of([&](PythonSink& sink) { return scene.set_value(path, given, sink); });
}

nb::dict edits_of(PythonScene& scene) {
    nb::dict edits;
    for (const auto& [path, value] : result_of([&](PythonSink& sink) { return scene.edits(sink); })) {
        edits[path.c_str()] = array_of(value);
    }
    return edits;
}

/// Returns the names of instances and of materials.
std::pair<std::vector<std::string>, std::vector<std::string>> names_of(PythonScene& scene) {
    return result_of([&](PythonSink& sink) {
        SceneSource source;
        scene.with_opened(sink, [&](const Scene& opened) { name_ids(opened, source); });
        return std::pair(source.instances, source.materials);
    });
}

nb::object bounds_of_scene(PythonScene& scene) {
    const std::vector<double> corners = result_of([&](PythonSink& sink) {
        std::vector<double> values;
        scene.with_opened(sink, [&](const Scene& opened) {
            const Bounds3 bounds = bounds_of(opened);
            for (const Vec3 corner : {bounds.lo, bounds.hi}) {
                const DoubleVec3 p = in_file(opened, corner);
                values.insert(values.end(), {p.x, p.y, p.z});
            }
        });
        return values;
    });
    return owned_array(corners, {2, 3});
}

/// Writes the opened scene as glTF, and the environment's image as EXR if it has a path. Returns the settings that
/// state what glTF does not: environment, lumens per watt and a generated ground.
std::map<std::string, std::string> save_scene(PythonScene& scene, const std::string& path,
                                              const std::string& environment_path) {
    return result_of([&](PythonSink& sink) {
        const SceneOptions options = scene.options_of({}, sink).scene;
        const double efficacy = lumens_per_watt(options.scene, static_cast<double>(options.efficacy));
        Scene saved = scene.copy(sink);
        const bool has_ground = std::erase_if(saved.instances, [](const Instance& of) { return of.is_background; }) > 0;
        std::map<std::string, std::string> settings = {{"ground", has_ground ? "on" : "off"},
                                                       {"efficacy", fmt::format("{}", efficacy)}};
        if (!environment_path.empty() && saved.environment) {
            auto& [image, scale, rotation] = *saved.environment;
            settings["environment"] = fmt::format("{},{},{}", scale.r, scale.g, scale.b);
            if (!image.pixels.empty()) {
                const float factors[3] = {scale.r, scale.g, scale.b};
                for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] *= factors[i % 3];
                write_image(environment_path, image);
                settings["environment"] = environment_path;
            }
            settings["environment_rotation"] = fmt::format("{}", degrees_for(rotation));
            saved.environment.reset();
        }
        write_glb(path, saved, sink);
        return settings;
    });
}

void define_scene(nb::module_& module) {
    nb::class_<PythonScene>(module, "Scene")
        .def("__init__", &make_scene, nb::arg("name"), nb::arg("settings"), nb::arg("parts").none())
        .def("_open", [](PythonScene& scene) { run_unlocked([&](PythonSink& sink) { scene.open(sink); }); })
        .def("_render", &render, nb::arg("file"), nb::arg("settings"), nb::arg("outputs"), nb::arg("out").none())
        .def("_render_batch", &render_batch, nb::arg("file"), nb::arg("settings"), nb::arg("poses").none(),
             nb::arg("intrinsics").none(), nb::arg("seeds").none(), nb::arg("has_color"), nb::arg("out").none())
        .def("_batch_size", &batch_size, nb::arg("file"), nb::arg("settings"), nb::arg("poses"),
             nb::arg("intrinsics").none(), nb::arg("seeds").none(), nb::arg("has_color"))
        .def("_paths",
             [](PythonScene& scene) { return result_of([&](PythonSink& sink) { return scene.paths(sink); }); })
        .def("_value", &parameter)
        .def("_set_value", &set_parameter, nb::arg("path"), nb::arg("value").none())
        .def("_edits", &edits_of)
        .def("_save", &save_scene)
        .def_prop_ro(
            "instance_names", [](PythonScene& scene) { return names_of(scene).first; },
            "Names of the instances; an id of the layer `ids` is the index of one")
        .def_prop_ro(
            "material_names", [](PythonScene& scene) { return names_of(scene).second; },
            "Names of the materials, by their ids")
        .def_prop_ro("bounds", &bounds_of_scene,
                     "float64 (2, 3): the least and the greatest corner of the box of all instances, metres")
        .def_prop_ro("_settings", &PythonScene::settings)
        .def_prop_ro("name", &PythonScene::name, "The file, or the name of a built-in scene or of a scene of arrays")
        .def("__repr__", [](const PythonScene& scene) { return "<pertev.Scene " + scene.name() + ">"; });
    nb::class_<PythonSession>(module, "Session")
        .def(
            "__init__",
            [](PythonSession* session, PythonScene& scene, SettingTexts settings) {
                run_unlocked([&](PythonSink&) {
                    Messages unsaid; // the first frame reports them
                    PictureOptions options = scene.options_of({"", settings}, unsaid);
                    complete_options(options, kRender);
                });
                new (session) PythonSession(scene, std::move(settings));
            },
            nb::keep_alive<1, 2>())
        .def("_next",
             [](PythonSession& session) { return result_of([&](PythonSink& sink) { return session.next(sink); }); })
        .def("_set",
             [](PythonSession& session, const SettingTexts& settings) {
                 run_unlocked([&](PythonSink& sink) { session.set(settings, sink); });
             })
        .def(
            "reset", [](PythonSession& session) { run_unlocked([&](PythonSink& sink) { session.reset(sink); }); },
            "Forgets earlier frames, so that the next one is the first.")
        .def_prop_ro(
            "frame",
            [](PythonSession& session) { return result_of([&](PythonSink& sink) { return session.frame(sink); }); },
            "Number of the next frame; None before the first")
        .def("__reduce__",
             [](const PythonSession&) -> nb::object {
                 throw nb::type_error("a Session is not pickled; send its scene, and make one in each process");
             })
        .def("__repr__", [](const PythonSession& session) { return "<pertev.Session " + session.scene_name() + ">"; });
}

/// Returns the name of each camera of a file, and the settings that state it.
std::vector<std::pair<std::string, std::map<std::string, std::string>>>
cameras_of_file(const std::string& path, uint32_t width, uint32_t height) {
    std::vector<std::pair<std::string, std::map<std::string, std::string>>> cameras;
    for (const CameraOfFile& camera : read_cameras(path, width, height)) {
        auto& [name, settings] = cameras.emplace_back(camera.name, std::map<std::string, std::string>());
        for (const SuggestedSetting& setting : camera.settings) settings[setting.name] = setting.text;
    }
    return cameras;
}

/// Returns the folder of the package pyoidn that `import pyoidn` would find now; empty if there is none.
std::string folder_of_pyoidn() {
    const auto release = [](const PyGILState_STATE* state) { PyGILState_Release(*state); };
    const PyGILState_STATE state = take_lock(&PyGILState_Ensure);
    const std::unique_ptr<const PyGILState_STATE, decltype(release)> lock(&state, release);
    try {
        const nb::object found = nb::module_::import_("importlib.util").attr("find_spec")("pyoidn");
        if (found.is_none() || found.attr("submodule_search_locations").is_none()) return "";
        const nb::object folder = found.attr("submodule_search_locations").attr("__getitem__")(0);
        return nb::cast<nb::bytes>(nb::module_::import_("os").attr("fsencode")(folder)).c_str();
    } catch (nb::python_error& error) { // a finder of the caller's failed, or the package is no folder
        if (error.matches(PyExc_KeyboardInterrupt)) PyErr_SetInterrupt(); // the render hears of it
        return "";
    }
}

/// Raises the package's exception for the error's code, with its parts as attributes.
void raise(const Error& error) {
    const FileLocation where = error.location().value_or(FileLocation{});
    const nb::object raised =
        nb::module_::import_("pertev.errors")
            .attr("made")(exit_status(error.code()), error.remark().text(), error.setting(), error.value(),
                          error.reason(), where.file, where.line, where.pointer.value_or(""));
    PyErr_SetObject(raised.type().ptr(), raised.ptr());
}

/// Raises the exception for an error that the program has printed as JSON.
void raise_parts(int status, const std::string& setting, const std::string& value, const std::string& reason,
                 const std::string& file, std::size_t line, const std::optional<std::string>& pointer) {
    Remark remark(setting, value, reason);
    if (!file.empty()) remark.location = FileLocation{file, line, pointer};
    throw Error(static_cast<ErrorCode>(status), std::move(remark));
}

} // namespace

NB_MODULE(_core, module) {
    nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
        try {
            std::rethrow_exception(thrown);
        } catch (const Error& error) {
            raise(error);
        }
    });
    nb::set_leak_warnings(false); // a thread may still render when the interpreter ends
    module.attr("__version__") = version();
    OidnLibrary::look_in(&folder_of_pyoidn);
    define_result(module);
    define_batch(module);
    module.def(
        "settings", [] { return settings_of(false); }, "The settings of a picture");
    module.def(
        "frame_settings", [] { return settings_of(true); }, "Additional settings of frames");
    module.def("part_settings", &settings_of_parts, "Additional settings of single pictures");
    module.def("read_cameras", &cameras_of_file);
    module.def("phrase", &python_text);
    module.def("suggest_name", [](const std::string& name, const std::vector<std::string>& names) {
        return suggest_name(name, names);
    });
    module.def("raise_parts", &raise_parts, nb::arg("status"), nb::arg("setting"), nb::arg("value"), nb::arg("reason"),
               nb::arg("file"), nb::arg("line"), nb::arg("pointer").none());
    module.def("builtin_scenes", &builtin_scene_names, "Names of the scenes that are part of Pertev");
    define_scene(module);
    define_images(module);
    module.def("merge", &merge, nb::arg("files"), nb::arg("partial"), nb::arg("outputs"), nb::arg("tone_map") = "",
               nb::arg("exposure") = "");
    module.def("_run_program", [](std::vector<std::string> words) {
        std::vector<char*> pointers;
        for (std::string& word : words) pointers.push_back(word.data());
        pointers.push_back(nullptr);
        const nb::gil_scoped_release release;
        return run_program(static_cast<int>(words.size()), pointers.data());
    });
}

} // namespace pertev
