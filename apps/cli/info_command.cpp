// pertev info FILE: describes a scene, a picture or a radiosity solution.

#include <algorithm>
#include <concepts>
#include <map>
#include <memory>
#include <sstream>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/flag_phrases.h"
#include "apps/cli/reporter.h"
#include "apps/cli/scene_options.h"
#include "apps/cli/setting_flags.h"
#include "base/error.h"
#include "base/file_extension.h"
#include "device_scene/pack_texels.h"
#include "formats/files/file_choices.h"
#include "formats/read_scene.h"
#include "image/image_format.h"
#include "image/picture_hash.h"
#include "image/read_exr.h"
#include "image/read_image.h"
#include "radiosity/radiosity_solution.h"
#include "scene/scene_origin.h"
#include "session/film_file/film_file.h"
#include "session/set_materials.h"
#include "session/survey/default_light.h"
#include "session/writing/check_outputs.h"
#include "session/writing/metadata_json.h"
#include "settings/settings_file.h"
#include "shading/build_light_set.h"

namespace pertev {
namespace {

struct InfoFlags : PictureOptions { // its scene may be another kind of file
    SettingFlags settings;
    bool shows_settings = false;
    ReportFlags report;
};

/// Names and values, in order.
class Facts {
public:
    void add(const std::string& name, const std::string& text) { facts_.push_back({name, text, json_string(text)}); }
    void add(const std::string& name, DoubleVec3 v) {
        facts_.push_back({name, fmt::format("{:.12g} {:.12g} {:.12g}", v.x, v.y, v.z),
                          fmt::format("[{},{},{}]", v.x, v.y, v.z)}); // to all their digits
    }
    template <std::integral Whole>
    void add(const std::string& name, Whole number) {
        facts_.push_back({name, fmt::format("{}", number), fmt::format("{}", number)});
    }
    void add(const std::string& name, Vec3 v) {
        const auto json = [](float x) { return json_number(static_cast<double>(x)); };
        facts_.push_back({name, fmt::format("{:.6g} {:.6g} {:.6g}", v.x, v.y, v.z),
                          fmt::format("[{},{},{}]", json(v.x), json(v.y), json(v.z))});
    }
    void add(const std::string& name, const std::vector<std::string>& texts) {
        std::string json;
        for (const std::string& text : texts) json += (json.empty() ? "" : ",") + json_string(text);
        facts_.push_back({name, fmt::format("{}", fmt::join(texts, " ")), fmt::format("[{}]", json)});
    }
    /// Adds texts of which each has a line.
    void add_lines(const std::string& name, const std::vector<std::string>& texts) {
        add(name, texts);
        facts_.back().text = fmt::format("{}", fmt::join(texts, fmt::format("\n{:25}", "")));
    }
    /// `origin` names the source of the value; empty: unknown.
    void add(const ExrMetadata::value_type& entry, const std::string& origin) {
        const auto text = [](const auto& value) { return fmt::format("{}", value); };
        const std::string after = origin.empty() ? "" : fmt::format("  ({})", origin);
        facts_.push_back({entry.first, phrase(std::visit(text, entry.second)) + after, metadata_json(entry)});
    }
    void report(Reporter& reporter) const {
        std::string json = R"({"event":"info")", lines;
        for (const Fact& fact : facts_) {
            json += fmt::format(",{}:{}", json_string(fact.name), fact.json);
            lines += fmt::format("{:24} {}\n", fact.name, fact.text);
        }
        reporter.result(json + '}');
        reporter.answer(lines);
    }

private:
    struct Fact {
        std::string name, text, json;
    };
    std::vector<Fact> facts_;
};

/// Returns where the values of settings came from, by their keys.
std::map<std::string, std::string> origins_in(const ExrMetadata& metadata) {
    std::map<std::string, std::string> origins;
    for (const auto& [key, origin] : {std::pair("pertev.by_default", "by default"),
                                      {"pertev.by_scene", "the scene's file"},
                                      {"pertev.by_settings", "a settings file"},
                                      {"pertev.by_caller", "a flag"},
                                      {"pertev.by_flags", "a flag"}}) { // the key of earlier versions
        const auto entry = std::ranges::find(metadata, key, &ExrMetadata::value_type::first);
        if (entry == metadata.end() || !std::holds_alternative<std::string>(entry->second)) continue;
        std::istringstream names(std::get<std::string>(entry->second));
        for (std::string name; names >> name;) origins.emplace("pertev." + name, origin);
    }
    return origins;
}

void describe_image(const InfoFlags& flags, Facts& facts, Sink& sink) {
    const Image image = read_image(flags.scene.scene, sink);
    facts.add("width", image.width);
    facts.add("height", image.height);
    facts.add("hash", picture_hash(image).hex());
    double mean[3] = {0, 0, 0};
    for (std::size_t i = 0; i < image.pixels.size(); i += image.channels) {
        for (std::size_t c = 0; c < 3; ++c) mean[c] += static_cast<double>(image.pixels[i + c]);
    }
    const double pixels = static_cast<double>(image.width) * image.height;
    facts.add("mean", Vec3{static_cast<float>(mean[0] / pixels), static_cast<float>(mean[1] / pixels),
                           static_cast<float>(mean[2] / pixels)});
    if (lower_case_extension(flags.scene.scene) != ".exr") return;
    const ExrFile exr = read_exr(flags.scene.scene);
    std::vector<std::string> channels;
    for (const ExrChannel& channel : exr.channels) channels.push_back(channel.name);
    facts.add("channels", channels);
    const std::map<std::string, std::string> origins = origins_in(exr.metadata);
    for (const auto& entry : exr.metadata) {
        const auto origin = origins.find(entry.first);
        facts.add(entry, origin == origins.end() ? "" : origin->second);
    }
}

void describe_film(const InfoFlags& flags, Facts& facts) {
    const FilmHeader header = FilmFileReader(flags.scene.scene).header();
    const auto range = [](uint32_t first, uint32_t end) { return fmt::format("{}:{}", first, end); };
    facts.add("width", header.width);
    facts.add("height", header.height);
    if (header.parts.size() == 1) {
        facts.add("rows", range(header.part().first_row, header.part().end_row));
        facts.add("samples", range(header.part().samples.first, header.part().samples.end));
    } else {
        std::vector<std::string> parts;
        for (const auto& [first_row, end_row, samples] : header.parts)
            parts.push_back(
                fmt::format("rows {}, samples {}", range(first_row, end_row), range(samples.first, samples.end)));
        facts.add_lines("parts", parts);
    }
    facts.add("spp", header.spp);
    for (const ExrMetadata* entries : {&header.facts.settings, &header.facts.shown, &header.facts.origin})
        for (const auto& entry : *entries) facts.add(entry, "");
}

/// Returns the settings that made a picture, with as many samples as it has. Throws Error(BadInput).
std::string settings_of(const std::string& picture) {
    const ExrMetadata metadata = lower_case_extension(picture) == ".exr" ? read_exr(picture).metadata : ExrMetadata();
    const auto value_of = [&](std::string_view name) {
        const auto entry = std::ranges::find(metadata, name, &ExrMetadata::value_type::first);
        if (entry == metadata.end()) {
            throw Error(
                ErrorCode::BadInput, FileLocation{picture},
                fmt::format("the file contains no settings ({}); EXR files of pertev render contain them", name));
        }
        return std::visit([](const auto& value) { return fmt::format("{}", value); }, entry->second);
    };
    return with_samples(value_of("pertev.settings"), value_of("pertev.spp"));
}

/// Lists the file's animations and scenes, and those that a render plays and shows by default.
void describe_choices(const Scene& scene, Facts& facts) {
    std::vector<std::string> animations = list_clips(scene.clips); // values of --animation
    for (std::size_t i = 0; i < animations.size(); ++i) {
        animations[i] += fmt::format(" ({:.6g} s)", scene.clips[i].end_s);
    }
    facts.add("animations", animations);
    if (animations.size() > 1) facts.add("plays", clip_choice(scene.clips));
    if (!scene.variants.empty()) facts.add("variants", list_material_variants(scene)); // values of --variant
    if (scene.file_scenes.size() < 2) return;
    facts.add("file_scenes", list_file_scenes(scene)); // values of --file-scene
    facts.add("shows", file_scene_choice(scene));
}

/// Returns each name once, with the number of its objects if there are several. Those without a name have a number.
template <class Objects>
std::vector<std::string> names_of_objects(const Objects& objects) {
    std::map<std::string, std::size_t> counts;
    std::vector<std::string> order;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        const std::string name = objects[i].name.empty() ? fmt::format("{}", i) : objects[i].name;
        if (++counts[name] == 1) order.push_back(name);
    }
    for (std::string& name : order) {
        if (counts[name] > 1) name += fmt::format(" ({} times)", counts[name]);
    }
    return order;
}

/// Returns a line for each light: its name or number, kind, strength and position.
std::vector<std::string> describe_lights(const Scene& scene) {
    std::vector<std::string> lines;
    for (const Light& light : scene.lights) {
        const char* const kinds[] = {"point", "spot", "directional", "goniometric"}; // in the order of LightKind
        const LightParts parts = parts_of(light.kind);
        const DoubleVec3 at = in_file(scene, light.position);
        const Rgb c = light.intensity;
        lines.push_back(fmt::format(
            "{} {}: {:.6g} {:.6g} {:.6g} {}{}{}", light.name.empty() ? fmt::format("{}", lines.size()) : light.name,
            kinds[static_cast<std::size_t>(light.kind)], c.r, c.g, c.b, parts.position ? "W/sr" : "W/m2",
            parts.position ? fmt::format(", at {:.6g} {:.6g} {:.6g}", at.x, at.y, at.z) : "",
            parts.direction
                ? fmt::format(", towards {:.4g} {:.4g} {:.4g}", light.direction.x, light.direction.y, light.direction.z)
                : ""));
    }
    return lines;
}

void describe_scene(const InfoFlags& flags, Facts& facts, Sink& sink) {
    const Scene scene = read_any_scene(flags.scene, sink);
    uint64_t unique = 0, placed = 0;
    for (const Mesh& mesh : scene.meshes) unique += mesh.triangle_count();
    for (const Instance& instance : scene.instances) placed += scene.meshes[instance.mesh].triangle_count();
    facts.add("meshes", scene.meshes.size());
    facts.add("instances", scene.instances.size());
    facts.add("triangles", unique);
    facts.add("triangles_placed", placed);
    facts.add("materials", scene.materials.size());
    facts.add("images", scene.images.size());
    facts.add("image_bytes", texture_bytes(scene));
    const uint64_t emissive = count_emissive_triangles(scene);
    const bool has_environment = scene.environment && max_component(scene.environment->scale) > 0;
    facts.add("lights", emissive + scene.lights.size() + (has_environment ? 1 : 0)); // counted like render does
    facts.add("emissive_triangles", emissive);
    facts.add("environment", has_environment ? "yes" : "no");
    const Bounds3 bounds = bounds_of(scene);
    if (scene.origin_in_file == DoubleVec3{0, 0, 0}) {
        facts.add("bounds_low", bounds.lo);
        facts.add("bounds_high", bounds.hi);
    } else {
        facts.add("bounds_low", in_file(scene, bounds.lo));
        facts.add("bounds_high", in_file(scene, bounds.hi));
    }
    std::vector<std::string> cameras;
    for (const Camera& camera : scene.cameras) { // values of --camera
        cameras.push_back(camera.name.empty() ? fmt::format("{}", cameras.size()) : camera.name);
    }
    facts.add("cameras", cameras);
    describe_choices(scene, facts);
    std::vector<std::string> suggests, makes_up; // settings that a render takes from the file, and its defaults
    if (scene.cameras.empty()) makes_up.emplace_back("camera");
    if (lacks_light(scene)) makes_up.emplace_back("light");
    if (!scene.cameras.empty()) {
        suggests.push_back("camera=" + cameras.front());
        RenderSettings size;
        set_default_size(size, &scene.cameras.front());
        if (scene.cameras.front().aspect > 0) suggests.push_back(fmt::format("size={}x{}", size.width, size.height));
    }
    for (const SuggestedSetting& setting : scene.suggested) suggests.push_back(setting.name + "=" + setting.text);
    facts.add("suggests", suggests);
    facts.add("makes_up", makes_up);
    std::vector<std::string> materials; // values of --material
    for (std::size_t i = 0; i < scene.materials.size(); ++i) materials.push_back(describe_material(scene, i));
    facts.add_lines("material_list", materials);
    facts.add_lines("light_list", describe_lights(scene));
    facts.add_lines("object_list", names_of_objects(scene.instances));
    facts.add_lines("image_list", names_of_objects(scene.images));
}

void describe_solution(const InfoFlags& flags, Facts& facts) {
    const RadiositySolution solution = read_any_solution(flags.scene.scene);
    facts.add("solution", "radiosity");
    facts.add("triangles", solution.roots.size() / 2); // a face for each side
    facts.add("shown", solution.patches.size());       // patches and parts of them, as pertev solve reports
    facts.add("bytes", solution.bytes());
    const std::string part = describe(solution.extent);
    facts.add("holds", !solution.light ? "unknown, because an earlier version made it"
                       : part.empty()  ? "all light"
                                       : part);
    facts.add("made_by", solution.made);
    facts.add("hash", solution.hash().hex());
    facts.add("geometry", solution.geometry.hex());
}

int info(InfoFlags& flags) {
    Reporter reporter(flags.report);
    flags.settings.read(flags, reporter);
    const std::string& name = flags.scene.scene;
    if (flags.shows_settings) {
        const std::string settings = settings_of(name);
        reporter.event(settings);
        reporter.answer(settings + "\n");
        return 0;
    }
    Facts facts;
    facts.add("file", name);
    refuse(!flags.scene.file_scene.empty() && (is_picture_name(name) || !is_scene_name(name)),
           {"file_scene", flags.scene.file_scene, fmt::format("applies to scenes; {} is none", name)});
    refuse(!flags.scene.variant.empty() && (is_picture_name(name) || !is_scene_name(name)),
           {"variant", flags.scene.variant, fmt::format("applies to scenes; {} is none", name)});
    if (is_picture_name(name)) {
        describe_image(flags, facts, reporter);
    } else if (is_film_name(name)) {
        describe_film(flags, facts);
    } else if (is_scene_name(flags.scene.scene)) {
        describe_scene(flags, facts, reporter);
    } else if (is_solution(flags.scene.scene)) {
        describe_solution(flags, facts);
    } else {
        throw Error(ErrorCode::BadInput, FileLocation{flags.scene.scene},
                    fmt::format("neither a picture ({}) nor {}, nor a radiosity solution",
                                fmt::join(kPictureExtensions, " "), scene_kinds()));
    }
    reporter.report_messages();
    facts.report(reporter);
    return 0;
}

} // namespace

void add_info_command(CLI::App& app, int& status) {
    CLI::App& verb = *app.add_subcommand("info", "Describe a scene, a picture or a radiosity solution");
    const auto flags = std::make_shared<InfoFlags>();
    verb.add_option("FILE", flags->scene.scene,
                    "a scene (.gltf .glb .obj .ply .stl .pbrt .xml, or a built-in one:\n" + builtin_scene_list() +
                        "),\na picture, a film file, or what solve has made")
        ->type_name("")
        ->check(file_name())
        ->required();
    flags->settings.add(verb, kInfo, *flags);
    verb.add_flag("--settings", flags->shows_settings,
                  "Prints the settings that made a picture as JSON, for pertev render --settings.");
    add_report_flags(verb, flags->report);
    verb.callback([flags, &status] { status = info(*flags); });
}

} // namespace pertev
