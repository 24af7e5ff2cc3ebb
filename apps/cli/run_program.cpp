// The command line as a whole: flags of the program itself, and errors of any verb.

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <new>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/commands.h"
#include "apps/cli/describe_usage_error.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/help.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/report_error.h"
#include "base/error.h"
#include "base/version.h"

namespace pertev {
namespace {

/// Opens /dev/null for a closed stdin, stdout or stderr. Otherwise the first opened file would get its number and thus
/// the terminal's output.
void open_standard_files() {
    for (int fd = 0; fd <= STDERR_FILENO; ++fd) {
        if (::fcntl(fd, F_GETFD) < 0 && ::open("/dev/null", O_RDWR) < 0) std::_Exit(exit_status(ErrorCode::FileWrite));
    }
}

/// Makes writes fail, instead of ending the process, if a pipe's reader has gone or a file is over its limit.
void turn_signals_into_errors() {
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
}

/// Returns whether CLI11 takes the value of a flag as false, case-insensitively.
bool is_no(std::string_view value) {
    std::string small(value);
    std::ranges::transform(small, small.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
    constexpr std::string_view kNo[] = {"false", "off", "no", "disable", "0", "f", "n", "-"};
    return std::ranges::find(kNo, small) != std::end(kNo);
}

/// Returns whether errors must be JSON. The line may be wrong, so that no verb has read it.
bool wants_json(int argc, char** argv) {
    bool json = false; // the last such flag counts, as for the verb
    for (int i = 1; i < argc; ++i) {
        const std::string_view word = argv[i];
        if (word == "--") break; // only positional words follow
        if (word == "--json") json = true;
        if (word.starts_with("--json=")) json = !is_no(word.substr(std::string_view("--json=").size()));
    }
    return json;
}

/// Turns `help VERB` into `VERB --help`. Without a verb of this name the line is not understood.
void spell_out_help(const CLI::App& app, std::vector<std::string>& words) {
    if (words.empty() || words[0] != "help") return;
    words.erase(words.begin());
    std::vector<const CLI::App*> verb = {&app};
    for (const std::string& word : words) {
        if (verb.empty()) return;
        verb = verb.front()->get_subcommands([&](const CLI::App* below) { return below->get_name() == word; });
    }
    if (!verb.empty()) words.emplace_back("--help");
}

/// Writes documents generated from the flags, or the list of devices, if the line requests them.
bool write_document(const CLI::App& app, const std::vector<std::string>& words) {
    if (words.empty()) return false;
    if (words[0] == "--man")
        std::cout << man_page(app);
    else if (words[0] == "--settings-document")
        std::cout << settings_document();
    else if (words[0] == "--list-devices")
        std::cout << list_devices();
    else if (words[0] == "--completion" && words.size() > 1)
        std::cout << completion(app, words[1]);
    else
        return false;
    return true;
}

struct Verb {
    std::string_view name;
    void (*add)(CLI::App& app, int& status);
};
constexpr Verb kVerbs[] = {
    {"render", add_render_command},   {"merge", add_merge_command},     {"view", add_view_command},
    {"compare", add_compare_command}, {"measure", add_measure_command}, {"solve", add_solve_command},
    {"info", add_info_command},       {"check", add_check_command},     {"convert", add_convert_command},
    {"bench", add_bench_command},     {"lab", add_lab_command}};

/// Adds only the verb that begins the line, if one does: adding all flags takes as long as a small picture.
void add_verbs(CLI::App& app, const std::vector<std::string>& words, int& status) {
    const std::string_view first = words.empty() ? std::string_view() : std::string_view(words.front());
    const bool is_named = std::ranges::find(kVerbs, first, &Verb::name) != std::end(kVerbs);
    for (const Verb& verb : kVerbs) {
        if (!is_named || verb.name == first) verb.add(app, status);
    }
}

/// Parses the command line, which runs its verb.
int run(std::vector<std::string> words, bool json) {
    CLI::App app("Pertev: a path tracer for GPUs without ray-tracing hardware, and for CPUs.", "pertev");
    int status = 0;
    try {
        app.set_help_flag("-h,--help", "Prints this help.");
        app.set_version_flag("-V,--version", fmt::format("pertev {} ({})", version(), git_commit()),
                             "Prints the version.");
        app.formatter(std::make_shared<Help>(take_help_group(words)));
        app.require_subcommand(1);
        add_verbs(app, words, status);
        app.add_flag("--list-devices")->description("Lists the devices that --device names, with their memory.");
        app.add_flag("--man")->description("Prints a man page.");
        app.add_flag("--settings-document")->description("Prints docs/settings.md.");
        app.add_option("--completion")
            ->description("Prints a completion script for this shell.")
            ->type_name("bash|zsh|fish")
            ->check(one_of({"bash", "zsh", "fish"}));
        if (write_document(app, words)) return 0;
        spell_out_help(app, words);
        std::ranges::reverse(words); // the order that CLI11 expects
        app.parse(std::move(words));
        return status;
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error); // help or version
        const UsageError usage = describe_usage_error(app, error);
        return report_error(json, ErrorCode::BadInput, usage.remark, usage.help);
    } catch (const Error& error) {
        return report_error(json, error.code(), error.remark());
    } catch (const std::bad_alloc&) {
        return report_error(json, ErrorCode::OutOfMemory, "out of memory on this machine");
    } catch (const std::filesystem::filesystem_error& error) {
        return report_error(json, ErrorCode::BadInput,
                            fmt::format("{}: {}", error.path1().string(), error.code().message()));
    } catch (const std::exception& error) {
        return report_error(json, ErrorCode::DeviceFault,
                            fmt::format("internal error of pertev, please report it: {}", error.what()));
    }
}

/// Returns whether the standard output is a pipe whose reader has gone, as `head` does once it has its lines.
bool is_reader_gone() {
    pollfd out = {STDOUT_FILENO, POLLOUT, 0};
    return ::poll(&out, 1, 0) == 1 && (out.revents & (POLLERR | POLLHUP)) != 0;
}

} // namespace

int run_program(int argc, char** argv) {
    const bool json = wants_json(argc, argv);
    open_standard_files();
    turn_signals_into_errors();
    end_at_interrupt(json);
    const int status = run({argv + 1, argv + argc}, json);
    std::cout.flush(); // CLI11 writes help and version there
    if (!std::cout || std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
        if (is_reader_gone()) return status; // it has all that it wanted
        return std::max(status, report_error(false, ErrorCode::FileWrite, "cannot write to the standard output"));
    }
    return status;
}

} // namespace pertev
