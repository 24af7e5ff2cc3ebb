#include "session/film_file/film_header.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json_text.h"
#include "base/limits.h"
#include "session/post_steps.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

using gltf::JsonValue;

/// Returns all digits of a number; a negative zero keeps its sign.
std::string exact_number(double value) { return value == 0 && std::signbit(value) ? "-0.0" : fmt::format("{}", value); }
std::string exact_number(float value) { return exact_number(static_cast<double>(value)); }

// The types of metadata in the order of their variant.
constexpr std::string_view kTypes[] = {"text", "whole", "float", "double"};

std::string json_of_metadata(const ExrMetadata& metadata) {
    std::vector<std::string> entries;
    for (const auto& [name, value] : metadata) {
        const std::string text = std::visit(
            [](const auto& v) {
                if constexpr (std::is_same_v<std::decay_t<decltype(v)>, std::string>)
                    return json_string(v);
                else if constexpr (std::is_same_v<std::decay_t<decltype(v)>, int32_t>)
                    return fmt::format("{}", v);
                else
                    return exact_number(v);
            },
            value);
        entries.push_back(fmt::format(R"({{"name":{},"{}":{}}})", json_string(name), kTypes[value.index()], text));
    }
    return fmt::format("[{}]", fmt::join(entries, ","));
}

ExrMetadata read_metadata(const JsonValue& list) {
    ExrMetadata metadata;
    for (const JsonValue& entry : list.elements()) {
        std::string name(entry.at("name").to_string());
        if (const auto text = entry.find("text")) {
            metadata.emplace_back(std::move(name), std::string(text->to_string()));
        } else if (const auto whole = entry.find("whole")) {
            const double value = whole->to_double();
            if (value != std::floor(value) || std::abs(value) > INT32_MAX) throw whole->error("not a whole number");
            metadata.emplace_back(std::move(name), static_cast<int32_t>(value));
        } else if (const auto number = entry.find("float")) {
            metadata.emplace_back(std::move(name), number->to_float());
        } else {
            metadata.emplace_back(std::move(name), entry.at("double").to_double());
        }
    }
    return metadata;
}

std::string json_of_display(const Display& display) {
    std::string colors;
    if (const auto& shown = display.false_colors) {
        colors = fmt::format(R"(,"false_colors":{{"quantity":{},"unit":{},"factor":{},"least":{},"most":{}}})",
                             json_string(shown->quantity), json_string(shown->unit), exact_number(shown->factor),
                             exact_number(shown->least), exact_number(shown->most));
    }
    std::vector<std::string> stops;
    for (const auto& [curve, metered] : display.metered)
        stops.push_back(fmt::format(R"("{}":{})", name_of(curve), exact_number(metered)));
    const std::string metered = stops.empty() ? "" : fmt::format(R"(,"metered":{{{}}})", fmt::join(stops, ","));
    const std::string lut =
        display.lut_file.empty()
            ? ""
            : fmt::format(R"(,"lut":{},"lut_input":"{}")", json_string(display.lut_file), name_of(display.lut_input));
    return fmt::format(R"({{"tone_map":"{}","exposure":{}{}{}{}}})", name_of(display.tone_map),
                       exact_number(display.exposure_stops), colors, metered, lut);
}

template <NamedValue Value>
Value read_name(const JsonValue& value) {
    const auto named = value_named<Value>(value.to_string());
    if (!named) throw value.error("unknown name");
    return *named;
}

Display read_display(const JsonValue& value) {
    Display display = {read_name<ToneMap>(value.at("tone_map")), value.at("exposure").to_float(), std::nullopt, {}};
    if (const auto metered = value.find("metered")) {
        for (const auto& [name, stops] : metered->members()) {
            const auto curve = value_named<ToneMap>(name);
            if (!curve) throw stops.error("unknown tone map");
            display.metered.emplace_back(*curve, stops.to_float());
        }
    }
    if (const auto lut = value.find("lut")) {
        display.lut_file = lut->to_string();
        display.lut_input = read_name<LutInput>(value.at("lut_input"));
    }
    if (const auto colors = value.find("false_colors")) {
        display.false_colors =
            FalseColors{std::string(colors->at("quantity").to_string()), std::string(colors->at("unit").to_string()),
                        colors->at("factor").to_float(), colors->at("least").to_float(), colors->at("most").to_float()};
    }
    return display;
}

uint32_t read_number(const JsonValue& value, uint64_t least, uint64_t most) {
    const uint64_t number = value.to_unsigned();
    if (number > most) throw Error(ErrorCode::OverLimit, value.location(), fmt::format("{} is over {}", number, most));
    if (number < least) throw value.error(fmt::format("{} is under {}", number, least));
    return static_cast<uint32_t>(number);
}

/// Reads [a, b] with a <= b <= `most`.
std::pair<uint32_t, uint32_t> read_range(const JsonValue& value, uint32_t most) {
    const std::vector<JsonValue> ends = value.elements();
    if (ends.size() != 2) throw value.error("expected two numbers");
    const uint32_t first = read_number(ends[0], 0, most), end = read_number(ends[1], 0, most);
    if (first > end) throw value.error("expected the smaller number first");
    return {first, end};
}

/// The rows and samples of the film.
std::string json_of_parts(const std::vector<FilmPart>& parts) {
    if (parts.size() == 1) {
        const auto& [first_row, end_row, samples] = parts.front();
        return fmt::format(R"("rows":[{},{}],"samples":[{},{}])", first_row, end_row, samples.first, samples.end);
    }
    std::vector<std::string> texts;
    for (const auto& [first_row, end_row, samples] : parts)
        texts.push_back(fmt::format("[{},{},{},{}]", first_row, end_row, samples.first, samples.end));
    return fmt::format(R"("parts":[{}])", fmt::join(texts, ","));
}

/// The place of a crop in the whole picture; empty if the film is of the whole.
std::string json_of_place(const ExrPlace& place) {
    if (place.is_whole()) return "";
    return fmt::format(R"(,"crop_at":[{},{}],"whole_size":[{},{}])", place.x, place.y, place.whole_width,
                       place.whole_height);
}

/// The names that mattes may show; empty if there are none.
std::string json_of_mattes(const PictureFacts& facts) {
    if (facts.objects.empty() && facts.matte_materials.empty()) return "";
    return fmt::format(R"(,"matte_objects":{},"matte_materials":{})", json_strings(facts.objects),
                       json_strings(facts.matte_materials));
}

std::vector<std::string> read_texts(const JsonValue& root, const char* name) {
    std::vector<std::string> texts;
    if (const auto list = root.find(name))
        for (const JsonValue& text : list->elements()) texts.emplace_back(text.to_string());
    return texts;
}

/// Reads two numbers.
std::pair<uint32_t, uint32_t> read_pair(const JsonValue& value, uint32_t least) {
    const std::vector<JsonValue> numbers = value.elements();
    if (numbers.size() != 2) throw value.error("expected two numbers");
    return {read_number(numbers[0], least, kMaxImageSide), read_number(numbers[1], least, kMaxImageSide)};
}

/// Reads the part that a film is of, or several in the order of RowSamples::parts().
std::vector<FilmPart> read_parts(const JsonValue& root, uint32_t height) {
    const auto list = root.find("parts");
    if (!list) {
        const auto [first_row, end_row] = read_range(root.at("rows"), height);
        const auto [first, end] = read_range(root.at("samples"), kMaxSamplesPerPixel);
        return {{first_row, end_row, {first, end}}};
    }
    std::vector<FilmPart> parts;
    for (const JsonValue& entry : list->elements()) {
        const std::vector<JsonValue> ends = entry.elements();
        if (ends.size() != 4) throw entry.error("expected four numbers");
        const FilmPart part = {
            read_number(ends[0], 0, height),
            read_number(ends[1], 0, height),
            {read_number(ends[2], 0, kMaxSamplesPerPixel), read_number(ends[3], 0, kMaxSamplesPerPixel)}};
        const FilmPart before = parts.empty() ? FilmPart() : parts.back();
        const bool follows =
            part.first_row >= before.end_row || (part.first_row == before.first_row && part.end_row == before.end_row &&
                                                 part.samples.first > before.samples.end);
        if (part.first_row >= part.end_row || part.samples.first >= part.samples.end || !follows)
            throw entry.error("expected rows and samples that follow those before");
        parts.push_back(part);
    }
    if (parts.empty()) throw list->error("expected a part");
    return parts;
}

/// Reads where a film of this size is in its whole picture.
ExrPlace read_place(const JsonValue& root, uint32_t width, uint32_t height) {
    const auto at = root.find("crop_at");
    if (!at) return {};
    ExrPlace place;
    std::tie(place.x, place.y) = read_pair(*at, 0);
    std::tie(place.whole_width, place.whole_height) = read_pair(root.at("whole_size"), 1);
    if (uint64_t{place.x} + width > place.whole_width || uint64_t{place.y} + height > place.whole_height)
        throw at->error("the film is not inside the whole picture");
    return place;
}

/// Returns name and size of each of the film's targets, for readers that do not know its settings.
std::string json_of_targets(const FilmHeader& header) {
    Queue queue = Queue::make_dry_run(false);
    std::vector<std::string> targets;
    const Film film = header.make_film(queue);
    for (const auto& target : film.targets()) {
        targets.push_back(fmt::format(R"({{"name":{},"bytes":{},"stride":{}}})", json_string(target->name()),
                                      target->byte_count(), target->stride()));
    }
    return fmt::format("[{}]", fmt::join(targets, ","));
}

} // namespace

Film FilmHeader::make_film(Queue& queue) const {
    Film film(queue, width, height, aovs, light_layers, layers_at);
    hold_sample_layers(queue, sample_layers, film);
    if (is_denoised()) film.hold(std::make_unique<DenoiserTarget>(denoiser_state_size(denoise, width, height)));
    return film;
}

FilmHeader film_header(const PictureOptions& options, const PictureRecord& record, const PictureFacts& facts,
                       const RenderStats& stats, const Film& film) {
    FilmHeader header = {.settings = deciding_settings(options, record),
                         .width = film.width(),
                         .height = film.height(),
                         .aovs = film.aovs(),
                         .sample_layers = sample_layers_of(film),
                         .light_layers = film.light_layers(),
                         .layers_at = film.layers_at(),
                         .denoise = record.settings.denoise,
                         .parts = {film.part()},
                         .spp = options.render.samples,
                         .facts = facts,
                         .rays = stats.rays,
                         .render_seconds = stats.render_seconds};
    std::erase_if(header.settings,
                  [](const auto& setting) { return setting.first == "spp" || setting.first == "scene"; });
    if (FilmPart& part = header.parts.front(); part.is_empty()) {
        part = record.settings.part();
        part.samples.end = part.samples.first;
    }
    return header;
}

std::optional<SettingDifference> film_difference(const FilmHeader& before, const FilmHeader& after) {
    if (auto different = first_difference(before.settings, after.settings)) return different;
    const auto shape = [](const FilmHeader& of) {
        return fmt::format("{}x{}, {}, {}, {}, {}, {}", of.width, of.height, of.aovs, of.sample_layers,
                           json_strings(of.light_layers), static_cast<int>(of.layers_at), name_of(of.denoise));
    };
    if (shape(before) == shape(after)) return std::nullopt;
    return SettingDifference{"the film", shape(before), shape(after)};
}

std::string json_of(const FilmHeader& header) {
    std::vector<std::string> settings, layers = aov_names(header.aovs);
    for (const auto& [name, value] : header.settings)
        settings.push_back(fmt::format("{}:{}", json_string(name), json_string(value)));
    for (std::string& name : sample_layer_names(header.sample_layers)) layers.push_back(std::move(name));
    const PictureFacts& facts = header.facts;
    return fmt::format(
        R"({{"settings":{{{}}},"size":[{},{}]{},{},"spp":{},"layers":{},"light_layers":{},"layers_at":"{}"{}{},"targets":{},)"
        R"("metadata":{},"display_metadata":{},"origin":{},"display":{},"transparent":{},"rays":{{"camera":{},"bounce":{},"shadow":{}}},"seconds":{}}})",
        fmt::join(settings, ","), header.width, header.height, json_of_place(facts.place), json_of_parts(header.parts),
        header.spp, json_strings(layers), json_strings(header.light_layers), name_of(header.layers_at),
        header.is_denoised() ? fmt::format(R"(,"denoise":"{}")", name_of(header.denoise)) : "", json_of_mattes(facts),
        json_of_targets(header), json_of_metadata(facts.settings), json_of_metadata(facts.shown),
        json_of_metadata(facts.origin), facts.display ? json_of_display(*facts.display) : "null", facts.transparent,
        header.rays.camera, header.rays.bounce, header.rays.shadow, exact_number(header.render_seconds));
}

FilmHeader read_film_header(const JsonValue& root) {
    FilmHeader header;
    for (const auto& [name, value] : root.at("settings").members())
        header.settings.emplace_back(name, value.to_string());
    std::tie(header.width, header.height) = read_pair(root.at("size"), 1);
    if (uint64_t(header.width) * header.height > kMaxImagePixels)
        throw Error(ErrorCode::OverLimit, root.at("size").location(), "too many pixels");
    header.parts = read_parts(root, header.height);
    uint32_t last = 0;
    for (const FilmPart& part : header.parts) last = std::max(last, part.samples.end);
    header.spp = read_number(root.at("spp"), last, kMaxSamplesPerPixel);
    for (const JsonValue& layer : root.at("layers").elements()) {
        if (const auto of_samples = sample_layer_named(layer.to_string())) {
            header.sample_layers |= *of_samples;
            continue;
        }
        const auto aov = aov_named(layer.to_string());
        if (!aov || *aov == kAovMotion) throw layer.error("unknown layer");
        header.aovs |= *aov;
    }
    for (const JsonValue& layer : root.at("light_layers").elements())
        header.light_layers.emplace_back(layer.to_string());
    header.layers_at = read_name<LayersAt>(root.at("layers_at"));
    if (const auto denoise = root.find("denoise")) header.denoise = read_name<Denoise>(*denoise);
    if (json_of_targets(header) != root.at("targets").to_json())
        throw root.at("targets").error("the targets do not fit these layers and this size");
    header.facts = {.settings = read_metadata(root.at("metadata")),
                    .shown = read_metadata(root.at("display_metadata")),
                    .origin = read_metadata(root.at("origin")),
                    .display = std::nullopt,
                    .transparent = root.at("transparent").to_bool(),
                    .place = read_place(root, header.width, header.height),
                    .objects = read_texts(root, "matte_objects"),
                    .matte_materials = read_texts(root, "matte_materials")};
    if (const auto display = root.find("display")) header.facts.display = read_display(*display);
    const JsonValue rays = root.at("rays");
    header.rays = {rays.at("camera").to_unsigned(), rays.at("bounce").to_unsigned(), rays.at("shadow").to_unsigned()};
    header.render_seconds = root.at("seconds").to_double();
    return header;
}

} // namespace pertev
