#include "formats/mitsuba/context.h"

#include <system_error>

#include "base/error.h"

namespace pertev::mitsuba {

FoundName locate(const Context& context, const FileLocation& from, const std::string& name) {
    std::vector<FoundName> candidates = {{FileLocation{context.file}, name}};
    for (const auto& [location, folder] : context.search_paths) candidates.push_back({location, folder + "/" + name});
    if (from.file != context.file) candidates.push_back({from, name});
    std::optional<Error> refused;
    for (FoundName& candidate : candidates) {
        try {
            std::error_code fault;
            if (std::filesystem::is_regular_file(context.access.resolve(candidate.from, candidate.reference), fault)) {
                candidate.from.line = from.line;
                return candidate;
            }
        } catch (const Error& error) {
            if (error.code() != ErrorCode::BadInput) throw;
            if (!refused) refused = error;
        }
    }
    if (refused) throw Error(*refused);
    return {from.file == context.file ? from : FileLocation{context.file, from.line}, name};
}

std::optional<std::filesystem::path> find_file(const Context& context, const FileLocation& from,
                                               const std::string& name) {
    const FoundName found = locate(context, from, name);
    return context.access.find(found.from, found.reference, context.sink);
}

} // namespace pertev::mitsuba
