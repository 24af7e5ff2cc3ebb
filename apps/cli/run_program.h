#pragma once

// The command line: pertev VERB ... Each verb is one file. The program calls it, and so does the Python package, whose
// module holds the program, so that a wheel has all kernels once.

namespace pertev {

/// Runs the program with its words, argv[0] first, and returns its exit status. Errors become a line or, with --json,
/// an object. Signals are the program's from then on (interrupt.h), so a process calls it once.
int run_program(int argc, char** argv);

} // namespace pertev
