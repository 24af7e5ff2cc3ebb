#include "session/devices/device_names.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <ranges>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"

namespace pertev {
namespace {

constexpr std::size_t kLeastOfUuid = 8; // letters of GPU-8c4d

[[noreturn]] void refuse_name(const std::string& text, const std::string& reason) {
    throw Error(ErrorCode::BadInput, "device", text, reason);
}

std::vector<std::string> names_in(const std::string& text) {
    std::vector<std::string> names;
    for (const auto name : std::views::split(text, ',')) names.emplace_back(name.begin(), name.end());
    if (names.empty()) names.emplace_back(); // an empty text has no part
    return names;
}

std::optional<int> number_of_name(std::string_view text) {
    int number = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (fault != std::errc() || end != text.data() + text.size() || text.starts_with('-')) return std::nullopt;
    return number;
}

std::string list_of_gpus(std::span<const std::string> uuids) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < uuids.size(); ++i) names.push_back(fmt::format("cuda:{} ({})", i, uuids[i]));
    return names.empty() ? "this machine has no CUDA device" : fmt::format("there are {}", fmt::join(names, ", "));
}

int index_of_uuid(const std::string& text, const std::string& part, std::span<const std::string> uuids) {
    std::vector<int> found;
    const auto is_start = [&](const std::string& uuid) {
        return std::ranges::equal(
            part, std::string_view(uuid).substr(0, part.size()), {}, [](unsigned char c) { return std::tolower(c); },
            [](unsigned char c) { return std::tolower(c); });
    };
    for (std::size_t i = 0; i < uuids.size(); ++i) {
        if (is_start(uuids[i])) found.push_back(static_cast<int>(i));
    }
    if (part.size() < kLeastOfUuid || found.size() > 1) {
        refuse_name(text, fmt::format("{} is the start of more than one UUID; {}", part, list_of_gpus(uuids)));
    }
    if (found.empty()) refuse_name(text, fmt::format("there is no GPU {}; {}", part, list_of_gpus(uuids)));
    return found.front();
}

} // namespace

bool names_several_devices(const std::string& text) {
    return text.find(',') != std::string::npos || text == "cuda:all";
}

bool needs_list_of_devices(const std::string& text) {
    return text.find("GPU-") != std::string::npos || text.find("gpu-") != std::string::npos ||
           text.find("cuda:all") != std::string::npos;
}

std::vector<NamedDevice> parse_devices(const std::string& text, std::span<const std::string> uuids) {
    std::vector<NamedDevice> devices;
    const auto add_gpu = [&](int index) {
        const NamedDevice gpu = {true, index};
        if (std::ranges::find(devices, gpu) != devices.end()) {
            refuse_name(text, fmt::format("cuda:{} is named twice", index));
        }
        devices.push_back(gpu);
    };
    bool may_be_number = false; // the last name was cuda:N, so that the next may be a number alone
    for (const std::string& part : names_in(text)) {
        if (part == "cpu") {
            devices.push_back({});
            may_be_number = false;
        } else if (part == "cuda") {
            add_gpu(0);
            may_be_number = true;
        } else if (part == "cuda:all") {
            if (uuids.empty()) refuse_name(text, list_of_gpus(uuids));
            for (std::size_t i = 0; i < uuids.size(); ++i) add_gpu(static_cast<int>(i));
            may_be_number = false;
        } else if (part.starts_with("GPU-") || part.starts_with("gpu-")) {
            add_gpu(index_of_uuid(text, part, uuids));
            may_be_number = false;
        } else {
            const bool is_named = part.starts_with("cuda:");
            const auto number = number_of_name(is_named ? std::string_view(part).substr(5) : std::string_view(part));
            if (!number || (!is_named && !may_be_number)) {
                refuse_name(
                    text,
                    "expected auto, cpu, cuda, cuda:N with N a device's number, cuda:all, a GPU's UUID, or several "
                    "of these, as cuda:0,2");
            }
            if (!uuids.empty() && static_cast<std::size_t>(*number) >= uuids.size()) {
                refuse_name(text, fmt::format("there is no CUDA device {}; {}", *number, list_of_gpus(uuids)));
            }
            add_gpu(*number);
            may_be_number = true;
        }
    }
    return devices;
}

void refuse_several_devices(const std::string& text, const std::string& task) {
    if (!names_several_devices(text)) return;
    refuse_name(text, fmt::format("one device is needed for {}; several render pictures together", task));
}

std::string text_of_devices(std::span<const std::string> names) {
    std::vector<std::pair<std::string, int>> kinds;
    for (const std::string& name : names) {
        const auto known = std::ranges::find(kinds, name, &std::pair<std::string, int>::first);
        if (known != kinds.end()) {
            ++known->second;
        } else {
            kinds.emplace_back(name, 1);
        }
    }
    std::vector<std::string> texts;
    for (const auto& [name, count] : kinds) texts.push_back(count > 1 ? fmt::format("{} x {}", count, name) : name);
    return fmt::format("{}", fmt::join(texts, " + "));
}

} // namespace pertev
