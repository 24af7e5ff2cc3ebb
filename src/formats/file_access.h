#pragma once

// Which files a scene may read: those under its own folder, and under each folder that the user allowed. A scene file
// from a stranger must not be able to read (and show in a picture) anything else.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/messages.h"

namespace pertev {

class FileAccess {
public:
    /// `scene_file`: the file named by the user. `allowed`: further folders (--allow-path).
    FileAccess(const std::filesystem::path& scene_file, const std::vector<std::filesystem::path>& allowed);

    /// The path of `reference`, as written in `from` (a file of the scene; only its folder counts, so that `:LINE` may
    /// follow for the messages), after symbolic links, `..` and backslashes are resolved. Throws Error(BadInput) that
    /// names `from` and --allow-path when it leads outside. The file need not exist.
    std::filesystem::path resolve(const std::filesystem::path& from, const std::string& reference) const;

    /// As resolve, for a file that is read: where there is none of that path that may be read but one of that name
    /// beside `from`, that one (exporters write paths of the machine they ran on), with a warning where the path leads
    /// outside. Nothing where there is neither.
    std::optional<std::filesystem::path> find(const std::filesystem::path& from, const std::string& reference,
                                              Messages& messages) const;

private:
    bool is_allowed(const std::filesystem::path& canonical) const;

    std::vector<std::filesystem::path> roots_; // canonical
};

} // namespace pertev
