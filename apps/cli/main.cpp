// The command line: pertev VERB ... Each verb is one file. Errors become one line on stderr and an exit status here.

#include "apps/cli/commands.h"

#include <cstdio>
#include <exception>
#include <new>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "base/error.h"
#include "base/version.h"

int main(int argc, char** argv) {
    using namespace pertev;
    __builtin_cpu_init();
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") || !__builtin_cpu_supports("bmi2")) {
        std::fputs("pertev: this processor lacks AVX2, FMA or BMI2 (x86-64-v3, 2013 and later), which pertev needs\n",
                   stderr);
        return 2;
    }
    CLI::App app("Pertev: a path tracer for GPUs without ray-tracing hardware, and for CPUs.", "pertev");
    app.set_version_flag("--version", fmt::format("pertev {} ({})", version(), git_commit()));
    app.require_subcommand(1);
    app.get_formatter()->column_width(38);
    int status = 0;
    add_render_command(app, status);
    add_compare_command(app, status);
    add_info_command(app, status);
    add_bench_command(app, status);
    const auto fail = [](ErrorCode code, const std::string& message) {
        fmt::print(stderr, "pertev: {}\n", message);
        return exit_status(code);
    };
    try {
        app.parse(argc, argv);
        return status;
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : exit_status(ErrorCode::BadInput);
    } catch (const Error& error) {
        return fail(error.code(), error.what());
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::OutOfMemory, "out of memory on this machine");
    } catch (const std::exception& error) {
        return fail(ErrorCode::DeviceFault, fmt::format("a mistake of pertev's own, please report it: {}", error.what()));
    }
}
