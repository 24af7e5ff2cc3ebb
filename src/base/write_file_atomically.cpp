#include "base/write_file_atomically.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"

namespace pertev {
namespace {

namespace fs = std::filesystem;

class OpenFile {
public:
    explicit OpenFile(int fd) : fd_(fd) {}
    ~OpenFile() {
        if (fd_ >= 0) ::close(fd_);
    }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;
    int fd() const { return fd_; }
    /// Takes a file in place of none.
    void reset(int fd) { fd_ = fd; }

private:
    int fd_;
};

constexpr std::string_view kStandardOutput = "/dev/stdout."; // /dev/stdout is not a folder, so no file has such a name

bool is_standard_output(const fs::path& path) { return path.string().starts_with(kStandardOutput); }

void check(bool ok) {
    if (!ok) throw std::system_error(errno, std::generic_category());
}

void write_all(int fd, std::span<const std::byte> bytes, Sink& sink) {
    constexpr std::size_t kAtOnce = std::size_t(1) << 24;
    while (!bytes.empty()) {
        sink.check();
        const ssize_t n = ::write(fd, bytes.data(), std::min(bytes.size(), kAtOnce));
        if (n < 0 && errno == EINTR) continue;
        check(n > 0);
        bytes = bytes.subspan(static_cast<std::size_t>(n));
    }
}

/// umask() reads the mask by changing it, so it is called once, before there are threads.
const mode_t kUmask = [] {
    const mode_t mask = ::umask(0);
    ::umask(mask);
    return mask;
}();

/// Permissions of the replaced file, or the user's defaults for new files.
mode_t mode_for(const fs::path& target) {
    struct stat there {};
    return ::stat(target.c_str(), &there) == 0 ? there.st_mode & 0777 : 0666 & ~kUmask;
}

/// The end of a chain of symbolic links, whether it exists or not (std::filesystem::weakly_canonical returns the link
/// itself if it does not).
fs::path follow_links(fs::path path) {
    constexpr int most = 40; // limit of Linux
    for (int i = 0; fs::is_symlink(fs::symlink_status(path)); ++i) {
        if (i == most) throw std::system_error(std::make_error_code(std::errc::too_many_symbolic_link_levels));
        path = path.parent_path() / fs::read_symlink(path); // an absolute target replaces the path
    }
    return path;
}

/// The path to write. Throws for anything but a regular file or a new one.
fs::path resolve_target(const fs::path& path) {
    const fs::path target = follow_links(path);
    const fs::file_status status = fs::status(target);
    if (fs::exists(status) && !fs::is_regular_file(status)) {
        throw Error(ErrorCode::FileWrite, FileLocation{path.string()},
                    "cannot write: it is not a regular file; name a file to create or replace");
    }
    return target;
}

fs::path folder_of(const fs::path& target) { return target.has_parent_path() ? target.parent_path() : fs::path("."); }

/// A new file beside the target, because rename() is atomic only within one file system. Where the system can, it has
/// no name before name(), so that a process that is killed leaves nothing.
class NewFile {
public:
    explicit NewFile(const fs::path& target) : name_(pattern_beside(target)), file_(open_unnamed(target)) {
        if (file_.fd() >= 0) return;
        file_.reset(::mkstemp(name_.data()));
        check(file_.fd() >= 0);
        has_name_ = true;
    }
    ~NewFile() {
        if (has_name_) ::unlink(name_.c_str());
    }
    NewFile(const NewFile&) = delete;
    NewFile& operator=(const NewFile&) = delete;

    int fd() const { return file_.fd(); }
    /// Replaces the target.
    void rename_to(const fs::path& target) {
        if (!has_name_) link();
        check(::rename(name_.c_str(), target.c_str()) == 0);
        has_name_ = false;
    }

private:
    static std::string pattern_beside(const fs::path& target) {
        return (folder_of(target) / ("." + target.filename().string() + ".XXXXXX")).string();
    }
    static int open_unnamed(const fs::path& target) {
        if (::access("/proc/self/fd", X_OK) != 0) return -1; // by which it gets its name
        return ::open(folder_of(target).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
    }
    void link() {
        const std::string unnamed = fmt::format("/proc/self/fd/{}", fd()), pattern = name_;
        for (int number = 0; !has_name_; ++number) {
            name_ = fmt::format("{}{}.{}", pattern.substr(0, pattern.size() - 6), ::getpid(), number);
            has_name_ = ::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name_.c_str(), AT_SYMLINK_FOLLOW) == 0;
            check(has_name_ || errno == EEXIST);
        }
    }

    std::string name_;
    OpenFile file_;
    bool has_name_ = false;
};

/// Throws before the disk is filled by a file that does not fit.
void check_space(const fs::path& target, std::size_t size) {
    if (free_disk_bytes(target).value_or(size) < size)
        throw std::system_error(std::make_error_code(std::errc::no_space_on_device));
}

/// Makes `previous` another name of the file, if it is there, or a copy where a file cannot have two.
void keep_as(const fs::path& previous, const fs::path& target) {
    if (!fs::exists(target)) return;
    fs::remove(previous);
    std::error_code fault;
    fs::create_hard_link(target, previous, fault);
    if (fault) fs::copy_file(target, previous);
}

/// Loses the old content if there is no `previous`.
void replace(const fs::path& target, const fs::path& previous, std::span<const std::byte> bytes, Sink& sink) {
    check_space(target, bytes.size());
    NewFile file(target);
    write_all(file.fd(), bytes, sink);
    check(::fchmod(file.fd(), mode_for(target)) == 0 && ::fsync(file.fd()) == 0);
    if (!previous.empty()) keep_as(previous, target);
    file.rename_to(target);
    const OpenFile directory(::open(folder_of(target).c_str(), O_RDONLY | O_DIRECTORY));
    check(directory.fd() >= 0 && ::fsync(directory.fd()) == 0); // makes the rename itself durable
}

[[noreturn]] void rethrow(const fs::path& path, const std::system_error& error) {
    throw Error(ErrorCode::FileWrite, FileLocation{path.string()},
                fmt::format("cannot write: {}", error.code().message()));
}

} // namespace

fs::path standard_output(const std::string& extension) { return std::string(kStandardOutput) + extension; }

void write_file_atomically(const fs::path& path, std::span<const std::byte> bytes, Sink& sink) {
    if (is_standard_output(path)) {
        try {
            return write_all(STDOUT_FILENO, bytes, sink);
        } catch (const std::system_error& error) {
            if (error.code() == std::errc::broken_pipe) return;
            throw Error(ErrorCode::FileWrite, FileLocation{"standard output"},
                        fmt::format("cannot write ({})", error.code().message()));
        }
    }
    try {
        replace(resolve_target(path), {}, bytes, sink);
    } catch (const std::system_error& error) {
        rethrow(path, error);
    }
}

void write_generation(const fs::path& path, const fs::path& previous, std::span<const std::byte> bytes) {
    try {
        replace(resolve_target(path), previous, bytes, nobody());
    } catch (const std::system_error& error) {
        rethrow(path, error);
    }
}

std::optional<uint64_t> free_disk_bytes(const fs::path& target) {
    std::error_code unknown;
    const fs::space_info disk = fs::space(folder_of(target), unknown);
    if (unknown || disk.capacity == 0) return std::nullopt;
    return disk.available;
}

void check_writable(const fs::path& path) {
    if (is_standard_output(path)) return;
    try {
        const fs::path target = resolve_target(path);
        const NewFile file(target);
    } catch (const std::system_error& error) {
        rethrow(path, error);
    }
}

} // namespace pertev
