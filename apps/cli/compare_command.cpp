// pertev compare A B: how far picture A is from reference B.

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/reporter.h"
#include "image/flip.h"
#include "image/metrics.h"
#include "image/picture_hash.h"
#include "image/read_image.h"

namespace pertev {
namespace {

struct CompareFlags {
    std::string picture, reference;
    uint32_t blocks = 1;
    ReportFlags report;
};

std::string json_triple(const double (&values)[3]) {
    return fmt::format("[{},{},{}]", json_number(values[0]), json_number(values[1]), json_number(values[2]));
}

/// The picture's R, G and B.
Image without_alpha(const Image& picture) {
    Image colors{picture.width, picture.height, 3, {}};
    colors.pixels.reserve(picture.pixels.size() / picture.channels * 3);
    for (std::size_t i = 0; i < picture.pixels.size(); i += picture.channels) {
        colors.pixels.insert(colors.pixels.end(), &picture.pixels[i], &picture.pixels[i] + 3);
    }
    return colors;
}

int compare(const CompareFlags& flags) {
    Reporter reporter(flags.report);
    Image a = read_image(flags.picture, reporter), b = read_image(flags.reference, reporter);
    reporter.report_messages();
    check_comparable(a, b);
    const Hash128 hash_a = picture_hash(a), hash_b = picture_hash(b);
    const bool equal = hash_a == hash_b;
    const bool equal_colors = equal || picture_hash(without_alpha(a)) == picture_hash(without_alpha(b));
    if (flags.blocks > 1) {
        a = block_means(a, flags.blocks);
        b = block_means(b, flags.blocks);
    }
    const double rel_mse = relative_error(a, b, 1.0).rel_mse;
    const TrimmedError trimmed = relative_error(a, b);
    const double mse = mean_squared_error(a, b), flip_mean = flip(a, b).mean, hdr_flip_mean = hdr_flip(a, b).mean;
    reporter.event(fmt::format(
        R"({{"event":"compare","rel_mse":{},"rel_mse_98":{},"mean_98":{},"reference_mean_98":{},"mse":{},"flip":{},"hdr_flip":{},"equal":{},"equal_colors":{},"hash_a":"{}","hash_b":"{}"}})",
        json_number(rel_mse), json_number(trimmed.rel_mse), json_triple(trimmed.mean),
        json_triple(trimmed.reference_mean), json_number(mse), json_number(flip_mean), json_number(hdr_flip_mean),
        equal, equal_colors, hash_a.hex(), hash_b.hex()));
    reporter.answer(fmt::format("relMSE            {:.6g}\nrelMSE best 98 %  {:.6g}\nMSE               {:.6g}\n"
                                "FLIP              {:.6g}\nHDR-FLIP          {:.6g}\n"
                                "hash A            {}\nhash B            {}\n{}\n",
                                rel_mse, trimmed.rel_mse, mse, flip_mean, hdr_flip_mean, hash_a.hex(), hash_b.hex(),
                                equal          ? "equal to the last bit"
                                : equal_colors ? "equal colours to the last bit, different alpha"
                                               : "different"));
    return 0;
}

} // namespace

void add_compare_command(CLI::App& app, int& status) {
    CLI::App& verb = *app.add_subcommand("compare", "Compare a picture with a reference: relMSE, FLIP, hash");
    const auto flags = std::make_shared<CompareFlags>();
    verb.add_option("A", flags->picture, "the picture: .exr .hdr .png .jpg")
        ->type_name("")
        ->check(file_name())
        ->required();
    verb.add_option("B", flags->reference, "the reference")->type_name("")->check(file_name())->required();
    add_whole(verb, "--blocks", flags->blocks, "compares means over blocks of N x N pixels, which have less noise", 1,
              4096)
        ->capture_default_str();
    add_report_flags(verb, flags->report);
    verb.callback([flags, &status] { status = compare(*flags); });
}

} // namespace pertev
