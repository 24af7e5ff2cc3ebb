#include "apps/viewer/file_name.h"

namespace pertev {

std::string file_name(const std::string& path) {
    const std::size_t slash = path.find_last_of('/');
    return slash == std::string::npos || slash + 1 == path.size() ? path : path.substr(slash + 1);
}

std::string without_folder(std::string message, const std::string& path) {
    const std::string folder = path.substr(0, path.size() - file_name(path).size());
    if (folder.empty()) return message;
    for (std::size_t at = message.find(folder); at != std::string::npos; at = message.find(folder, at)) {
        message.erase(at, folder.size());
    }
    return message;
}

} // namespace pertev
