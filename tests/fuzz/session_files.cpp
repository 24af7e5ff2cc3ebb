// Fuzz targets of files that sessions write and read: films, histories, and settings as JSON, whose values are refused
// by an Error or are kept by files made of them.

#include <array>
#include <string_view>

#include "settings/settings_file.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/scene_text.h"

namespace pertev {
namespace {

constexpr std::array<std::string_view, 2> kSettings = {
    R"({"version":1,"scene":{"name":"cornell-box","hash":""},"settings":{"size":"64x48","spp":4,"seed":7,"integrator":"path","max_depth":3,"fov":40,"eye":[0,1,2],"exposure":"auto","tone_map":"agx","denoise":"svgf"}})",
    R"({"version":1,"settings":{"crop":[1,2,3,4],"light_group":["a=b"],"filter":"gaussian","filter_radius":1.5,"clamp":10,"shutter":[0,0.5],"environment":"a.hdr","lens":"fisheye","frames":"1-3"}})"};

std::vector<std::byte> settings_seed(uint32_t kind) { return bytes_of_text(kSettings[kind % kSettings.size()]); }

bool read_settings_input(std::span<const std::byte> input) {
    static const std::filesystem::path path = input_path("settings", "settings.json");
    write_bytes(path, input);
    return reads([&] {
        PictureOptions options;
        read_settings(path, kRender, {}, options, nobody());
        const std::string once = settings_json(options, "");
        write_bytes(path, bytes_of_text(once));
        PictureOptions again;
        read_settings(path, kRender, {}, again, nobody());
        if (settings_json(again, "") != once) std::abort();
        return true;
    });
}

} // namespace

std::span<const FuzzTarget> fuzz_targets() {
    static const FuzzTarget targets[] = {{"film", 12, film_seed, read_film_input},
                                         {"history", 4, history_seed, read_history_input},
                                         {"settings", 2, settings_seed, read_settings_input}};
    return targets;
}

} // namespace pertev
