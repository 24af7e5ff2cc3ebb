// The command line: pertev VERB ... Each verb is one file. Errors become one line on stderr and an exit status here.

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <string>
#include <vector>

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

/// A reader that goes away or a file that grows over its limit is a write that fails, never the end of a render.
void turn_signals_into_errors() {
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
}

/// One line to stderr, or nothing where that is full or gone.
int fail(ErrorCode code, const std::string& message) {
    std::fputs(fmt::format("pertev: {}\n", message).c_str(), stderr);
    return exit_status(code);
}

/// The line names none of the verbs there are.
std::string describe_missing_verb(const CLI::App& app) {
    std::vector<std::string> verbs;
    for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
        verbs.push_back(verb->get_name());
    }
    const std::vector<std::string> strange = app.remaining();
    return fmt::format("{}a verb is required: {}", strange.empty() ? "" : strange.front() + " is not understood; ",
                       fmt::join(verbs, ", "));
}

/// Says which flag is given more often than it is taken; nothing where none is.
std::string describe_repetition(const CLI::App& verb) {
    for (const CLI::Option* flag : verb.get_options()) {
        const int most = std::max(flag->get_items_expected_max(), 1);
        if (flag->get_multi_option_policy() == CLI::MultiOptionPolicy::Throw && int(flag->count()) > most) {
            return fmt::format("{}: given {} times, taken once", flag->get_name(), flag->count());
        }
    }
    return "";
}

std::string describe(const CLI::App* app, const CLI::Error& error) {
    std::string path = app->get_name(), what = error.what();
    const CLI::App* verb = app;
    while (!verb->get_subcommands().empty()) {
        verb = verb->get_subcommands().front();
        path += ' ' + verb->get_name();
    }
    if (verb == app) what = describe_missing_verb(*app);
    if (const std::string repeated = describe_repetition(*verb); !repeated.empty()) what = repeated;
    return fmt::format("pertev: {}\n({} --help lists what there is)\n", what, path);
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
    turn_signals_into_errors();
    const int status = run(argc, argv);
    std::cout.flush(); // CLI11 writes help and version there
    if (!std::cout || std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
        return std::max(status, fail(ErrorCode::FileWrite, "cannot write to the standard output"));
    }
    return status;
}
