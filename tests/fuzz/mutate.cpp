// Makes inputs for a fuzz target where there is no libFuzzer: `fuzz_readers TARGET [SECONDS [SEED [CORPUS]]]` first
// reads a file, or all of a folder, then changed seeds. An input that aborts is left in the working folder as
// fuzz-input-TARGET. `fuzz_readers TARGET --seeds FOLDER` writes the seeds, `fuzz_readers` lists the targets.

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <string_view>

#include "base/read_file.h"
#include "base/stopwatch.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using Bytes = std::vector<std::byte>;

Bytes g_input;
std::string g_input_file = "fuzz-input-";

extern "C" void keep_input(int number) {
    if (std::FILE* const file = std::fopen(g_input_file.c_str(), "wb")) {
        std::fwrite(g_input.data(), 1, g_input.size(), file);
        std::fclose(file);
    }
    std::signal(number, SIG_DFL);
    std::raise(number);
}

bool is_digit(std::byte b) { return b >= std::byte('0') && b <= std::byte('9'); }

/// Replaces the next number of a text from `at` on, without its sign and fraction, by one that is hardly a number.
void put_extreme(std::mt19937_64& random, Bytes& bytes, std::size_t at) {
    constexpr std::string_view kExtremes[] = {"1e300",  "-1e300", "1e39", "nan",       "1e999",
                                              "1e-300", "-1",     "0",    "2147483648"};
    const auto first = std::find_if(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end(), is_digit);
    const std::string_view text = kExtremes[random() % std::size(kExtremes)];
    const auto* const from = reinterpret_cast<const std::byte*>(text.data());
    const auto last = std::find_if_not(first, bytes.end(), is_digit);
    bytes.insert(bytes.erase(first, last), from, from + text.size());
}

/// Changes a few bytes: flipped bits, other values, digits and numbers in text, parts that are missing, twice or from
/// elsewhere.
void mutate(std::mt19937_64& random, Bytes& bytes) {
    constexpr uint8_t kValues[] = {0, 1, 0x7f, 0x80, 0xff, '0', '9', '-', '"', '[', '}', 'e'};
    for (uint64_t changes = 1 + random() % 4; changes > 0 && !bytes.empty(); --changes) {
        const std::size_t at = random() % bytes.size(), to = random() % bytes.size();
        const std::size_t length = std::min<std::size_t>(1 + random() % 40, bytes.size() - std::max(at, to));
        const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        switch (random() % 7) {
        case 0:
            bytes[at] ^= std::byte(1u << random() % 8);
            break;
        case 1:
            bytes[at] = std::byte(kValues[random() % std::size(kValues)]);
            break;
        case 2:
            for (std::size_t i = at; i < std::min(at + 200, bytes.size()); ++i) {
                if (bytes[i] < std::byte('0') || bytes[i] > std::byte('9')) continue;
                bytes[i] = std::byte('0' + random() % 10);
                break;
            }
            break;
        case 6:
            put_extreme(random, bytes, at);
            break;
        case 3:
            bytes.erase(first, first + static_cast<std::ptrdiff_t>(length));
            break;
        case 4: {
            const Bytes copy(first, first + static_cast<std::ptrdiff_t>(length));
            bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(to), copy.begin(), copy.end());
            break;
        }
        default:
            std::copy_n(Bytes(first, first + static_cast<std::ptrdiff_t>(length)).begin(), length,
                        bytes.begin() + static_cast<std::ptrdiff_t>(to));
        }
    }
}

} // namespace

namespace {

const pertev::FuzzTarget* find_target(std::string_view name) {
    for (const pertev::FuzzTarget& target : pertev::fuzz_targets()) {
        if (name == target.name) return &target;
    }
    for (const pertev::FuzzTarget& target : pertev::fuzz_targets()) std::printf("%s\n", target.name);
    return nullptr;
}

/// Reads every file of a folder, or the one file.
uint64_t replay(const pertev::FuzzTarget& target, const std::filesystem::path& corpus) {
    if (!std::filesystem::exists(corpus)) return 0;
    if (!std::filesystem::is_directory(corpus)) {
        g_input = pertev::read_file(corpus);
        std::printf("%s\n", target.read(g_input) ? "read" : "refused");
        return 1;
    }
    uint64_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
        g_input = pertev::read_file(entry.path());
        target.read(g_input);
        ++count;
    }
    return count;
}

/// Writes the seeds of a target into a folder.
int write_seeds(const pertev::FuzzTarget& target, const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    for (uint32_t kind = 0; kind < target.kinds; ++kind) {
        const Bytes seed = target.seed(kind);
        const auto path = folder / ("seed-" + std::to_string(kind));
        std::FILE* const file = std::fopen(path.c_str(), "wb");
        if (file == nullptr || std::fwrite(seed.data(), 1, seed.size(), file) != seed.size()) return 1;
        std::fclose(file);
    }
    return 0;
}

} // namespace

int main(int count, char** arguments) {
    const pertev::FuzzTarget* const target = find_target(count > 1 ? arguments[1] : "");
    if (target == nullptr) return count > 1 ? 2 : 0;
    g_input_file += target->name;
    for (const int number : {SIGABRT, SIGSEGV}) std::signal(number, &keep_input);
    if (count == 4 && std::string_view(arguments[2]) == "--seeds") return write_seeds(*target, arguments[3]);
    const uint64_t replayed = count > 4 ? replay(*target, arguments[4]) : 0;
    const double seconds = count > 2 ? std::atof(arguments[2]) : 2;
    std::mt19937_64 random(count > 3 ? std::strtoull(arguments[3], nullptr, 10) : 1);
    const pertev::Stopwatch watch;
    uint64_t runs = 0, read = 0;
    const uint64_t least = seconds > 0 ? uint64_t(4) * target->kinds : 0; // on a slow machine too
    for (; watch.seconds() < seconds || runs < least; ++runs) {
        g_input = target->seed(static_cast<uint32_t>(runs % target->kinds));
        if (runs >= target->kinds) mutate(random, g_input);
        const bool is_read = target->read(g_input);
        read += is_read ? 1 : 0;
        if (runs < target->kinds && !is_read) {
            std::fprintf(stderr, "seed %llu is refused\n", static_cast<unsigned long long>(runs));
            return 1;
        }
    }
    std::printf("%s: %llu inputs of the corpus, %llu others, of which %llu were read\n", target->name,
                static_cast<unsigned long long>(replayed), static_cast<unsigned long long>(runs),
                static_cast<unsigned long long>(read));
    return seconds == 0 || (read > target->kinds && read < runs) ? 0 : 1; // else nothing behind checksums was reached
}
