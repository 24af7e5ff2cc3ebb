// Makes inputs for a fuzz target where there is no libFuzzer: `fuzz_film_files [SECONDS [SEED]]`. An input that aborts
// is left in the working folder as fuzz-input.pvf. With the name of a file in place of seconds it runs that input
// alone.

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string_view>

#include "base/read_file.h"
#include "base/stopwatch.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using Bytes = std::vector<std::byte>;

Bytes g_input;

extern "C" void keep_input(int number) {
    if (std::FILE* const file = std::fopen("fuzz-input.pvf", "wb")) {
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

int main(int count, char** arguments) {
    if (count == 2 && std::filesystem::exists(arguments[1])) {
        bool is_read = false;
        pertev::fuzz_input(pertev::read_file(arguments[1]), is_read);
        std::printf("%s\n", is_read ? "read" : "refused");
        return 0;
    }
    const double seconds = count > 1 ? std::atof(arguments[1]) : 2;
    std::mt19937_64 random(count > 2 ? std::strtoull(arguments[2], nullptr, 10) : 1);
    for (const int number : {SIGABRT, SIGSEGV}) std::signal(number, &keep_input);
    constexpr uint32_t kSeeds = 12;
    const pertev::Stopwatch watch;
    uint64_t runs = 0, read = 0;
    for (; watch.seconds() < seconds; ++runs) {
        g_input = pertev::fuzz_seed(static_cast<uint32_t>(runs % kSeeds));
        if (runs >= kSeeds) mutate(random, g_input);
        bool is_read = false;
        pertev::fuzz_input(g_input, is_read);
        read += is_read ? 1 : 0;
        if (runs < kSeeds && !is_read) {
            std::fprintf(stderr, "seed %llu is refused\n", static_cast<unsigned long long>(runs));
            return 1;
        }
    }
    std::printf("%llu inputs, of which %llu were read\n", static_cast<unsigned long long>(runs),
                static_cast<unsigned long long>(read));
    return read > kSeeds && read < runs ? 0 : 1; // else nothing behind the checksums was reached
}
