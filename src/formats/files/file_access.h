#pragma once

// Which files a scene may read: those under its own folder, and under each folder that the user allowed. A scene file
// from a stranger must not be able to read (and show in a picture) anything else.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/messages.h"
#include "formats/files/list_folders.h"

namespace pertev {

class FileAccess {
public:
    /// `scene_file`: the file named by the user. `allowed`: further folders (`allow_path`).
    FileAccess(const std::filesystem::path& scene_file, const std::vector<std::filesystem::path>& allowed);

    /// The path of `reference`, as written at `from` (a place in a file of the scene, whose folder counts), after
    /// symbolic links, `..` and backslashes are resolved. Throws Error(BadInput) that names `from` and `allow_path`
    /// when it leads outside. The file need not exist.
    std::filesystem::path resolve(const Place& from, const std::string& reference) const;

    /// The file that `reference` means, for a file that is read. Where none of that path may be read it is the file
    /// below the folder of `from` or below a folder that may be read whose path ends like `reference`, without regard
    /// to the case of A to Z, if one file alone fits best: exporters write paths of the machine that they ran on. A
    /// warning tells it. Returns nothing where no file fits, and after a warning where several do. Throws
    /// Error(BadInput), which names `allow_path`, where there is such a file outside alone.
    std::optional<std::filesystem::path> find(const Place& from, const std::string& reference,
                                              Messages& messages) const;

private:
    struct Located {
        bool is_there, is_allowed;
        std::filesystem::path path;
    };
    bool is_allowed(const std::filesystem::path& canonical) const;
    Located locate(const std::filesystem::path& name) const;
    std::optional<std::filesystem::path> find_end_of(const std::filesystem::path& name, const Place& from,
                                                     Messages& messages) const;

    std::vector<std::filesystem::path> roots_; // canonical
    std::shared_ptr<FolderListing> listing_;   // of roots_
};

} // namespace pertev
