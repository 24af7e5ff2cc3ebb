// pertev compare A B: how far picture A is from reference B.

#include <iterator>
#include <map>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/reporter.h"
#include "base/file_extension.h"
#include "image/flip.h"
#include "image/metrics.h"
#include "image/picture_hash.h"
#include "image/read_exr.h"
#include "image/read_image.h"
#include "image/significance.h"
#include "image/write_image.h"

namespace pertev {
namespace {

struct CompareFlags {
    std::string picture, reference;
    uint32_t blocks = 1;
    std::string difference;          // a file; empty: none
    std::string metric = "rel_mse";  // one of kMetrics
    std::optional<double> threshold; // none: every difference is within it
    ReportFlags report;
};

constexpr const char* kMetrics[] = {"rel_mse", "rel_mse_98", "mse", "mape", "smape", "flip", "hdr_flip", "p_value"};

/// The numbers by which pictures are judged, by their names in JSON.
using Metrics = std::map<std::string, double>;

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

/// Returns the layer `variance` of an EXR that has the picture's size; nothing for other files.
std::optional<Image> variance_in(const std::string& file, const Image& picture) {
    if (lower_case_extension(file) != ".exr") return std::nullopt;
    const ExrFile exr = read_exr(file);
    Image variance = {picture.width, picture.height, 3, {}};
    variance.pixels.resize(std::size_t(picture.width) * picture.height * 3);
    for (std::size_t c = 0; c < 3; ++c) {
        const ExrChannel* const channel = exr.find(std::string("variance.") + "RGB"[c]);
        const auto* const values = channel != nullptr ? std::get_if<std::vector<float>>(&channel->values) : nullptr;
        if (values == nullptr || 3 * values->size() != variance.pixels.size()) return std::nullopt;
        for (std::size_t i = 0; i < values->size(); ++i) variance.pixels[3 * i + c] = (*values)[i];
    }
    return variance;
}

/// Returns the p-values of the pictures of two files; nothing unless both have variances.
std::optional<Image> p_values_of(const CompareFlags& flags, const Image& a, const Image& b) {
    if (flags.blocks > 1) return std::nullopt;
    const std::optional<Image> of_a = variance_in(flags.picture, a), of_b = variance_in(flags.reference, b);
    return of_a && of_b ? std::optional(p_values(a, *of_a, b, *of_b)) : std::nullopt;
}

/// Writes A - B, with the p-values as a layer. PNG and JPEG have the absolute differences in sRGB.
void write_difference(const std::string& file, const Image& a, const Image& b, const std::optional<Image>& p) {
    const bool is_signed = image_format_for(file) == ImageFormat::Exr;
    Image difference = {a.width, a.height, 3, {}};
    const std::size_t pixels = std::size_t(a.width) * a.height;
    difference.pixels.reserve(3 * pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const float x = a.pixels[i * a.channels + c] - b.pixels[i * b.channels + c];
            difference.pixels.push_back(is_signed ? x : abs(x));
        }
    }
    std::vector<ExrLayer> layers;
    if (p) layers.push_back({"p_value", {"R", "G", "B"}, p->pixels});
    write_image(file, difference, {.layers = layers});
}

/// Returns whether the metric is no worse than the threshold: no larger, or of p-values no smaller.
bool is_within(const CompareFlags& flags, const Metrics& metrics) {
    const auto metric = metrics.find(flags.metric);
    refuse(metric == metrics.end(),
           {"metric", flags.metric, "needs the layer `aov=variance` in both files, and no `blocks`"});
    const double value = metric->second;
    return flags.metric == "p_value" ? value >= *flags.threshold : value <= *flags.threshold;
}

int compare(const CompareFlags& flags) {
    Reporter reporter(flags.report);
    if (!flags.difference.empty()) check_image_output(flags.difference, 1, 1);
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
    const std::optional<Image> p = p_values_of(flags, a, b);
    const TrimmedError trimmed = relative_error(a, b);
    Metrics metrics = {{"rel_mse", relative_error(a, b, 1.0).rel_mse},
                       {"rel_mse_98", trimmed.rel_mse},
                       {"mse", mean_squared_error(a, b)},
                       {"mape", mean_absolute_percentage_error(a, b)},
                       {"smape", symmetric_percentage_error(a, b)},
                       {"flip", flip(a, b).mean},
                       {"hdr_flip", hdr_flip(a, b).mean}};
    const Significance significance = p ? significance_of(*p) : Significance{};
    if (p) metrics["p_value"] = significance.p;
    const bool within = !flags.threshold || is_within(flags, metrics);
    if (!flags.difference.empty()) write_difference(flags.difference, a, b, p);
    reporter.event(fmt::format(
        R"({{"event":"compare","rel_mse":{},"rel_mse_98":{},"mean_98":{},"reference_mean_98":{},"mse":{},"mape":{},"smape":{},"flip":{},"hdr_flip":{},"p_value":{},"p_below":{},"within":{},"equal":{},"equal_colors":{},"hash_a":"{}","hash_b":"{}"}})",
        json_number(metrics["rel_mse"]), json_number(trimmed.rel_mse), json_triple(trimmed.mean),
        json_triple(trimmed.reference_mean), json_number(metrics["mse"]), json_number(metrics["mape"]),
        json_number(metrics["smape"]), json_number(metrics["flip"]), json_number(metrics["hdr_flip"]),
        p ? json_number(significance.p) : "null", p ? json_number(significance.share_below) : "null",
        flags.threshold ? (within ? "true" : "false") : "null", equal, equal_colors, hash_a.hex(), hash_b.hex()));
    const std::string of_p = p ? fmt::format("p-value           {:.6g}\np below 0.01      {:.4g} %\n", significance.p,
                                             100 * significance.share_below)
                               : "";
    reporter.answer(fmt::format("relMSE            {:.6g}\nrelMSE best 98 %  {:.6g}\nMSE               "
                                "{:.6g}\n"
                                "MAPE              {:.6g}\nSMAPE             {:.6g}\n"
                                "FLIP              {:.6g}\nHDR-FLIP          {:.6g}\n{}"
                                "hash A            {}\nhash B            {}\n{}\n",
                                metrics["rel_mse"], trimmed.rel_mse, metrics["mse"], metrics["mape"], metrics["smape"],
                                metrics["flip"], metrics["hdr_flip"], of_p, hash_a.hex(), hash_b.hex(),
                                equal          ? "equal to the last bit"
                                : equal_colors ? "equal colours to the last bit, different alpha"
                                               : "different"));
    if (within) return 0;
    reporter.print(fmt::format("{} is {:.6g}, {} the threshold {:.6g}", flags.metric, metrics[flags.metric],
                               flags.metric == "p_value" ? "below" : "above", *flags.threshold));
    return 1;
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
    verb.add_option("--difference", flags->difference,
                    "writes A - B, with p-values as a layer if both files have "
                    "the layer variance (EXR), or |A - B|")
        ->type_name("FILE")
        ->check(file_name());
    verb.add_option("--metric", flags->metric,
                    fmt::format("the number that --threshold judges: {}", fmt::join(kMetrics, ", ")))
        ->type_name("NAME")
        ->check(one_of({std::begin(kMetrics), std::end(kMetrics)}))
        ->capture_default_str();
    verb.add_option("--threshold", flags->threshold,
                    "ends with status 1 if the metric is above X; p_value, which is "
                    "of independent samples (--sampler independent), if below")
        ->type_name("X")
        ->check(number_from_zero());
    add_report_flags(verb, flags->report);
    verb.callback([flags, &status] { status = compare(*flags); });
}

} // namespace pertev
