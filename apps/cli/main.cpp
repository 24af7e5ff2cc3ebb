// The program `pertev`.

#include <cstdio>

#include "apps/cli/commands.h"

int main(int argc, char** argv) {
    __builtin_cpu_init();
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") || !__builtin_cpu_supports("bmi2")) {
        std::fputs("pertev: this processor lacks AVX2, FMA or BMI2 (x86-64-v3, 2013 and later), which pertev needs\n",
                   stderr);
        return 2;
    }
    return pertev::run_program(argc, argv);
}
