// The Python module `pertev._core`: the table of settings, rendering, errors. The package around it
// (python/pertev/__init__.py) makes texts of Python's values.

#include <map>

#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "base/error.h"
#include "formats/builtin_scenes.h"
#include "image/picture_hash.h"
#include "python/python_sink.h"
#include "python/result.h"
#include "session/pictures/choose_display.h"
#include "session/pictures/prepare_render.h"
#include "session/session.h"
#include "session/writing/check_outputs.h"
#include "session/writing/write_picture.h"
#include "settings/setting_table.h"
#include "settings/settings_file.h"

namespace nb = nanobind;

namespace pertev {
namespace {

using SettingTexts = std::map<std::string, std::vector<std::string>>;

/// Returns a row of the table as Python needs it.
nb::dict row_of(const Setting& setting) {
    nb::dict row;
    row["name"] = setting.name;
    row["group"] = setting.group;
    row["form"] = setting.form;
    row["sentence"] = setting.sentence;
    row["unit"] = setting.unit;
    row["choices"] = choices_of(setting);
    row["is_switch"] = is_switch(setting);
    row["is_list"] = is_list(setting);
    row["is_vector"] = is_vector(setting);
    row["default"] = texts_of(PictureOptions(), setting);
    return row;
}

std::vector<nb::dict> render_settings_table() {
    std::vector<nb::dict> rows;
    for (const Setting& setting : all_settings()) {
        if ((setting.verbs & kRender) != 0) rows.push_back(row_of(setting));
    }
    return rows;
}

PictureOptions options_of(const std::string& scene, const std::string& settings_file, const SettingTexts& settings,
                          Messages& messages) {
    PictureOptions options;
    options.scene.scene = scene;
    combine_settings(
        settings_file, kRender,
        [&](PictureOptions& all) {
            for (const auto& [name, texts] : settings) {
                const Setting* setting = find_setting(name);
                if (setting == nullptr) throw Error(ErrorCode::BadInput, name, "", "no setting");
                set_value(all, *setting, texts);
            }
        },
        options, messages);
    return options;
}

PythonResult render_options(PictureOptions options, const std::vector<std::string>& outputs, PythonSink& sink) {
    if (!outputs.empty()) check_outputs(options, outputs, sink.messages());
    const std::unique_ptr<RenderSetup> ready = prepare_render(options, kRender, sink);
    report_motion(options, *ready->moving, sink.messages());
    if (frame_range(options)) {
        throw Error(ErrorCode::BadInput, "frames", options.frames, "a call renders one picture; `time` chooses it");
    }
    PictureRecord record = picture_record(options, *ready, sink.messages());
    Session session(*ready->queue, ready->prepared(), record.camera.camera, ready->settings);
    if (writes_tone_mapped(outputs)) record.display = choose_display(options, session, sink);
    if (session.render(ready->settings.samples, sink) < ready->settings.samples && sink.has_raised()) {
        throw Error(ErrorCode::Interrupted, "interrupted");
    }
    PythonResult made = {.result = session.result(), .metadata = {}, .hash = ""};
    made.hash = picture_hash(made.result.picture).hex();
    made.metadata = picture_metadata(record, made.result, made.hash);
    if (made.result.samples == 0) {
        throw Error(ErrorCode::Interrupted, "time_limit", "", "no sample was finished in this time");
    }
    if (!outputs.empty()) {
        RenderResult written = made.result; // files take the layers out of it
        const std::string failures = failures_of(write_picture(outputs, record, written));
        if (!failures.empty()) throw Error(ErrorCode::FileWrite, failures);
    }
    return made;
}

PythonResult render(const std::string& scene, const std::string& settings_file, const SettingTexts& settings,
                    const std::vector<std::string>& outputs) {
    PythonSink sink;
    std::optional<PythonResult> made;
    std::exception_ptr failure;
    {
        const nb::gil_scoped_release unlocked;
        try {
            made = render_options(options_of(scene, settings_file, settings, sink.messages()), outputs, sink);
        } catch (...) {
            failure = std::current_exception();
        }
    }
    if (sink.has_raised()) throw nb::python_error(); // what the signal's handler raised
    log_messages(sink.messages());
    if (failure) std::rethrow_exception(failure);
    return std::move(*made);
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
    define_result(module);
    module.def("settings", &render_settings_table, "The rows of the table of settings that a render has");
    module.def("builtin_scenes", &builtin_scene_names, "Names of the scenes that are part of Pertev");
    module.def("render", &render);
}

} // namespace pertev
