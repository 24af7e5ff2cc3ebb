#pragma once

// The three kinds of error. A programmer's mistake: CHECK. Bad input or a bad world: throw Error; the message names
// file, line or JSON pointer, key and what would be right. Expected absence: std::optional. Libraries never exit or
// print; the command line turns codes into exit statuses.

#include <stdexcept>
#include <string>

namespace pertev {

enum class ErrorCode {
    BadInput = 2,     // the file, flag or value is wrong; the message names where
    OverLimit = 3,    // valid, but larger than a limit in base/limits.h
    OutOfMemory = 4,  // host or device; the message lists the largest buffers and what would fit
    DeviceFault = 5,  // the GPU failed; the context is dead, the last checkpoint is good
    FileWrite = 6,    // nothing was replaced
    Interrupted = 75, // what has been rendered is written
};

/// The exit status of a code is its value.
constexpr int exit_status(ErrorCode code) { return static_cast<int>(code); }

class Error : public std::runtime_error {
public:
    Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ErrorCode code() const noexcept { return code_; }

private:
    ErrorCode code_;
};

/// Throws std::logic_error that names the place: a programmer's mistake, never bad input.
[[noreturn]] void check_failed(const char* condition, const char* file, int line);

} // namespace pertev

#define PERTEV_CHECK(condition)                                                                                        \
    do {                                                                                                               \
        if (!(condition)) ::pertev::check_failed(#condition, __FILE__, __LINE__);                                      \
    } while (false)
