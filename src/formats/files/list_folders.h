#pragma once

// Finds files below some folders whose path ends like a name from another machine. Exporters write the paths of the
// machine on which they ran, and authors with a case-insensitive file system do not notice `Wood.PNG` for `wood.png`.
// The folders are listed once, when a file is missing, up to a limit.

#include <cstddef>
#include <filesystem>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

namespace pertev {

class FolderListing {
public:
    /// `folders` must be canonical.
    explicit FolderListing(std::vector<std::filesystem::path> folders) : folders_(std::move(folders)) {}

    /// Returns the files below `folder`, or for an empty `folder` below all folders, that fit `name` best: their last
    /// components equal those of `name`, ignoring the case of A to Z, as many as possible and at least the file's
    /// name. Of equally many, a path directly below the folder comes first, then one in the same case. Several files
    /// mean that none fits better than the others. Symbolic links to folders are not followed, and names that begin
    /// with a dot are skipped.
    std::vector<std::filesystem::path> best_fits(const std::filesystem::path& name,
                                                 const std::filesystem::path& folder);

    /// Counts a message about one file, so that a scene of a thousand files does not write a thousand messages.
    /// Returns whether the limit has not been reached.
    bool may_name_another();

private:
    struct File {
        std::filesystem::path path;
        std::size_t folder_size; // number of components of the folder in `folders_` that contains it
    };
    void list();
    void list_level(std::vector<std::filesystem::path>& level, std::size_t folder_size);

    std::vector<std::filesystem::path> folders_;
    std::mutex mutex_;
    bool is_listed_ = false;
    std::size_t entries_ = 0;
    std::vector<File> files_;
    std::unordered_map<std::string, std::vector<std::size_t>> by_name_; // indices of files by lower-case name
    std::size_t named_ = 0;
};

/// The components of a path from another machine, which may begin with a drive, a root or `..`, that can stand below
/// a folder here.
std::vector<std::string> components_below(const std::filesystem::path& name);

} // namespace pertev
