#pragma once

// The header of a film file (docs/film_file.md): all that is known of a film besides its targets. Its JSON is read
// strictly; whatever is missing or out of its limits is an Error with the place.

#include <string>

#include "formats/json/json_value.h"
#include "session/film_file/block_file.h"
#include "session/writing/deciding_settings.h"

namespace pertev {

inline constexpr std::string_view kFilmFileMagic = "\x89PVF\r\n\x1a\n";      // text converters and 7 bits damage it
inline constexpr uint32_t kFilmFileVersion = 2, kFilmFileOfPartsVersion = 3; // with one part, and with several
inline constexpr BlockFileKind kFilmFile = {kFilmFileMagic, kFilmFileOfPartsVersion, "film", kFilmFileVersion};

struct FilmHeader {
    DecidingSettings settings; // without the number of samples, and without the name of the scene
    uint32_t width = 0, height = 0;
    uint32_t aovs = 0;          // AovBits
    uint32_t sample_layers = 0; // SampleLayerBits
    std::vector<std::string> light_layers;
    LayersAt layers_at = LayersAt::Samples;
    Denoise denoise = Denoise::None;
    std::vector<FilmPart> parts = {FilmPart()}; // one, which may be empty, or several, as of RowSamples
    uint32_t spp = 0;                           // samples of the whole picture
    PictureFacts facts;
    RayCounts rays;            // the rays that the part took
    double render_seconds = 0; // time that the part took

    bool is_denoised() const { return denoise != Denoise::None; }
    /// Returns the only part. Throws std::logic_error if there are several.
    const FilmPart& part() const {
        PERTEV_CHECK(parts.size() == 1);
        return parts.front();
    }
    /// Makes an empty film with all targets of the file.
    Film make_film(Queue& queue) const;
};

/// Makes the header of a film that was rendered by these options.
FilmHeader film_header(const PictureOptions& options, const PictureRecord& record, const PictureFacts& facts,
                       const RenderStats& stats, const Film& film);

/// Returns the first difference of films that are not of one picture, or nothing.
std::optional<SettingDifference> film_difference(const FilmHeader& before, const FilmHeader& after);

std::string json_of(const FilmHeader& header);
/// Reads the header of a film file. Throws Error(BadInput, OverLimit).
FilmHeader read_film_header(const gltf::JsonValue& root);

} // namespace pertev
