#pragma once

// The devices that the setting `device` names: auto, cpu, cuda, cuda:N, cuda:all, cuda:0,2, a GPU's UUID or the start
// of it, or several of these, separated by commas.

#include <span>
#include <string>
#include <vector>

namespace pertev {

struct NamedDevice {
    bool is_cuda = false;
    int index = 0; // the CUDA device's
    bool operator==(const NamedDevice&) const = default;
};

/// Returns whether the text may name more than one device; how many they are depends on the machine for cuda:all.
bool names_several_devices(const std::string& text);
/// Returns whether the text can be understood only with the machine's list of GPUs.
bool needs_list_of_devices(const std::string& text);

/// Returns the devices that the text names, in its order, on a machine whose CUDA devices have these UUIDs. The CPU may
/// be named several times, and then its threads are shared out. Throws Error(BadInput) for what is no name of a device,
/// for a device that is not there, with those that are, and for a GPU that is named twice.
std::vector<NamedDevice> parse_devices(const std::string& text, std::span<const std::string> uuids);

/// Throws Error(BadInput) if the text may name several devices, for a task that only one can do. `one` is the name of
/// a setting, or other text in a sentence: "`frames`".
void refuse_several_devices(const std::string& text, const std::string& task);

/// Returns the names of devices with how many there are of each: "2 x NVIDIA H100 80GB HBM3".
std::string text_of_devices(std::span<const std::string> names);

} // namespace pertev
