#include "apps/cli/interrupt.h"

#include <csignal>

#include "base/error.h"

namespace pertev {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;

extern "C" void handle_interrupt(int) {
    g_interrupted = 1;
    std::signal(SIGINT, SIG_DFL); // a second one of either kind ends the process
    std::signal(SIGTERM, SIG_DFL);
}

} // namespace

void listen_for_interrupt() {
    std::signal(SIGINT, handle_interrupt);
    std::signal(SIGTERM, handle_interrupt);
}

bool interrupted() { return g_interrupted != 0; }

void throw_if_interrupted() {
    if (interrupted()) throw Error(ErrorCode::Interrupted, "interrupted");
}

} // namespace pertev
