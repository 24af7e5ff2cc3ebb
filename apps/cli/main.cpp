// The command line: pertev VERB ... Each verb is one file. Errors become one line on stderr and an exit status here.

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/commands.h"
#include "base/error.h"
#include "base/version.h"

namespace pertev {
namespace {

/// A closed stdin, stdout or stderr gets /dev/null: else the first file opened would take its number, and with it what
/// is meant for the terminal.
void open_standard_files() {
    for (int fd = 0; fd <= STDERR_FILENO; ++fd) {
        if (::fcntl(fd, F_GETFD) < 0 && ::open("/dev/null", O_RDWR) < 0) std::_Exit(exit_status(ErrorCode::FileWrite));
    }
}

/// One line to stderr, or nothing where that is full or gone.
int fail(ErrorCode code, const std::string& message) {
    std::fputs(fmt::format("pertev: {}\n", message).c_str(), stderr);
    return exit_status(code);
}

std::string describe(const CLI::App* app, const CLI::Error& error) {
    std::string verb = app->get_name(), what = error.what();
    for (const CLI::App* sub : app->get_subcommands()) verb += ' ' + sub->get_name();
    if (what.starts_with("A subcommand")) what = "a verb is required: render, compare, info, bench or lab";
    return fmt::format("pertev: {}\n({} --help lists what there is)\n", what, verb);
}

/// Parses the command line, which runs its verb.
int run(int argc, char** argv) {
    CLI::App app("Pertev: a path tracer for GPUs without ray-tracing hardware, and for CPUs.", "pertev");
    app.set_version_flag("--version", fmt::format("pertev {} ({})", version(), git_commit()));
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);
    app.failure_message(describe);
    int status = 0;
    add_render_command(app, status);
    add_compare_command(app, status);
    add_info_command(app, status);
    add_bench_command(app, status);
    add_lab_command(app, status);
    try {
        app.parse(argc, argv);
        return status;
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : exit_status(ErrorCode::BadInput);
    } catch (const Error& error) {
        return fail(error.code(), error.what());
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::OutOfMemory, "out of memory on this machine");
    } catch (const std::filesystem::filesystem_error& error) {
        return fail(ErrorCode::BadInput, fmt::format("{}: {}", error.path1().string(), error.code().message()));
    } catch (const std::exception& error) {
        return fail(ErrorCode::DeviceFault,
                    fmt::format("a mistake of pertev's own, please report it: {}", error.what()));
    }
}

} // namespace
} // namespace pertev

int main(int argc, char** argv) {
    using namespace pertev;
    __builtin_cpu_init();
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") || !__builtin_cpu_supports("bmi2")) {
        std::fputs("pertev: this processor lacks AVX2, FMA or BMI2 (x86-64-v3, 2013 and later), which pertev needs\n",
                   stderr);
        return 2;
    }
    open_standard_files();
    const int status = run(argc, argv);
    std::cout.flush(); // CLI11 writes help and version there
    if (!std::cout || std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
        return std::max(status, fail(ErrorCode::FileWrite, "cannot write to the standard output"));
    }
    return status;
}
