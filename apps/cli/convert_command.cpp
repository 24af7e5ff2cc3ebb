// pertev convert IN OUT: writes a scene as glTF, or a picture in another format, and names what is lost.

#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/reporter.h"
#include "apps/cli/scene_options.h"
#include "apps/cli/setting_flags.h"
#include "base/file_extension.h"
#include "base/read_file.h"
#include "base/write_file_atomically.h"
#include "formats/gltf_writer/write_glb.h"
#include "formats/read_scene.h"
#include "image/exr_reader.h"
#include "image/read_image.h"
#include "image/write_image.h"
#include "session/opening/strictness.h"
#include "session/photometry.h"

namespace pertev {
namespace {

struct ConvertFlags : PictureOptions { // its scene may be a picture
    SettingFlags settings;
    std::string output;
    ReportFlags report;
};

bool is_eight_bits(ImageFormat format) { return format == ImageFormat::Png || format == ImageFormat::Jpeg; }

/// Reports what a picture loses in another format.
void name_losses(const std::string& from, const Image& picture, ImageFormat to, Sink& sink) {
    const auto lose = [&](const std::string& what) { sink.leave_out({FileLocation{from}, what}); };
    if (lower_case_extension(from) == ".exr") {
        std::vector<std::string> lost;
        const std::vector<std::byte> bytes = read_file(from);
        const ExrReader exr(bytes, from);
        for (std::size_t part = 0; part < exr.part_count(); ++part) {
            for (const ExrReader::ChannelInfo& channel : exr.channels(part)) {
                const std::string_view name = channel.name;
                const bool is_shown = name == "R" || name == "G" || name == "B" || name == "A" || name == "Y";
                if (part > 0 || !is_shown) lost.push_back(channel.name);
            }
        }
        if (exr.metadata().size() > 0) lose("its metadata is lost");
        if (!lost.empty()) lose(fmt::format("channels besides the picture's are lost: {}", fmt::join(lost, " ")));
    }
    const bool has_alpha = picture.channels == 4;
    if (has_alpha && (to == ImageFormat::Jpeg || to == ImageFormat::Hdr)) lose("alpha is lost");
    if (!is_eight_bits(to)) return;
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const bool is_color = !has_alpha || i % 4 != 3;
        beyond += is_color && !(picture.pixels[i] >= 0 && picture.pixels[i] <= 1) ? 1 : 0;
    }
    if (beyond > 0) lose(fmt::format("{} of its numbers are outside of 0 to 1 and are clipped", beyond));
}

/// Multiplies colours by alpha, as all formats but PNG have them.
void premultiply(Image& picture) {
    for (std::size_t i = 0; picture.channels == 4 && i < picture.pixels.size(); i += 4) {
        for (std::size_t c = 0; c < 3; ++c) picture.pixels[i + c] *= picture.pixels[i + 3];
    }
}

void convert_picture(const ConvertFlags& flags, Reporter& reporter) {
    const std::string& from = flags.scene.scene;
    const ImageFormat to = image_format_for(flags.output);
    Image picture = read_image(from, reporter);
    if (lower_case_extension(from) == ".png") premultiply(picture);
    check_image_output(flags.output, picture.width, picture.height);
    name_losses(from, picture, to, reporter);
    if (flags.strict) refuse_what_is_left_out(reporter, "nothing is written");
    reporter.write_output(flags.output,
                          [&] { write_image(flags.output, picture, {.transparent = picture.channels == 4}); });
}

void convert_scene(const ConvertFlags& flags, Reporter& reporter) {
    refuse(lower_case_extension(flags.output) != ".glb",
           {"", "", fmt::format("{}: a scene is written as .glb", flags.output)});
    check_writable(flags.output);
    const Scene scene = read_any_scene(flags.scene, reporter);
    if (const double lumens = lumens_per_watt(flags.scene.scene); lumens != 1) {
        reporter.note(fmt::format("glTF counts a watt as 1 lm: `efficacy={:g}` measures the written scene", lumens));
    }
    const std::vector<std::byte> file = encode_glb(scene, reporter);
    if (flags.strict) refuse_what_is_left_out(reporter, "nothing is written");
    reporter.write_output(flags.output, [&] { write_file_atomically(flags.output, file, reporter); });
}

int convert(ConvertFlags& flags) {
    Reporter reporter(flags.report);
    flags.settings.read(flags, reporter);
    std::error_code none;
    refuse(std::filesystem::equivalent(flags.scene.scene, flags.output, none),
           {"", "", fmt::format("{}: the input would be overwritten", flags.output)});
    if (is_picture_name(flags.scene.scene)) {
        convert_picture(flags, reporter);
    } else {
        convert_scene(flags, reporter);
    }
    reporter.report_messages();
    reporter.result(fmt::format(R"({{"event":"convert","file":{},"path":{}}})", json_string(flags.scene.scene),
                                json_string(flags.output)));
    return 0;
}

} // namespace

void add_convert_command(CLI::App& app, int& status) {
    CLI::App& verb = *app.add_subcommand("convert", "Write a scene as .glb, or a picture in another format");
    const auto flags = std::make_shared<ConvertFlags>();
    verb.add_option("IN", flags->scene.scene, "a scene, or a picture: .exr .hdr .png .jpg")
        ->type_name("")
        ->check(file_name())
        ->required();
    verb.add_option("OUT", flags->output, "the file to write: .glb, or .exr .hdr .png .jpg")
        ->type_name("")
        ->check(file_name())
        ->required();
    flags->settings.add(verb, kConvert, *flags);
    add_report_flags(verb, flags->report);
    verb.callback([flags, &status] { status = convert(*flags); });
}

} // namespace pertev
