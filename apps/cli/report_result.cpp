#include "apps/cli/report_result.h"

#include <sys/resource.h>

#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "base/machine_memory.h"
#include "base/message_text.h"
#include "image/tone_map_image.h"
#include "session/writing/metadata_json.h"

namespace pertev {
uint64_t peak_memory_bytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

void report_camera(const CameraSource& camera, Reporter& reporter) {
    std::string object = R"({"event":"camera")";
    for (const auto& entry : camera_metadata(camera)) {
        object += fmt::format(",{}:{}", json_string(entry.first.substr(std::string_view("pertev.").size())),
                              metadata_json(entry));
    }
    reporter.event(object + '}');
}

void report_display(const Display& display, bool is_metered, Reporter& reporter) {
    if (!display.false_colors) {
        reporter.event(fmt::format(R"({{"event":"exposure","stops":{},"auto":{},"tone_map":"{}"}})",
                                   json_number(static_cast<double>(display.exposure_stops)), is_metered,
                                   name_of(display.tone_map)));
    }
    reporter.report_messages();
}

void report_files(const WrittenPicture& written, Reporter& reporter) {
    for (const WrittenFile& file : written.files) reporter.output(file.path, file.failure);
}

std::string hashes_json(const WrittenPicture& written) {
    const auto or_null = [](const std::string& hash) { return hash.empty() ? "null" : json_string(hash); };
    return fmt::format(R"("hash":"{}","layers_hash":{},"denoised_hash":{})", written.hash, or_null(written.layers_hash),
                       or_null(written.denoised_hash));
}

void report_result(const RenderResult& result, uint64_t pixels, const WrittenPicture& written, const Queue& queue,
                   const std::string& device, double total_seconds, bool interrupted, Reporter& reporter) {
    const double samples = static_cast<double>(pixels) * result.samples;
    const double samples_per_second = samples > 0 ? samples / result.render_seconds : std::nan(""); // JSON: null
    const double rays_per_second = static_cast<double>(result.rays.total()) / result.render_seconds;
    const double frame_seconds = result.render_seconds / result.samples; // one sample of every pixel
    const uint64_t host_bytes = peak_memory_bytes();
    if (result.samples == 0) reporter.print("this part has no samples");
    const std::string rates =
        result.samples == 0
            ? ""
            : fmt::format(" {:.4g} s per frame of 1 spp ({:.4g} frames/s), {:.2f} Msamples/s, {:.1f} Mrays/s,",
                          frame_seconds, 1 / frame_seconds, samples_per_second * 1e-6, rays_per_second * 1e-6);
    reporter.print(fmt::format(
        "{} spp in {:.2f} s ({:.2f} s in total),{} peak {:.0f} MiB{}, {}, picture {}{}", result.samples,
        result.render_seconds, total_seconds, rates, mebibytes(host_bytes),
        queue.is_cuda() ? fmt::format(" and {:.0f} MiB on the GPU", mebibytes(result.device_peak_bytes)) : "",
        counted(result.invalid_samples, "invalid sample"), written.hash,
        result.denoised ? fmt::format(" (before denoising; the files are denoised{}{})",
                                      result.denoiser.empty() ? "" : " by ", result.denoiser)
                        : ""));
    reporter.result(fmt::format(
        R"({{"event":"done","samples":{},"seconds":{:.6f},"total_seconds":{:.6f},"frames":{},"seconds_per_frame":{},"samples_per_second":{},"rays_per_second":{},"peak_bytes":{},"device_peak_bytes":{},"invalid_samples":{},{},"device":{},"interrupted":{}}})",
        result.samples, result.render_seconds, total_seconds, result.samples, json_number(frame_seconds),
        json_number(samples_per_second), json_number(rays_per_second), host_bytes, result.device_peak_bytes,
        result.invalid_samples, hashes_json(written), json_string(device), interrupted));
}

} // namespace pertev
