#pragma once

// One function per verb: adds the verb to the command line. A verb runs while the line is parsed. `status` becomes
// the process's exit status.

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
void add_bench_command(CLI::App& app, int& status);
void add_lab_command(CLI::App& app, int& status);

/// Lists the devices of --device, one per line, with distinguishing properties; the CPU comes last.
std::string list_devices();

} // namespace pertev
