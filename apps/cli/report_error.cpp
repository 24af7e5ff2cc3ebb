#include "apps/cli/report_error.h"

#include <cstdio>

#include <fmt/format.h>

#include "apps/cli/flag_phrases.h"
#include "base/json_text.h"
#include "base/value_names.h"

namespace pertev {

constexpr ValueName<ErrorCode> kCodeNames[] = {
    {ErrorCode::BadInput, "bad_input"},        {ErrorCode::OverLimit, "over_limit"},
    {ErrorCode::OutOfMemory, "out_of_memory"}, {ErrorCode::DeviceFault, "device_fault"},
    {ErrorCode::FileWrite, "file_write"},      {ErrorCode::Interrupted, "interrupted"}};
constexpr const auto& names_of_all(ErrorCode) { return kCodeNames; }

namespace {

/// False where the stream is full or gone.
bool write(std::FILE* file, const std::string& text) {
    return std::fwrite(text.data(), 1, text.size(), file) == text.size() && std::fflush(file) == 0;
}

} // namespace

std::string error_object(ErrorCode code, const Remark& remark, const std::string& help) {
    return fmt::format(R"({{"event":"error","code":"{}","status":{},"interrupted":{},"text":{}{}{}}})", name_of(code),
                       exit_status(code), code == ErrorCode::Interrupted, json_string(phrase(remark)),
                       json_parts(remark), help.empty() ? "" : fmt::format(R"(,"help":{})", json_string(help)));
}

int report_error(bool json, ErrorCode code, const Remark& remark, const std::string& help) {
    if (!json || !write(stdout, error_object(code, remark, help) + '\n')) {
        write(stderr,
              fmt::format("pertev: {}\n{}", phrase(remark), help.empty() ? "" : fmt::format("(see {})\n", help)));
    }
    return exit_status(code);
}

} // namespace pertev
