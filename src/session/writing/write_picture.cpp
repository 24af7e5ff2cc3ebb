#include "session/writing/write_picture.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/error.h"
#include "image/false_color.h"
#include "image/picture_hash.h"
#include "image/write_image.h"
#include "image/write_jpeg.h"
#include "image/write_png.h"
#include "render/sample_layers/matte_names.h"
#include "render/sample_layers/matte_target.h"
#include "session/opening/strictness.h"
#include "session/writing/check_outputs.h"

namespace pertev {
namespace {

/// Pixels of a false-colour picture for PNG and JPEG.
Rgba8Image draw(const Image& picture, const FalseColors& colors) {
    FalseColorScale scale = {colors.least, colors.most, colors.unit};
    if (!(scale.most > 0)) scale = fitting_scale(picture, colors.factor, colors.unit);
    return draw_false_colors(picture, colors.factor, scale);
}

/// Returns false if the format has no false colours.
bool write_false_colors(const std::string& path, const Image& picture, const FalseColors& colors) {
    const ImageFormat format = image_format_for(path);
    if (format == ImageFormat::Png) write_png(path, draw(picture, colors));
    if (format == ImageFormat::Jpeg) write_jpeg(path, draw(picture, colors));
    return format == ImageFormat::Png || format == ImageFormat::Jpeg;
}

/// The picture of a result that is shown: reconstructed or denoised if requested.
const Image& beauty_of(const RenderResult& result) { return result.denoised ? *result.denoised : result.picture; }

std::vector<ExrLayer> take_layers(RenderResult& result) {
    std::vector<ExrLayer> layers;
    if (result.denoised) {
        const bool has_alpha = result.picture.channels == 4;
        layers.push_back(
            {"noisy",
             has_alpha ? std::vector<std::string>{"R", "G", "B", "A"} : std::vector<std::string>{"R", "G", "B"},
             result.picture.pixels, true});
    }
    for (FilmLayer& layer : result.layers) {
        const bool is_color = layer.channels == std::vector<std::string>{"R", "G", "B"} && layer.name != "variance";
        layers.push_back({layer.name, layer.channels, std::move(layer.image.pixels), is_color});
    }
    if (!result.ids.empty()) {
        std::vector<uint32_t> ids;
        for (const PixelIds& id : result.ids) ids.insert(ids.end(), {id.instance, id.primitive, id.material});
        const AovGroup& group = aov_group(kAovIds);
        layers.push_back({group.layer, channel_names(group), std::move(ids)});
    }
    return layers;
}

/// Hash of the layers in order: names, channel names and the bits of all values. Empty if there are none.
std::string hash_of_layers(const std::vector<ExrLayer>& layers) {
    if (layers.empty()) return {};
    Hasher hasher;
    const auto add_name = [&](const std::string& name) {
        hasher.add_value(static_cast<uint64_t>(name.size()));
        hasher.add_values(std::span<const char>(name));
    };
    for (const ExrLayer& layer : layers) {
        add_name(layer.name);
        hasher.add_value(static_cast<uint64_t>(layer.channels.size()));
        for (const std::string& channel : layer.channels) add_name(channel);
        std::visit([&](const auto& values) { hasher.add_values(std::span(values)); }, layer.values);
    }
    return hasher.result().hex();
}

/// Describes the mattes among the layers.
ExrMetadata matte_entries(const PictureFacts& facts, std::span<const FilmLayer> layers) {
    ExrMetadata metadata;
    for (const auto& [type, names] :
         {std::pair(kObjectMattes, &facts.objects), {kMaterialMattes, &facts.matte_materials}}) {
        if (std::ranges::none_of(layers, [&](const FilmLayer& layer) { return layer.name.starts_with(type); }))
            continue;
        for (auto& [name, text] : matte_metadata(type, *names, shown_mattes(layers, type)))
            metadata.emplace_back(std::move(name), std::move(text));
    }
    return metadata;
}

} // namespace

ExrMetadata file_metadata(const PictureFacts& facts, const RenderResult& result, const std::string& hash) {
    ExrMetadata metadata = picture_metadata(facts, result, hash);
    std::ranges::move(matte_entries(facts, result.layers), std::back_inserter(metadata));
    if (!result.denoiser.empty()) metadata.emplace_back("pertev.denoiser", result.denoiser);
    return metadata;
}

std::string failures_of(const WrittenPicture& written) {
    std::string text;
    for (const WrittenFile& file : written.files)
        text += (text.empty() || file.failure.empty() ? "" : "; ") + file.failure;
    return text;
}

void refuse_faults(const WrittenPicture& written, uint64_t invalid_samples, bool strict) {
    const auto has_failed = [](const WrittenFile& file) { return !file.failure.empty(); };
    const auto failed = std::ranges::find_if(written.files, has_failed);
    if (failed != written.files.end()) {
        const std::string place = failed->path + ": "; // the failure begins with it
        if (std::ranges::count_if(written.files, has_failed) == 1 && failed->failure.starts_with(place))
            throw Error(ErrorCode::FileWrite, FileLocation{failed->path}, failed->failure.substr(place.size()));
        throw Error(ErrorCode::FileWrite, failures_of(written));
    }
    if (strict) refuse_invalid_samples(invalid_samples);
}

std::vector<std::byte> encode_picture(ImageFormat format, const PictureRecord& record, RenderResult& result) {
    const Display display = record.display.value_or(Display{});
    if (format == ImageFormat::Png) {
        const bool with_alpha = record.settings.transparent;
        return encode_png(display_image(beauty_of(result), display.transform(), with_alpha), with_alpha);
    }
    PERTEV_CHECK(format == ImageFormat::Exr);
    const PictureFacts facts = facts_of(record, result.ids);
    const ExrMetadata metadata = file_metadata(facts, result, picture_hash(result.picture).hex());
    return encode_exr(beauty_of(result), take_layers(result), metadata, facts.place);
}

WrittenPicture write_picture(std::span<const std::string> paths, const PictureRecord& record, RenderResult& result) {
    return write_picture(paths, facts_of(record, result.ids), result);
}

WrittenPicture write_picture(std::span<const std::string> paths, const PictureFacts& facts, RenderResult& result) {
    const Display display = facts.display.value_or(Display{});
    const std::string hash = picture_hash(result.picture).hex();
    const ExrMetadata metadata = file_metadata(facts, result, hash);
    const std::vector<ExrLayer> layers = take_layers(result);
    WrittenPicture written = {.hash = hash,
                              .layers_hash = hash_of_layers(layers),
                              .denoised_hash = result.denoised ? picture_hash(*result.denoised).hex() : "",
                              .files = {}};
    const WriteImageOptions options = {.display = display.transform(),
                                       .transparent = facts.transparent,
                                       .layers = layers,
                                       .metadata = metadata,
                                       .place = facts.place,
                                       .numbers = facts.numbers};
    for (const std::string& path : paths) {
        if (is_film_name(path)) continue;
        WrittenFile& file = written.files.emplace_back(WrittenFile{path, ""});
        try {
            const bool is_written =
                display.false_colors && write_false_colors(path, beauty_of(result), *display.false_colors);
            if (!is_written) write_image(path, beauty_of(result), options);
        } catch (const Error& error) {
            file.failure = error.what();
        }
    }
    return written;
}

} // namespace pertev
