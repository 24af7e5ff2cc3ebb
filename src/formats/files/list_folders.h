#pragma once

// Finds files below some folders whose path ends like a name from another machine. Exporters write the paths of the
// machine that they ran on, and authors whose system does not tell `Wood.PNG` from `wood.png` do not notice the
// difference. The folders are listed once, when a file is missing, and no more than a bounded part of them.

#include <cstddef>
#include <filesystem>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

namespace pertev {

class FolderListing {
public:
    /// `folders` are canonical.
    explicit FolderListing(std::vector<std::filesystem::path> folders) : folders_(std::move(folders)) {}

    /// The files below `folder`, or with an empty `folder` below all folders, that fit `name` best: their last
    /// components are those of `name` without regard to the case of A to Z, as many as possible and at least the file's
    /// name. Of equally many, a path that lies directly below the folder comes first, then one in the same case.
    /// Several files mean that none of them fits better than the others. Symbolic links to folders are not followed,
    /// and names that begin with a dot are passed over.
    std::vector<std::filesystem::path> best_fits(const std::filesystem::path& name,
                                                 const std::filesystem::path& folder);

    /// Counts a message about one file, so that a scene of a thousand does not write a thousand. Returns whether there
    /// have been few so far.
    bool may_name_another();

private:
    struct File {
        std::filesystem::path path;
        std::size_t folder_size; // components of the folder of `folders_` that it lies below
    };
    void list();
    void list_level(std::vector<std::filesystem::path>& level, std::size_t folder_size);

    std::vector<std::filesystem::path> folders_;
    std::mutex mutex_;
    bool is_listed_ = false;
    std::size_t entries_ = 0;
    std::vector<File> files_;
    std::unordered_map<std::string, std::vector<std::size_t>> by_name_; // in lower case: numbers of files
    std::size_t named_ = 0;
};

/// The components of a path from another machine, which may begin with a drive, a root or `..`: those that can stand
/// below a folder here.
std::vector<std::string> components_below(const std::filesystem::path& name);

} // namespace pertev
