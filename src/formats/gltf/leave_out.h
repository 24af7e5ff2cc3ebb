#pragma once

// The rule of this reader: what cannot be read is left out with a warning, and the rest of the file is read.

#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "base/sink.h"
#include "formats/json/json_value.h"

namespace pertev::gltf {

/// Runs `read`. If it throws Error(BadInput), a warning gives the reason and says that `what` is left out. Returns
/// whether `read` succeeded. Other errors are passed on, because a limit applies to the whole file. Never inlined,
/// because g++ 12 at -O3 then loses the value that the caller's std::optional had before `read`, if that throws.
template <class Read>
[[gnu::noinline]] bool read_or_leave_out(const std::string& what, Sink& sink, const Read& read) {
    try {
        read();
        return true;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        sink.leave_out(error.remark().and_then(fmt::format("; {} is left out", what)));
        return false;
    }
}

/// Runs `read`; messages name the pointer of `json`.
template <class Read>
bool read_or_leave_out(const JsonValue& json, Sink& sink, const Read& read) {
    return read_or_leave_out(json.pointer(), sink, read);
}

/// Calls read(member) if `object` has the member. An unreadable one counts as absent.
template <class Read>
void read_member(const JsonValue& object, std::string_view key, Sink& sink, const Read& read) {
    if (const std::optional<JsonValue> member = object.find(key)) {
        read_or_leave_out(*member, sink, [&] { read(*member); });
    }
}

} // namespace pertev::gltf
