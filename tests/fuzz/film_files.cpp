// Fuzz target of film files (docs/film_file.md). An input is taken for a film file whose checksums are made right. It
// is refused by an Error, or it is a film, which keeps its bytes in a file.

#include "base/error.h"
#include "session/film_file/merge_films.h"
#include "tests/fuzz/block_files.h"
#include "tests/fuzz/fuzz_target.h"

namespace pertev {
namespace {

constexpr std::size_t kMostFilmBytes = std::size_t(64) << 20;

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

} // namespace

Bytes film_seed(uint32_t number) {
    FilmHeader header;
    header.settings = {{"size", "9x5"}, {"seed", "0"}};
    header.width = 9, header.height = 5 + number % 3;
    header.aovs = number % 2 == 0 ? 0 : kAovNormal | kAovIds;
    header.layers_at = number % 4 == 3 ? LayersAt::Centre : LayersAt::Samples;
    if (number % 5 == 4) header.denoise = Denoise::Svgf;
    header.parts = {{0, header.height, {0, 4}}}, header.spp = 4;
    if (number % 3 == 1) header.parts = {{0, 2, {0, 4}}, {2, 4, {0, 1}}, {2, 4, {2, 3}}}; // the last rows have none
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

bool read_film_input(std::span<const std::byte> input) {
    Bytes bytes(input.begin(), input.end());
    repair(kFilmFile, bytes);
    const auto film = read_film(bytes);
    if (!film) return false;
    const Bytes again = film_file_bytes(film->first, film->second);
    const auto same = read_film(again);
    require(same.has_value());
    require(film_file_bytes(same->first, same->second) == again);
    return true;
}

} // namespace pertev
