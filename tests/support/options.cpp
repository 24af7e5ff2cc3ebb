#include "tests/support/options.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace pertev::test {
namespace {

bool g_cuda = false;
bool g_long = false;
bool g_scene_was_missing = false;

struct ScratchFolders {
    std::vector<std::filesystem::path> folders;
    ~ScratchFolders() {
        std::error_code ignored;
        for (const auto& folder : folders) std::filesystem::remove_all(folder, ignored);
    }
};

} // namespace

void parse_options(int argc, char** argv) {
    const char* from_environment = std::getenv("PERTEV_LONG_TESTS");
    g_long = from_environment != nullptr && std::string(from_environment) == "1";
    for (int i = 1; i < argc; ++i) {
        const std::string arg = argv[i];
        if (arg == "--long") g_long = true;
        if (arg == "--device" && i + 1 < argc) g_cuda = std::string(argv[i + 1]).starts_with("cuda");
    }
}

bool cuda_requested() { return g_cuda; }

uint64_t effort(uint64_t count, uint64_t long_count) { return g_long ? long_count : count; }

std::optional<std::filesystem::path> test_scene(const std::filesystem::path& relative) {
    const char* root = std::getenv("PERTEV_SCENES");
    if (root == nullptr || *root == '\0') {
        g_scene_was_missing = true;
        std::printf("skipped: %s is not there (set PERTEV_SCENES, see docs/scenes.md)\n", relative.c_str());
        return std::nullopt;
    }
    std::filesystem::path path = std::filesystem::path(root) / relative;
    if (!std::filesystem::exists(path)) {
        g_scene_was_missing = true;
        std::printf("skipped: %s is not there (see docs/scenes.md)\n", path.c_str());
        return std::nullopt;
    }
    return path;
}

bool scene_was_missing() { return g_scene_was_missing; }

std::filesystem::path scratch_folder() {
    static ScratchFolders scratch;
    std::string name = (std::filesystem::temp_directory_path() / "pertev-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no scratch folder could be made");
    return scratch.folders.emplace_back(name);
}

} // namespace pertev::test
