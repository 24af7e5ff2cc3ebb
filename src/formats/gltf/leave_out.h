#pragma once

// The one rule of this reader: what cannot be read is left out with a warning, and the rest of the file is read on.

#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "base/messages.h"
#include "formats/json/json_value.h"

namespace pertev::gltf {

/// Runs `read`. Where it throws Error(BadInput), a warning gives the reason and says that `what` is left out. Returns
/// whether `read` came to its end. Other errors pass: a limit holds for the whole file. Never inlined, because g++ 12
/// at -O3 then loses what the caller's std::optional held before `read`, where that throws.
template <class Read>
[[gnu::noinline]] bool read_or_leave_out(const std::string& what, Messages& messages, const Read& read) {
    try {
        read();
        return true;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        messages.leave_out(error.remark().and_then(fmt::format("; {} is left out", what)));
        return false;
    }
}

/// The same for what stands at `place`.
template <class Read>
bool read_or_leave_out(const JsonValue& place, Messages& messages, const Read& read) {
    return read_or_leave_out(place.pointer(), messages, read);
}

/// Calls read(member) where `object` has the member. One that cannot be read counts as one that is not there.
template <class Read>
void read_member(const JsonValue& object, std::string_view key, Messages& messages, const Read& read) {
    if (const std::optional<JsonValue> member = object.find(key)) {
        read_or_leave_out(*member, messages, [&] { read(*member); });
    }
}

} // namespace pertev::gltf
