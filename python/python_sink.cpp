#include "python/python_sink.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <fmt/format.h>

#include "base/phrase_settings.h"
#include "settings/setting_table.h"

namespace nb = nanobind;

namespace pertev {

bool PythonSink::should_stop() {
    if (has_raised_) return true;
    if (!is_main_ || std::this_thread::get_id() != caller_) return false;
    const Clock::time_point now = Clock::now();
    if (now - asked_ < std::chrono::milliseconds(20)) return false;
    asked_ = now;
    const nb::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) has_raised_ = true;
    return has_raised_;
}

void log_messages(const Messages& messages) {
    if (messages.all().empty()) return;
    const nb::object logger = nb::module_::import_("logging").attr("getLogger")("pertev");
    for (const Message& message : messages.all()) {
        logger.attr(message.is_warning ? "warning" : "info")("%s", python_text(message.remark.text()));
    }
}

std::string python_text(const std::string& marked) {
    return phrase_settings(marked, [](std::string_view name, std::string_view value) {
        if (value.empty()) return std::string(name);
        const Setting* setting = find_setting(name);
        if (setting != nullptr && is_vector(*setting)) return fmt::format("{}=({})", name, value);
        const bool is_number = value.find_first_not_of("0123456789.+-e") == std::string_view::npos;
        return is_number ? fmt::format("{}={}", name, value) : fmt::format("{}='{}'", name, value);
    });
}

} // namespace pertev
