#include "session/writing/check_outputs.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/file_extension.h"
#include "base/write_file_atomically.h"
#include "image/write_image.h"
#include "session/crop.h"
#include "session/frame_range.h"
#include "settings/setting_table.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

/// The file that is written, however it is named: without links, also one to a file that is not there yet, "." and
/// "..".
std::filesystem::path canonical_path(const std::string& file) {
    constexpr int kMaxLinks = 40; // limit of Linux
    std::error_code fault;        // after an error the path is resolved as far as possible
    std::filesystem::path full_path = std::filesystem::absolute(file, fault);
    for (int i = 0; i < kMaxLinks && std::filesystem::is_symlink(full_path, fault); ++i) {
        full_path = full_path.parent_path() / std::filesystem::read_symlink(full_path, fault);
    }
    const std::filesystem::path known = std::filesystem::weakly_canonical(full_path, fault);
    return fault ? full_path : known;
}

[[noreturn]] void refuse(const std::string& setting, const std::string& value, const std::string& why) {
    throw Error(ErrorCode::BadInput, setting, value, why);
}

/// Refuses two outputs that are one file, of which the second picture would replace the first; of a sequence, two that
/// are one file at some frame.
void refuse_twins(std::span<const std::string> outputs, const std::optional<FrameRange>& frames) {
    std::map<std::filesystem::path, std::string> taken;
    for (const std::string& output : outputs) {
        const std::string file = frames ? frame_file(output, frames->last, frames->names) : output; // the most digits
        const auto [entry, is_new] = taken.emplace(canonical_path(file), output);
        if (is_new) continue;
        refuse("output", output,
               fmt::format("`output={}` names the same file{}; leave out one of them", entry->second,
                           frames ? fmt::format(" for frame {}", frames->last) : ""));
    }
}

/// Refuses outputs and records that are a generation of the checkpoint, and outputs that are the records.
void refuse_twins_of_kept(std::span<const std::string> outputs, const PictureOptions& options) {
    const std::string &checkpoint = options.checkpoint, &records = options.radiosity.records;
    const auto check = [&](const std::string& setting, const std::string& name, const std::string& kept_by,
                           const std::string& kept) {
        if (name.empty() || kept.empty()) return;
        const std::filesystem::path file = canonical_path(name);
        if (file == canonical_path(kept) || (kept_by == "checkpoint" && file == canonical_path(kept + ".previous")))
            refuse(setting, name, fmt::format("`{}={}` names the same file", kept_by, kept));
    };
    for (const std::string& output : outputs) {
        check("output", output, "checkpoint", checkpoint);
        check("output", output, "records", records);
    }
    check("records", records, "checkpoint", checkpoint);
}

/// Refuses a setting that no file shows where the caller has set it. A settings file may be for other outputs.
void refuse_unshown(const PictureOptions& options, uint32_t written) {
    const auto check = [&](const std::string& setting, const std::string& value, uint32_t formats) {
        const auto given = options.given.find(setting);
        const bool is_given = given != options.given.end() && given->second == SettingOrigin::Caller;
        if (!is_given || formats == 0 || (written & formats) != 0) return;
        std::vector<std::string_view> names;
        for (const auto& [format, name] :
             {std::pair(ImageFormat::Exr, "EXR"), {ImageFormat::Png, "PNG"}, {ImageFormat::Jpeg, "JPEG"}}) {
            if ((formats & bit_of(format)) != 0) names.emplace_back(name);
        }
        const bool has_exr = (formats & bit_of(ImageFormat::Exr)) != 0;
        refuse(setting, value,
               fmt::format("applies only to {} output; add `output=NAME.{}`", fmt::join(names, " and "),
                           has_exr ? "exr" : "png"));
    };
    for (const Setting& setting : all_settings()) {
        if (!is_switch(setting) || texts_of(options, setting).front() == "true")
            check(setting.name, "", setting.formats);
    }
    if (options.false_color == "luminance")
        check("false_color", "luminance", find_setting("tone_map")->formats); // other files hold irradiance
}

/// Refuses a picture that a film file, which is the value of the setting, does not hold whole.
void check_film_file(const PictureOptions& options, const std::string& setting, const std::string& output,
                     bool has_frames) {
    if (has_frames) {
        refuse(setting, output, "a film file holds one picture; `continue` resumes a sequence");
    }
    if (std::ranges::count(options.aovs, "motion") > 0) refuse("aov", "motion", "film files do not store this layer");
    check_writable(output);
}

} // namespace

bool is_film_name(const std::string& output) { return lower_case_extension(output) == ".pvf"; }

bool writes_films(std::span<const std::string> outputs) { return std::ranges::any_of(outputs, is_film_name); }

bool writes_tone_mapped(std::span<const std::string> outputs) {
    return std::ranges::any_of(outputs, [](const std::string& output) {
        if (is_film_name(output)) return false;
        const ImageFormat format = image_format_for(output);
        return format == ImageFormat::Png || format == ImageFormat::Jpeg;
    });
}

void note_number_signs(const std::string& output, Sink& sink) {
    if (!names_frames(output)) return;
    sink.note(
        {"output", output,
         "# and {name} are replaced only with `frames`, `turntable`, `cameras` or `stereo`; here they stay in the "
         "file's name"});
}

void check_outputs(const PictureOptions& options, std::span<const std::string> outputs, Sink& sink) {
    const std::optional<FrameRange> frames = frame_range(options);
    PictureSize size = options.size.value_or(PictureSize{1280, 720}); // without one it is small enough, too
    if (const auto crop = parse_crop(options)) size = {crop->width, crop->height};
    uint32_t written = 0;
    for (const std::string& output : outputs) {
        if (frames && !names_frames(output)) {
            refuse("output", output,
                   "each frame needs a file of its own; a run of # in the name, as in frame-####.png, is the frame's "
                   "number, and {name} that of its camera");
        }
        if (is_film_name(output)) {
            check_film_file(options, "output", output, frames.has_value());
            written = ~0u;
            continue;
        }
        check_image_output(frames ? frame_file(output, frames->first, frames->names) : output, size.width, size.height);
        written |= bit_of(image_format_for(output));
        if (!frames) note_number_signs(output, sink);
    }
    if (!options.checkpoint.empty()) {
        if (options.real_time || options.keeps_history()) { // it keeps the history of frames
            check_writable(options.checkpoint);
        } else {
            check_film_file(options, "checkpoint", options.checkpoint, frames.has_value());
            written = ~0u;
        }
    }
    refuse_twins(outputs, frames);
    refuse_twins_of_kept(outputs, options);
    refuse_unshown(options, written);
    for (const std::string& output : outputs) {
        if (is_film_name(output)) continue;
        const bool keeps_alpha = (find_setting("transparent")->formats & bit_of(image_format_for(output))) != 0;
        if (!options.render.transparent || keeps_alpha) continue;
        Remark why("transparent", "", "this format has no alpha; the background becomes black");
        why.location = FileLocation{output};
        sink.warn(std::move(why));
    }
    if (!options.false_color.empty() && options.false_color_range.empty() && frames && writes_tone_mapped(outputs))
        refuse("false_color", options.false_color,
               "the frames of a sequence need the same scale; set `false_color_range`");
}

} // namespace pertev
