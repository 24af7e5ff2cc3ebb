#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "base/heartbeat.h"

using namespace pertev;
using namespace std::chrono_literals;

namespace {

/// Waits until `count` is reached, which takes long on a loaded machine.
bool reaches(const std::atomic<int>& reports, int count) {
    for (int i = 0; i < 3000 && reports < count; ++i) std::this_thread::sleep_for(10ms);
    return reports >= count;
}

} // namespace

TEST_CASE("a heartbeat repeats the work's name while it makes no progress") {
    std::atomic<int> reports = 0;
    std::vector<double> seconds;
    std::vector<std::string> works;
    {
        Heartbeat heartbeat(20ms, [&](double s, const std::string& work) {
            seconds.push_back(s);
            works.push_back(work);
            ++reports;
        });
        heartbeat.set_work("the trees");
        CHECK(reaches(reports, 3));
    }
    const std::size_t count = works.size();
    std::this_thread::sleep_for(60ms);
    REQUIRE(works.size() == count); // there are no beats after the end
    for (std::size_t i = 0; i < count; ++i) {
        CHECK(works[i] == "the trees");
        CHECK(seconds[i] >= 0.02 * static_cast<double>(i + 1));
    }
}

TEST_CASE("a heartbeat names the latest work and is silent before there is any") {
    std::atomic<int> reports = 0;
    std::string last;
    std::atomic<bool> has_work = false, was_early = false;
    {
        Heartbeat heartbeat(10ms, [&](double, const std::string& work) {
            was_early = was_early || !has_work;
            last = work;
            ++reports;
        });
        std::this_thread::sleep_for(50ms);
        has_work = true;
        heartbeat.set_work("one");
        heartbeat.set_work("two");
        CHECK(reaches(reports, 1));
    }
    CHECK(!was_early);
    CHECK(last == "two");
}

TEST_CASE("ending a heartbeat does not wait for the next beat") {
    const auto start = std::chrono::steady_clock::now();
    {
        const Heartbeat heartbeat(1h, [](double, const std::string&) {});
    }
    CHECK(std::chrono::steady_clock::now() - start < 30s);
}
