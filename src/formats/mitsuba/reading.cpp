#include "formats/mitsuba/reading.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/mitsuba/read_transform.h"

namespace pertev::mitsuba {

Object* Reading::object_of(const Object& in, const Parameter& parameter) {
    if (parameter.type != ParameterType::Texture) return nullptr;
    try {
        return &objects.find(parameter.texts.front(), in.parameters.location_of(parameter));
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        sink().leave_out(error.remark().and_then(
            fmt::format("; \"{}\" of {} is left out", shortened(parameter.name), in.parameters.what())));
        return nullptr;
    }
}

DoubleTransform transform_of(Object& object, std::string_view name, Sink& sink) {
    const std::span<const double> rows = object.parameters.numbers(name, 12, sink);
    if (rows.size() != 12) return {};
    return transform_of_rows({rows.begin(), rows.end()});
}

Object* child_of(Object& object, std::string_view tag, Reading& reading) {
    for (const Child& child : object.children) {
        Object& found = reading.objects.find(child.id, {object.location().file, child.line});
        if (found.tag == tag) return &found;
    }
    return nullptr;
}

std::vector<Object*> objects_without_use(const Object& object, std::initializer_list<std::string_view> used,
                                         Reading& reading) {
    std::vector<Object*> found;
    for (const Child& child : object.children) {
        Object& other = reading.objects.find(child.id, {object.location().file, child.line});
        if (std::ranges::find(used, other.tag) == used.end()) found.push_back(&other);
    }
    return found;
}

std::vector<Object*> objects_in(Object& object, std::string_view tag, Reading& reading) {
    std::vector<Object*> all;
    for (const Parameter& parameter : object.parameters.all()) {
        if (parameter.type != ParameterType::Texture) continue;
        Object* const found = reading.object_of(object, parameter);
        if (found == nullptr || found->tag != tag) continue;
        object.parameters.look_up(parameter.name);
        all.push_back(found);
    }
    for (const Child& child : object.children) {
        Object& found = reading.objects.find(child.id, {object.location().file, child.line});
        if (found.tag == tag) all.push_back(&found);
    }
    return all;
}

} // namespace pertev::mitsuba
