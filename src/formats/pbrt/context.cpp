#include "formats/pbrt/context.h"

#include <filesystem>
#include <system_error>

#include "base/error.h"

namespace pertev::pbrt {

FileLocation base_of(const Context& context, const FileLocation& from, const std::string& name) {
    if (from.file == context.file) return from;
    const FileLocation scene{context.file};
    try {
        std::error_code fault;
        if (std::filesystem::exists(context.access.resolve(scene, name), fault)) return scene;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
    }
    return from;
}

} // namespace pertev::pbrt
