#pragma once

// Error handling. A programmer's mistake: CHECK. Bad input or environment: throw Error, whose parts are the place,
// the setting with its value, and the reason, which says what would be right. Expected absence: std::optional.
// Libraries never exit or print; the command line converts codes to exit statuses.

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/remark.h"

namespace pertev {

enum class ErrorCode {
    BadInput = 2,     // a file or a setting is wrong; the parts name which
    OverLimit = 3,    // valid, but larger than a limit in base/limits.h
    OutOfMemory = 4,  // host or device; the message lists the largest buffers and what would fit
    DeviceFault = 5,  // the GPU failed; its context is dead, so that only a new process can use it
    FileWrite = 6,    // nothing was replaced
    Interrupted = 75, // samples rendered so far are written
};

/// The exit status of a code is its value.
constexpr int exit_status(ErrorCode code) { return static_cast<int>(code); }

class Error : public std::runtime_error {
public:
    Error(ErrorCode code, Remark remark)
        : std::runtime_error(remark.text()), code_(code), remark_(std::make_shared<const Remark>(std::move(remark))) {}
    Error(ErrorCode code, FileLocation location, std::string reason)
        : Error(code, Remark(std::move(location), std::move(reason))) {}
    Error(ErrorCode code, std::string setting, std::string value, std::string reason)
        : Error(code, Remark(std::move(setting), std::move(value), std::move(reason))) {}

    ErrorCode code() const noexcept { return code_; }
    const Remark& remark() const noexcept { return *remark_; }
    // The parts of the remark; what() is all of them as text.
    const std::optional<FileLocation>& location() const noexcept { return remark_->location; }
    const std::string& setting() const noexcept { return remark_->setting; }
    const std::string& value() const noexcept { return remark_->value; }
    const std::string& reason() const noexcept { return remark_->reason; }

private:
    ErrorCode code_;
    std::shared_ptr<const Remark> remark_; // shared, so that copies of an exception throw nothing
};

/// Throws std::logic_error that names the place, for a programmer's mistake, never for bad input.
[[noreturn]] void check_failed(const char* condition, const char* file, int line);

} // namespace pertev

#define PERTEV_CHECK(condition)                                                                                        \
    do {                                                                                                               \
        if (!(condition)) ::pertev::check_failed(#condition, __FILE__, __LINE__);                                      \
    } while (false)
