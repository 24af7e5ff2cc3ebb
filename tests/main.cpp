#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "tests/support/options.h"

namespace {

constexpr int kSkipped = 77; // CTest's SKIP_RETURN_CODE

int g_assertions = 0;

struct CountAssertions : doctest::IReporter {
    explicit CountAssertions(const doctest::ContextOptions&) {}
    void test_run_end(const doctest::TestRunStats& stats) override { g_assertions = stats.numAsserts; }
    void report_query(const doctest::QueryData&) override {}
    void test_run_start() override {}
    void test_case_start(const doctest::TestCaseData&) override {}
    void test_case_reenter(const doctest::TestCaseData&) override {}
    void test_case_end(const doctest::CurrentTestCaseStats&) override {}
    void test_case_exception(const doctest::TestCaseException&) override {}
    void subcase_start(const doctest::SubcaseSignature&) override {}
    void subcase_end() override {}
    void log_assert(const doctest::AssertData&) override {}
    void log_message(const doctest::MessageData&) override {}
    void test_case_skipped(const doctest::TestCaseData&) override {}
};

} // namespace

REGISTER_LISTENER("count", 1, CountAssertions);

int main(int argc, char** argv) {
    pertev::test::parse_options(argc, argv);
    doctest::Context context(argc, argv);
    const int status = context.run();
    // Scenes were missing and nothing was tested, which does not count as passed.
    return status == 0 && g_assertions == 0 && pertev::test::scene_was_missing() ? kSkipped : status;
}
