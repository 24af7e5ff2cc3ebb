// pertev info SCENE|IMAGE: what a file holds.

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/commands.h"
#include "apps/cli/reporter.h"
#include "base/error.h"
#include "formats/builtin_scenes.h"
#include "formats/read_scene.h"
#include "image/picture_hash.h"
#include "image/read_exr.h"
#include "image/read_image.h"

namespace pertev {
namespace {

struct InfoFlags {
    std::string file;
    std::vector<std::filesystem::path> allowed_paths;
    bool quiet = false, json = false;
};

/// Names and values; values stand as JSON.
class Facts {
public:
    void add(const std::string& name, const std::string& text) { facts_.emplace_back(name, json_string(text)); }
    void add(const std::string& name, uint64_t number) { facts_.emplace_back(name, fmt::format("{}", number)); }
    void add(const std::string& name, Vec3 v) {
        facts_.emplace_back(name, fmt::format("[{:.6g},{:.6g},{:.6g}]", v.x, v.y, v.z));
    }
    void print(const Reporter& reporter) const {
        if (reporter.quiet()) return;
        std::string line;
        for (const auto& [name, value] : facts_) {
            if (reporter.json()) {
                line += fmt::format("{}{}:{}", line.empty() ? "" : ",", json_string(name), value);
            } else {
                fmt::print("{:24} {}\n", name, value);
            }
        }
        if (reporter.json()) fmt::print("{{{}}}\n", line);
    }

private:
    std::vector<std::pair<std::string, std::string>> facts_;
};

bool is_image(const std::string& file) {
    std::string extension = std::filesystem::path(file).extension().string();
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    for (const char* known : {".exr", ".png", ".jpg", ".jpeg", ".hdr"}) {
        if (extension == known) return true;
    }
    return false;
}

void describe_image(const InfoFlags& flags, Facts& facts, Messages& messages) {
    const Image image = read_image(flags.file, &messages);
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
    if (!flags.file.ends_with(".exr")) return;
    const ExrFile exr = read_exr(flags.file);
    std::string channels;
    for (const ExrChannel& channel : exr.channels) channels += (channels.empty() ? "" : " ") + channel.name;
    facts.add("channels", channels);
    for (const auto& [name, value] : exr.metadata) {
        std::visit([&](const auto& v) { facts.add(name, fmt::format("{}", v)); }, value);
    }
}

void describe_scene(const InfoFlags& flags, Facts& facts, Messages& messages) {
    ReadOptions options;
    options.allowed_paths = flags.allowed_paths;
    const Scene scene = builtin_scene(flags.file) ? read_builtin_scene(flags.file, messages)
                                                  : read_scene(flags.file, options, messages);
    uint64_t unique = 0, placed = 0;
    for (const Mesh& mesh : scene.meshes) unique += mesh.triangle_count();
    for (const Instance& instance : scene.instances) placed += scene.meshes[instance.mesh].triangle_count();
    facts.add("meshes", scene.meshes.size());
    facts.add("instances", scene.instances.size());
    facts.add("triangles", unique);
    facts.add("triangles placed", placed);
    facts.add("materials", scene.materials.size());
    facts.add("images", scene.images.size());
    facts.add("lights", scene.lights.size());
    facts.add("environment", scene.environment ? "yes" : "no");
    const Bounds3 bounds = bounds_of(scene);
    facts.add("bounds low", bounds.lo);
    facts.add("bounds high", bounds.hi);
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        facts.add(fmt::format("camera {}", i), scene.cameras[i].name);
    }
}

int info(const InfoFlags& flags) {
    Reporter reporter(flags.quiet, flags.json);
    Messages messages;
    Facts facts;
    facts.add("file", flags.file);
    if (is_image(flags.file)) {
        describe_image(flags, facts, messages);
    } else {
        describe_scene(flags, facts, messages);
    }
    reporter.say(messages);
    facts.print(reporter);
    return 0;
}

} // namespace

void add_info_command(CLI::App& app, int& status) {
    CLI::App& verb = *app.add_subcommand("info", "Say what a scene or a picture holds");
    const auto flags = std::make_shared<InfoFlags>();
    verb.add_option("FILE", flags->file, "a scene (.gltf .glb .obj .ply or a built-in one) or a picture")->required();
    verb.add_option("--allow-path", flags->allowed_paths, "a folder outside the scene's own that it may read from")
        ->check(CLI::ExistingDirectory);
    verb.add_flag("-q,--quiet", flags->quiet, "say nothing but errors");
    verb.add_flag("--json", flags->json, "one JSON object");
    verb.callback([flags, &status] { status = info(*flags); });
}

} // namespace pertev
