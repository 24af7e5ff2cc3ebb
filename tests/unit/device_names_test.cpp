// Names of devices: which devices they are, and what is refused.

#include "session/devices/device_names.h"

#include <doctest/doctest.h>

#include "session/mpi/ranks.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

const std::vector<std::string> kUuids = {"GPU-8c4d7a52-0000-1111-2222-333344445555",
                                         "GPU-8c4d9999-0000-1111-2222-333344445555",
                                         "GPU-11112222-0000-1111-2222-333344445555"};

using DeviceList = std::vector<NamedDevice>;
constexpr NamedDevice kCpu = {};
constexpr NamedDevice gpu_number(int index) { return {true, index}; }

std::optional<Error> refusal_of_name(const std::string& text, const std::vector<std::string>& uuids = kUuids) {
    return test::thrown_error([&] { parse_devices(text, uuids); });
}

} // namespace

TEST_CASE("devices are named by number, by all, by UUID or the start of it, and several with commas") {
    CHECK(parse_devices("cpu", {}) == DeviceList{kCpu});
    CHECK(parse_devices("cuda", {}) == DeviceList{gpu_number(0)});
    CHECK(parse_devices("cuda:7", {}) == DeviceList{gpu_number(7)});
    CHECK(parse_devices("cuda:0,2", kUuids) == DeviceList{gpu_number(0), gpu_number(2)});
    CHECK(parse_devices("cuda:2,0,cuda:1", kUuids) == DeviceList{gpu_number(2), gpu_number(0), gpu_number(1)});
    CHECK(parse_devices("cuda,1", kUuids) == DeviceList{gpu_number(0), gpu_number(1)});
    CHECK(parse_devices("cuda:all", kUuids) == DeviceList{gpu_number(0), gpu_number(1), gpu_number(2)});
    CHECK(parse_devices(kUuids[1], kUuids) == DeviceList{gpu_number(1)});
    CHECK(parse_devices("GPU-8C4D7", kUuids) == DeviceList{gpu_number(0)});
    CHECK(parse_devices("gpu-1111,cuda:0", kUuids) == DeviceList{gpu_number(2), gpu_number(0)});
    CHECK(parse_devices("cpu,cpu,cpu", {}) == DeviceList{kCpu, kCpu, kCpu});
    CHECK(parse_devices("cuda:1,cpu", kUuids) == DeviceList{gpu_number(1), kCpu});
}

TEST_CASE("a text that names no device, or one device twice, is refused as a whole") {
    for (const char* text : {"",
                             "gpu",
                             "cuda:",
                             "cuda:x",
                             "cuda:-1",
                             "cuda:1x",
                             "0",
                             "cpu,0",
                             "cuda:0,",
                             ",cuda:0",
                             "cuda:0,,1",
                             "auto,cpu",
                             "cuda:0 ,1",
                             "cuda:all,1",
                             "cuda:0,0",
                             "cuda:all,cuda:1",
                             "cuda:0,GPU-8c4d7a52",
                             "cuda:3",
                             "cuda:0,3",
                             "GPU-8c4d",
                             "GPU-8c4",
                             "GPU-",
                             "GPU-ffff",
                             "cuda:99999999999"}) {
        CAPTURE(text);
        CHECK(test::is_about(refusal_of_name(text), ErrorCode::BadInput, "device", text));
    }
    CHECK(test::says(refusal_of_name("GPU-ffff"), kUuids[2]));
    CHECK(test::says(refusal_of_name("cuda:3"), kUuids[0]));
    CHECK(test::is_about(refusal_of_name("cuda:all", {}), ErrorCode::BadInput, "device", "cuda:all"));
    CHECK(test::is_about(refusal_of_name("GPU-8c4d7a52", {}), ErrorCode::BadInput, "device"));
}

TEST_CASE("texts that may name several devices are known without a list of devices") {
    for (const char* text : {"cpu,cpu", "cuda:all", "cuda:0,1"}) CHECK(names_several_devices(text));
    for (const char* text : {"auto", "cpu", "cuda", "cuda:1", "GPU-8c4d7a52"}) CHECK(!names_several_devices(text));
    for (const char* text : {"cuda:all", "GPU-8c4d7a52", "cpu,cuda:all", "cuda:0,gpu-11"})
        CHECK(needs_list_of_devices(text));
    for (const char* text : {"auto", "cpu,cpu", "cuda:0,1"}) CHECK(!needs_list_of_devices(text));
    CHECK_NOTHROW(refuse_several_devices("cuda:1", "`frames`"));
    CHECK(test::is_about(test::thrown_error([] { refuse_several_devices("cuda:all", "`frames`"); }),
                         ErrorCode::BadInput, "device", "cuda:all"));
}

TEST_CASE("devices of one kind are counted in a text") {
    CHECK(text_of_devices(std::vector<std::string>{"CPU"}) == "CPU");
    CHECK(text_of_devices(std::vector<std::string>{"A", "B", "A"}) == "2 x A + B");
}

TEST_CASE("ranks of a machine take its GPUs in turn") {
    CHECK(gpu_of_rank(0, 2) == "cuda:0");
    CHECK(gpu_of_rank(1, 2) == "cuda:1");
    CHECK(gpu_of_rank(4, 3) == "cuda:1"); // more ranks than GPUs
    CHECK(gpu_of_rank(3, 1).empty());
    CHECK(gpu_of_rank(0, 0).empty());
}
