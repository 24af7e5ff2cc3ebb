// Fuzz target of film files (docs/film_file.md). An input is taken for a film file whose checksums are made right, so
// that what lies behind them is reached. It is refused by an Error, or it is a film, which keeps its bytes in a file.
// libFuzzer calls LLVMFuzzerTestOneInput; tests/fuzz/mutate.cpp stands in where there is none.

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

#include <fmt/format.h>

#include "base/error.h"
#include "session/film_file/merge_films.h"
#include "tests/fuzz/fuzz_target.h"

namespace pertev {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::size_t kHashBytes = 16, kBeforeJson = 16, kMostFilmBytes = std::size_t(64) << 20;

template <class T>
T value_at(const Bytes& bytes, std::size_t at) {
    T value;
    std::memcpy(&value, &bytes[at], sizeof value);
    return value;
}

template <class T>
void put(T value, std::size_t at, Bytes& bytes) {
    std::memcpy(&bytes[at], &value, sizeof value);
}

/// Puts the hash of the bytes [first, at) there, and adds it to those of the whole file.
void put_hash(std::size_t first, std::size_t at, Hasher& all, Bytes& bytes) {
    Hasher hasher;
    hasher.add(std::span<const std::byte>(bytes).subspan(first, at - first));
    const Hash128 hash = hasher.result();
    put(hash.low, at, bytes), put(hash.high, at + 8, bytes);
    all.add(std::span<const std::byte>(bytes).subspan(at, kHashBytes));
}

/// Corrects magic, version, sizes and checksums.
void repair(Bytes& bytes) {
    const std::size_t least = kBeforeJson + 2 * kHashBytes;
    if (bytes.size() < least) bytes.resize(least);
    std::memcpy(bytes.data(), kFilmFileMagic.data(), kFilmFileMagic.size());
    put(kFilmFileVersion, 8, bytes);
    const auto json = static_cast<uint32_t>(std::min<std::size_t>(value_at<uint32_t>(bytes, 12), bytes.size() - least));
    put(json, 12, bytes);
    Hasher all;
    std::size_t at = kBeforeJson + json;
    put_hash(0, at, all, bytes);
    at += kHashBytes;
    const std::size_t end = bytes.size() - kHashBytes, around = sizeof(uint32_t) + kHashBytes;
    while (end - at >= around) {
        const auto size =
            static_cast<uint32_t>(std::min<std::size_t>(value_at<uint32_t>(bytes, at), end - at - around));
        put(size, at, bytes);
        put_hash(at, at + sizeof(uint32_t) + size, all, bytes);
        at += around + size;
    }
    bytes.resize(at + kHashBytes);
    const Hash128 hash = all.result();
    put(hash.low, at, bytes), put(hash.high, at + 8, bytes);
}

/// A file in memory, by its name.
class FileInMemory {
public:
    explicit FileInMemory(const Bytes& bytes) : file_(::memfd_create("film", 0)) {
        if (file_ < 0 || ::write(file_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) std::abort();
    }
    ~FileInMemory() { ::close(file_); }
    FileInMemory(const FileInMemory&) = delete;
    FileInMemory& operator=(const FileInMemory&) = delete;
    std::string name() const { return fmt::format("/proc/self/fd/{}", file_); }

private:
    int file_;
};

Queue& cpu() {
    static Queue queue = Queue::make_cpu(Threads(1));
    return queue;
}

/// Reads a film; nothing if it is refused or too large for many of them.
std::optional<std::pair<FilmHeader, Film>> read_film(const Bytes& bytes) {
    const FileInMemory file(bytes);
    try {
        FilmFileReader reader(file.name());
        FilmHeader header = reader.header();
        const std::size_t size =
            Film::predicted_bytes(header.width, header.height, header.aovs, header.light_layers, header.layers_at);
        if (size > kMostFilmBytes) return std::nullopt;
        Film film = header.make_film(cpu());
        reader.add_to(film);
        const std::string names[] = {file.name()};
        FilmMerge(names, true);
        return std::pair(std::move(header), std::move(film));
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput && error.code() != ErrorCode::OverLimit) throw;
        return std::nullopt;
    }
}

void require(bool is_so) {
    if (!is_so) std::abort();
}

} // namespace

Bytes fuzz_seed(uint32_t number) {
    FilmHeader header;
    header.settings = {{"size", "9x5"}, {"seed", "0"}};
    header.width = 9, header.height = 5 + number % 3;
    header.aovs = number % 2 == 0 ? 0 : kAovNormal | kAovIds;
    header.layers_at = number % 4 == 3 ? LayersAt::Centre : LayersAt::Samples;
    if (number % 5 == 4) header.denoise = Denoise::Svgf;
    header.part = {0, header.height, {0, 4}}, header.spp = 4;
    header.facts.settings = {{"pertev.version", std::string("1")}, {"pertev.seed", 7}, {"pertev.fov_y", 0.5f}};
    header.facts.origin = {{"pertev.instances", std::string(R"({"0":"a"})")}, {"pertev.load_seconds", 0.25}};
    if (number % 2 == 0) header.facts.display = Display{ToneMap::Agx, -0.5f, FalseColors{"luminance", "nt", 2, 1, 3}};
    Film film = header.make_film(cpu());
    uint64_t state = number + 1;
    for (const auto& target : film.targets()) {
        Bytes content(target->byte_count());
        for (std::size_t i = 0; i < content.size(); ++i) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            content[i] = std::byte(i % 16 < 9 ? state >> 56 : 0); // sums have low bits and no high ones
        }
        target->add_bytes(0, content);
    }
    return film_file_bytes(header, film);
}

void fuzz_film_file(std::span<const std::byte> input, bool& is_film) {
    Bytes bytes(input.begin(), input.end());
    repair(bytes);
    const auto film = read_film(bytes);
    is_film = film.has_value();
    if (!is_film) return;
    const Bytes again = film_file_bytes(film->first, film->second);
    const auto same = read_film(again);
    require(same.has_value());
    require(film_file_bytes(same->first, same->second) == again);
}

} // namespace pertev

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
    bool is_film = false;
    pertev::fuzz_film_file({reinterpret_cast<const std::byte*>(data), size}, is_film);
    return 0;
}
