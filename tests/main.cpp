#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "tests/support/parse_options.h"

int main(int argc, char** argv) {
    pertev::test::parse_options(argc, argv);
    doctest::Context context(argc, argv);
    return context.run();
}
