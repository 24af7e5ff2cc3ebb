#include "apps/viewer/file_name.h"

#include <filesystem>
#include <string_view>
#include <system_error>

namespace fs = std::filesystem;

namespace pertev {
namespace {

/// Returns whether a path may begin at `at`, because no word continues there.
bool is_beginning(const std::string& text, std::size_t at) {
    constexpr std::string_view before = " \t\"'`=:;,([{<";
    return at == 0 || before.find(text[at - 1]) != before.npos;
}

void erase_all(const std::string& folder, std::string& message) {
    if (folder.empty() || folder == "/") return;
    for (std::size_t at = message.find(folder); at != std::string::npos; at = message.find(folder, at)) {
        if (is_beginning(message, at)) {
            message.erase(at, folder.size());
        } else {
            ++at;
        }
    }
}

bool is_folder(const std::string& path) {
    std::error_code fault;
    return fs::is_directory(path, fault);
}

/// Returns the length of the existing folders at the start of the path `rest`, with the last slash. It is 0
/// for text that only resembles a path, such as the JSON pointer /nodes/3.
std::size_t folders_size(std::string_view rest) {
    std::size_t size = 0;
    for (std::size_t slash = rest.find('/'); slash != rest.npos; slash = rest.find('/', slash + 1)) {
        if (slash > 0 && !is_folder(std::string(rest.substr(0, slash)))) break;
        size = slash + 1;
    }
    return size > 1 ? size : 0; // JSON pointers begin with the slash of the root
}

/// Returns whether the text begins with a folder below the root, such as /home.
bool is_below_root(std::string_view rest) {
    constexpr std::string_view ends = " \t\"'`:;,()";
    return rest.starts_with('/') && is_folder(std::string(rest.substr(0, rest.find_first_of(ends))));
}

/// Folder of a path, with its trailing slash; empty if it has none.
std::string folder_of(const std::string& path) { return path.substr(0, path.size() - file_name(path).size()); }

} // namespace

std::string file_name(const std::string& path) {
    const std::size_t slash = path.find_last_of('/');
    return slash == std::string::npos || slash + 1 == path.size() ? path : path.substr(slash + 1);
}

std::string without_folders(std::string message, const std::string& scene) {
    // Readers have names as they were typed, and canonical ones.
    std::error_code fault;
    const std::string canonical = fs::weakly_canonical(scene, fault).string();
    const std::string absolute = fs::absolute(scene, fault).string();
    for (const std::string& path : {canonical, absolute, scene}) {
        const std::string folder = folder_of(path);
        erase_all(folder, message);
        if (!folder.empty()) erase_all(folder_of(folder.substr(0, folder.size() - 1)), message); // it is named itself
    }
    for (std::size_t at = 0; at < message.size(); ++at) {
        // A path that begins with another letter is relative to a file of the scene.
        if ((message[at] != '/' && message[at] != '.') || !is_beginning(message, at)) continue;
        const std::string_view rest = std::string_view(message).substr(at);
        message.erase(at, folders_size(rest));
        if (is_below_root(std::string_view(message).substr(at))) message.erase(at, 1);
    }
    return message;
}

} // namespace pertev
