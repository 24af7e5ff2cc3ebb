// pertev merge PART... -o OUT: one picture of the film files of its parts.

#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/report_result.h"
#include "base/message_text.h"
#include "base/stopwatch.h"
#include "session/film_file/merge_films.h"
#include "session/writing/check_outputs.h"

namespace pertev {
namespace {

struct MergeFlags {
    std::vector<std::string> parts, outputs;
    bool is_partial = false;
    ReportFlags report;
};

void refuse_film_with_gaps(const std::vector<std::string>& outputs) {
    const auto film = std::ranges::find_if(outputs, is_film_name);
    if (film == outputs.end()) return;
    throw Error(ErrorCode::BadInput, "output", *film, "a film file holds no samples with gaps between them");
}

int merge(const MergeFlags& flags) {
    Reporter reporter(flags.report);
    const Stopwatch watch;
    for (const std::string& output : flags.outputs) refuse_list(output);
    check_outputs({}, flags.outputs, reporter);
    const FilmMerge parts(flags.parts, flags.is_partial);
    if (parts.has_gaps()) refuse_film_with_gaps(flags.outputs);
    reporter.set_work("merging");
    Queue queue = Queue::make_cpu();
    RenderResult result;
    std::vector<WrittenFile> films;
    {
        const Film film = parts.film(queue, reporter);
        result = result_of(parts.header(), film);
        films = write_film_files(flags.outputs, parts.header(), film);
    } // writing takes memory too
    reporter.end_progress();
    reporter.set_work("writing");
    PictureFacts facts = parts.header().facts;
    if (!writes_tone_mapped(flags.outputs)) facts.shown.clear(); // which only film files have
    WrittenPicture written = write_picture(flags.outputs, facts, result);
    written.files.insert(written.files.end(), films.begin(), films.end());
    report_files(written, reporter);
    reporter.print(fmt::format("{} spp of {} in {:.2f} s, {}, picture {}", result.samples,
                               counted(flags.parts.size(), "part"), watch.seconds(),
                               counted(result.invalid_samples, "invalid sample"), written.hash));
    reporter.result(fmt::format(
        R"({{"event":"done","parts":{},"samples":{},"total_seconds":{:.6f},"peak_bytes":{},"invalid_samples":{},{}}})",
        flags.parts.size(), result.samples, watch.seconds(), peak_memory_bytes(), result.invalid_samples,
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
                  "Makes a picture of the samples that are there, if some are missing.");
    add_report_flags(verb, flags->report);
    verb.callback([flags, &status] { status = merge(*flags); });
}

} // namespace pertev
