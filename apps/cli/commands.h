#pragma once

// The command line: pertev VERB ... One function per verb adds the verb, in a file of its own. A verb runs while the
// line is parsed. `status` becomes the process's exit status. The program runs it, and so does the Python package,
// whose module holds the program, so that a wheel has all kernels once.

#include <string>

namespace CLI {
class App;
}

namespace pertev {

void add_render_command(CLI::App& app, int& status);
void add_view_command(CLI::App& app, int& status);
void add_compare_command(CLI::App& app, int& status);
void add_merge_command(CLI::App& app, int& status);
void add_measure_command(CLI::App& app, int& status);
void add_solve_command(CLI::App& app, int& status);
void add_info_command(CLI::App& app, int& status);
void add_check_command(CLI::App& app, int& status);
void add_convert_command(CLI::App& app, int& status);
void add_bench_command(CLI::App& app, int& status);
void add_lab_command(CLI::App& app, int& status);

/// Runs the program with its words, argv[0] first, and returns its exit status. Errors become a line or, with --json,
/// an object. Signals are the program's from then on (interrupt.h), so a process calls it once, from its main thread.
int run_program(int argc, char** argv);

/// Lists the devices of --device, one per line, with distinguishing properties; the CPU comes last.
std::string list_devices();

} // namespace pertev
