// pertev merge PART... -o OUT: one picture of the film files of its parts.

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/report_result.h"
#include "apps/cli/setting_flags.h"
#include "base/message_text.h"
#include "base/stopwatch.h"
#include "session/pictures/merge_picture.h"

namespace pertev {
namespace {

struct MergeFlags {
    std::vector<std::string> parts, outputs;
    bool is_partial = false;
    SettingFlags settings;
    ReportFlags report;
};

int merge(MergeFlags& flags) {
    Reporter reporter(flags.report);
    const Stopwatch watch;
    for (const std::string& output : flags.outputs) refuse_list(output);
    PictureOptions options;
    flags.settings.read(options, reporter);
    name_standard_output(options.output_format, flags.report.json, flags.outputs);
    reporter.set_work("merging");
    MergedPicture picture = merge_picture(flags.parts, flags.is_partial, options, flags.outputs, reporter);
    RenderResult& result = picture.result;
    reporter.end_progress();
    reporter.report_messages();
    reporter.set_work("writing");
    WrittenPicture written = write_picture(flags.outputs, picture.facts, result);
    written.files.insert(written.files.end(), picture.films.begin(), picture.films.end());
    report_files(written, reporter);
    const uint32_t least = picture.least_samples;
    reporter.print(fmt::format("{}{} spp of {} in {:.2f} s, {}, picture {}",
                               least < result.samples ? fmt::format("{} to ", least) : "", result.samples,
                               counted(flags.parts.size(), "part"), watch.seconds(),
                               counted(result.invalid_samples, "invalid sample"), written.hash));
    reporter.result(fmt::format(
        R"({{"event":"done","parts":{},"samples":{},"least_samples":{},"total_seconds":{:.6f},"peak_bytes":{},"invalid_samples":{},{}}})",
        flags.parts.size(), result.samples, least, watch.seconds(), peak_memory_bytes(), result.invalid_samples,
        hashes_json(written)));
    refuse_faults(written, result.invalid_samples, false);
    return 0;
}

} // namespace

void add_merge_command(CLI::App& app, int& status) {
    CLI::App& verb = *app.add_subcommand("merge", "Merge the film files of a picture's parts");
    const auto flags = std::make_shared<MergeFlags>();
    verb.add_option("PART", flags->parts, "film files (.pvf) that pertev render wrote, in any order")
        ->type_name("")
        ->check(file_name())
        ->required();
    verb.add_option("-o,--output", flags->outputs,
                    "A file to write: .exr .png .jpg .hdr, or .pvf with all samples. It may be given again.")
        ->type_name("FILE")
        ->allow_extra_args(false)
        ->check(file_name())
        ->required();
    verb.add_flag("--partial", flags->is_partial,
                  "Makes a picture of the available samples if some are missing. Rows without any are black.");
    const std::string theirs = "that of the parts";
    flags->settings.add(verb, kMerge, {}, all_settings(),
                        {{"denoise", "the parts' denoiser; any other is refused"},
                         {"tone_map", theirs},
                         {"exposure", theirs + "; auto is what a meter found for them"}});
    add_report_flags(verb, flags->report);
    add_progress_flag(verb, flags->report);
    verb.callback([flags, &status] { status = merge(*flags); });
}

} // namespace pertev
