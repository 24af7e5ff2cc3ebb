// Memory limits of a container or a service, read from files in Linux's layout.

#include <doctest/doctest.h>

#include <cstdint>
#include <fstream>

#include "base/machine_memory.h"
#include "tests/support/options.h"

using namespace pertev;

namespace {

/// Contents of /proc/self/cgroup and of the mounted groups.
struct Groups {
    std::filesystem::path folder = test::scratch_folder();

    void write(const std::filesystem::path& file, const char* text) const {
        std::filesystem::create_directories((folder / file).parent_path());
        std::ofstream(folder / file) << text;
    }
    std::size_t limit() const { return group_memory_bytes(folder / "self", folder / "mounted"); }
};

} // namespace

TEST_CASE("memory is limited by the tightest of the control groups that a process is in") {
    const Groups none;
    CHECK(none.limit() == SIZE_MAX);
    none.write("self", "no group\n0::/\n");
    none.write("mounted/memory.max", "max\n");
    CHECK(none.limit() == SIZE_MAX);

    const Groups second; // version
    second.write("self", "0::/user.slice/session.scope\n");
    second.write("mounted/user.slice/session.scope/memory.max", "max\n");
    CHECK(second.limit() == SIZE_MAX);
    second.write("mounted/user.slice/memory.max", "3000000000\n");
    CHECK(second.limit() == 3000000000u);
    second.write("mounted/user.slice/session.scope/memory.max", "1000000000\n");
    CHECK(second.limit() == 1000000000u);
    second.write("mounted/elsewhere/memory.max", "5\n");
    CHECK(second.limit() == 1000000000u);

    const Groups first;
    first.write("self", "5:cpu,cpuacct:/a\n4:memory:/a/b\n1:name=systemd:/a\n");
    first.write("mounted/memory/a/b/memory.limit_in_bytes", "9223372036854771712\n"); // how that version writes "none"
    CHECK(first.limit() > (std::size_t(1) << 62));
    first.write("mounted/memory/a/memory.limit_in_bytes", "2000000000\n");
    CHECK(first.limit() == 2000000000u);
}

TEST_CASE("a container that does not see its group's name is limited by its visible root") {
    const Groups container;
    container.write("self", "0::/docker/0123456789\n");
    container.write("mounted/memory.max", "536870912\n");
    CHECK(container.limit() == 536870912u);
}

TEST_CASE("the memory of this machine is positive") {
    CHECK(machine_memory_bytes() > 1u << 20);
    CHECK(machine_memory_bytes() < SIZE_MAX);
}
