// The Python module `pertev._core`: the table of settings, rendering, errors. The package around it
// (python/pertev/__init__.py) makes texts of Python's values.

#include <algorithm>
#include <optional>
#include <set>
#include <type_traits>

#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "base/error.h"
#include "base/parallel_for.h"
#include "formats/builtin_scenes.h"
#include "python/python_sink.h"
#include "python/result.h"
#include "python/scene.h"
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
    row["group"] = setting.group;
    row["form"] = setting.form;
    row["sentence"] = setting.sentence;
    row["unit"] = setting.unit;
    row["choices"] = choices_of(setting);
    row["type"] = type_of(setting);
    row["default"] = texts_of(PictureOptions(), setting);
    return row;
}

/// Returns the settings of a single picture: not `frames` and `turntable`, nor what needs these.
std::vector<nb::dict> settings_of_pictures() {
    std::vector<nb::dict> rows;
    std::set<std::string, std::less<>> of_sequences = {"frames", "turntable", "cameras"};
    for (const Setting& setting : all_settings()) {
        const std::vector<std::string> needs = words_of(setting.needs);
        const auto is_of_sequences = [&](const std::string& name) { return of_sequences.contains(name); };
        if (!needs.empty() && std::ranges::all_of(needs, is_of_sequences)) of_sequences.insert(setting.name);
        if ((setting.verbs & kRender) != 0 && !is_of_sequences(setting.name)) rows.push_back(row_of(setting));
    }
    return rows;
}

/// Calls `work` without the interpreter's lock, and then logs its messages. Throws what it throws, or what a signal's
/// handler raised.
template <class Work>
void run_unlocked(Work work) {
    PythonSink sink;
    std::exception_ptr failure;
    {
        const nb::gil_scoped_release unlocked;
        const UseThreads own{Threads()}; // a call's number of threads is not that of the next
        try {
            work(sink);
        } catch (...) {
            failure = std::current_exception();
        }
    }
    if (sink.has_raised()) throw nb::python_error();
    try {
        log_messages(sink.messages());
    } catch (nb::python_error& raised) { // a handler of the caller's; the picture or the failure counts
        raised.discard_as_unraisable("pertev");
    }
    if (failure) std::rethrow_exception(failure);
}

PythonResult render(PythonScene& scene, const std::string& settings_file, const SettingTexts& settings,
                    const std::vector<std::string>& outputs) {
    std::optional<PythonResult> made;
    run_unlocked([&](PythonSink& sink) { made = scene.render(settings_file, settings, outputs, sink); });
    return std::move(*made);
}

void open(PythonScene& scene) {
    run_unlocked([&](PythonSink& sink) { scene.open(sink); });
}

/// Raises the package's exception for the error's code, with its parts as attributes.
void raise(const Error& error) {
    static constexpr std::pair<ErrorCode, const char*> kClasses[] = {
        {ErrorCode::BadInput, "InputError"},          {ErrorCode::OverLimit, "LimitError"},
        {ErrorCode::OutOfMemory, "MemoryLimitError"}, {ErrorCode::DeviceFault, "DeviceError"},
        {ErrorCode::FileWrite, "WriteError"},         {ErrorCode::Interrupted, "InterruptedRender"}};
    const nb::module_ errors = nb::module_::import_("pertev.errors");
    for (const auto& [code, name] : kClasses) {
        if (code != error.code()) continue;
        const nb::object kind = errors.attr(name);
        const nb::object raised = kind(python_text(error.remark()));
        raised.attr("setting") = error.setting();
        raised.attr("value") = error.value();
        raised.attr("reason") = error.reason();
        const FileLocation where = error.location().value_or(FileLocation{});
        raised.attr("file") = where.file;
        raised.attr("line") = where.line;
        raised.attr("pointer") = where.pointer.value_or("");
        PyErr_SetObject(kind.ptr(), raised.ptr());
        return;
    }
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
    define_result(module);
    module.def("settings", &settings_of_pictures, "The rows of the table of settings that a picture has");
    module.def("builtin_scenes", &builtin_scene_names, "Names of the scenes that are part of Pertev");
    nb::class_<PythonScene>(module, "Scene", nb::is_final(), "A scene that stays open; pertev.load() makes it.")
        .def(nb::init<std::string, SettingTexts>())
        .def("_open", &open)
        .def("_render", &render)
        .def_prop_ro("name", &PythonScene::name, "The file, or the name of a built-in scene")
        .def("__repr__", [](const PythonScene& scene) { return "<pertev.Scene " + scene.name() + ">"; });
}

} // namespace pertev
