#include "formats/mitsuba/read_document.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <set>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "base/limits.h"
#include "base/message_text.h"
#include "base/read_file.h"
#include "formats/files/closest_name.h"
#include "formats/files/included_files.h"
#include "formats/mitsuba/define_values.h"
#include "formats/mitsuba/parse_values.h"
#include "formats/mitsuba/read_transform.h"

namespace pertev::mitsuba {
namespace {

constexpr int kMostFiles = 16;    // includes in each other
constexpr int kMostNested = 64;   // elements in each other
constexpr uint64_t kObject = 512; // bytes of an element once it is read, about

constexpr std::array<std::string_view, 12> kObjectTags = {"bsdf",   "emitter", "film",    "integrator",
                                                          "medium", "phase",   "rfilter", "sampler",
                                                          "sensor", "shape",   "texture", "volume"};
constexpr std::array<std::string_view, 16> kOtherTags = {
    "alias", "animation", "blackbody", "boolean", "default", "float",  "include",   "integer",
    "path",  "point",     "ref",       "rgb",     "srgb",    "string", "transform", "vector"};

/// Returns the attributes of an element; none for one that is unknown.
std::span<const std::string_view> attributes_of(std::string_view tag, bool has_type) {
    constexpr static std::string_view kOfObject[] = {"type", "id", "name", "version"},
                                      kVector[] = {"name", "value", "x", "y", "z"},
                                      kColor[] = {"name", "value", "intent"}, kRef[] = {"id", "name"},
                                      kAlias[] = {"id", "as"}, kInclude[] = {"filename"}, kPath[] = {"value"},
                                      kBlackbody[] = {"name", "value", "temperature", "scale"},
                                      kSpectrum[] = {"name", "value", "intent", "filename"}, kNamed[] = {"name"},
                                      kRotate[] = {"value", "x", "y", "z", "angle"},
                                      kLookat[] = {"origin", "target", "up"};
    const auto is = [tag](std::initializer_list<std::string_view> tags) {
        return std::ranges::find(tags, tag) != tags.end();
    };
    if (std::ranges::find(kObjectTags, tag) != kObjectTags.end() || is({"subsurface"}) ||
        (tag == "spectrum" && has_type))
        return kOfObject;
    if (is({"float", "integer", "boolean", "string", "default"})) return std::span(kColor).first(2);
    if (is({"point", "vector"})) return kVector;
    if (is({"translate", "scale"})) return std::span(kVector).last(4);
    if (is({"rgb", "srgb"})) return kColor;
    if (is({"spectrum"})) return kSpectrum;
    if (is({"blackbody"})) return kBlackbody;
    if (is({"ref"})) return kRef;
    if (is({"alias"})) return kAlias;
    if (is({"include"})) return kInclude;
    if (is({"path", "matrix"})) return kPath;
    if (is({"rotate"})) return kRotate;
    if (is({"lookat", "look_at"})) return kLookat;
    if (is({"transform", "animation"})) return kNamed;
    return {};
}

class Reader {
public:
    Reader(Context& context, Document& document)
        : context_(context), document_(document), values_(context.options.defines, context.sink) {}

    void read(const std::string& path, std::span<const std::byte> text) {
        if (files_ == 0) first_bytes_ = text.size();
        document_.bytes += text.size();
        const uint64_t most = justified_bytes(kFreeMeshBytes, first_bytes_);
        if (document_.bytes > most)
            throw Error(
                ErrorCode::OverLimit, FileLocation{path},
                fmt::format("the included files take over {} MiB, more than the scene's file justifies", most >> 20));
        File outer = std::move(file_);
        file_.path = path;
        for (std::size_t i = 0; i < text.size(); ++i)
            if (text[i] == std::byte{'\n'}) file_.line_ends.push_back(i);
        pugi::xml_document tree; // its parser does not recurse
        const pugi::xml_parse_result parsed =
            tree.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_auto);
        if (!parsed)
            context_.sink.leave_out(
                {FileLocation{path, line_at(parsed.offset)},
                 fmt::format("the XML is broken and the rest of the file is left out; {}", parsed.description())});
        ++files_;
        read_root(tree.document_element());
        --files_;
        file_ = std::move(outer);
    }

    void finish() { values_.report_unused(); }

private:
    struct File {
        std::string path;
        std::vector<std::size_t> line_ends;
    };

    std::size_t line_at(std::ptrdiff_t offset) const {
        const auto found =
            std::ranges::lower_bound(file_.line_ends, static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)));
        return static_cast<std::size_t>(found - file_.line_ends.begin()) + 1;
    }
    FileLocation location_of(const pugi::xml_node& node) const { return {file_.path, line_at(node.offset_debug())}; }
    Error error(const pugi::xml_node& node, std::string reason) const {
        return {ErrorCode::BadInput, location_of(node), std::move(reason)};
    }

    /// Returns an attribute's text with the values of $NAME; `missing` if there is none.
    std::string text(const pugi::xml_node& node, const char* name, std::string_view missing = "") {
        const pugi::xml_attribute attribute = node.attribute(name);
        return attribute ? values_.put_into(attribute.value(), location_of(node)) : std::string(missing);
    }

    /// Leaves out the attributes of an element that are not in `known`. A colon is of another namespace.
    void leave_out_unknown_attributes(const pugi::xml_node& node, std::span<const std::string_view> known) {
        for (const pugi::xml_attribute& attribute : node.attributes()) {
            const std::string_view name = attribute.name();
            if (std::ranges::find(known, name) != known.end() || name.find(':') != name.npos || name == "xmlns")
                continue;
            context_.sink.leave_out(
                {location_of(node), fmt::format("the attribute \"{}\" of <{}> is unknown and left out{}",
                                                shortened(name), shortened(node.name()), did_you_mean(name, known))});
        }
    }

    void read_root(const pugi::xml_node& root) {
        if (!root) return;
        if (files_ == 1) {
            const std::string version = text(root, "version");
            const std::vector<double> numbers = parse_numbers(version.substr(0, version.find('.')));
            document_.is_old = context_.is_old = !numbers.empty() && numbers[0] < 2;
            if (numbers.empty())
                context_.sink.warn({location_of(root), "there is no version such as \"3.0.0\"; Mitsuba 3 is assumed"});
        }
        if (std::string_view(root.name()) == "scene") {
            for (const pugi::xml_node& node : root.children()) read_element(node, nullptr, 0);
        } else {
            read_element(root, nullptr, 0);
        }
    }

    /// Reads an element of `parent`, which is null in <scene>. An unreadable one is left out.
    void read_element(const pugi::xml_node& node, Object* parent, int depth) {
        if (node.type() != pugi::node_element) return;
        context_.sink.check_at(elements_);
        if (++elements_ * kObject > justified_bytes(kFreeMeshBytes, first_bytes_))
            throw Error(ErrorCode::OverLimit, location_of(node),
                        "more elements than the size of the scene's file justifies");
        try {
            if (depth > kMostNested)
                throw error(node, fmt::format("more than {} elements are in each other", kMostNested));
            read_tag(node, parent, depth);
        } catch (const Error& fault) {
            if (fault.code() != ErrorCode::BadInput) throw;
            context_.sink.leave_out(fault.remark().and_then(fmt::format("; <{}> is left out", shortened(node.name()))));
        }
    }

    void read_tag(const pugi::xml_node& node, Object* parent, int depth) {
        std::string tag = snake_case(node.name());
        if (tag == "luminaire") tag = "emitter";
        if (tag == "camera") tag = "sensor";
        if (const auto known = attributes_of(tag, node.attribute("type")); !known.empty())
            leave_out_unknown_attributes(node, known);
        if (tag == "default") return values_.set_default(text(node, "name"), text(node, "value"), location_of(node));
        if (tag == "include") return include(node, parent, depth);
        if (tag == "path") return context_.search_paths.emplace_back(location_of(node), text(node, "value")), void();
        if (tag == "alias") return document_.objects.add_alias(text(node, "id"), text(node, "as"));
        const bool is_object = std::ranges::find(kObjectTags, tag) != kObjectTags.end();
        if (is_object || tag == "subsurface" || (tag == "spectrum" && node.attribute("type")))
            return read_object(node, tag, parent, depth);
        if (std::ranges::find(kOtherTags, tag) == kOtherTags.end() && tag != "spectrum") {
            std::vector<std::string_view> known(kObjectTags.begin(), kObjectTags.end());
            known.insert(known.end(), kOtherTags.begin(), kOtherTags.end());
            throw error(node, fmt::format("there is no such element{}", did_you_mean(tag, known)));
        }
        if (parent == nullptr) throw error(node, "it is in no object");
        if (tag == "ref") return read_reference(node, *parent);
        parent->parameters.add(read_parameter(node, tag));
    }

    void include(const pugi::xml_node& node, Object* parent, int depth) {
        if (parent != nullptr) throw error(node, "files are included in <scene> alone");
        if (files_ >= kMostFiles) throw error(node, fmt::format("more than {} files include each other", kMostFiles));
        (void)depth;
        const std::string name = text(node, "filename");
        const auto path = find_file(context_, location_of(node), name);
        if (!path) throw error(node, fmt::format("there is no file {}", shortened(name)));
        included_.count(*path, files_ > 1, location_of(node));
        const std::vector<std::byte> bytes = read_file(*path);
        read(path->string(), bytes);
    }

    void read_object(const pugi::xml_node& node, const std::string& tag, Object* parent, int depth) {
        std::string type = snake_case(text(node, "type"));
        const std::string what =
            type.empty() ? fmt::format("the {}", tag) : fmt::format("the {} {}", tag, shortened(type));
        std::string id = text(node, "id");
        if (document_.objects.has(id))
            context_.sink.warn(
                {location_of(node), fmt::format("another object has the id {}, too; references are to this "
                                                "one",
                                                shortened(id))});
        Object& object = document_.objects.add(tag, std::move(type), std::move(id), location_of(node), what);
        if (parent == nullptr) {
            document_.objects.top().push_back(object.number);
        } else {
            add_child(snake_case(text(node, "name")), Objects::id_of(object), location_of(node).line, *parent);
        }
        for (const pugi::xml_node& child : node.children()) read_element(child, &object, depth + 1);
    }

    void read_reference(const pugi::xml_node& node, Object& parent) {
        const std::string id = text(node, "id");
        if (id.empty()) throw error(node, "a reference has no id");
        add_child(snake_case(text(node, "name")), id, location_of(node).line, parent);
    }

    static void add_child(std::string name, std::string id, std::size_t line, Object& parent) {
        if (name.empty()) return parent.children.push_back({std::move(id), line});
        Parameter parameter;
        parameter.type = ParameterType::Texture;
        parameter.name = std::move(name);
        parameter.texts = {std::move(id)};
        parameter.line = line;
        parent.parameters.add(std::move(parameter));
    }

    std::vector<double> numbers(const pugi::xml_node& node, const char* name, std::size_t least, std::size_t most) {
        const std::string value = text(node, name);
        std::vector<double> found = parse_numbers(value);
        const bool is_finite = std::ranges::all_of(found, [](double x) { return std::isfinite(x); });
        if (found.size() < least || found.size() > most || !is_finite)
            throw error(node, fmt::format("{}=\"{}\" is not a value", name, shortened(value)));
        return found;
    }

    Parameter read_parameter(const pugi::xml_node& node, const std::string& tag) {
        Parameter to;
        to.name = snake_case(text(node, "name"));
        if (to.name.empty()) throw error(node, "it has no name");
        to.line = location_of(node).line;
        if (tag == "float" || tag == "integer") {
            to.type = tag == "float" ? ParameterType::Float : ParameterType::Integer;
            to.numbers = numbers(node, "value", 1, 1);
        } else if (tag == "boolean" || tag == "string") {
            to.type = tag == "string" ? ParameterType::String : ParameterType::Bool;
            to.texts = {text(node, "value")};
            if (tag == "boolean") to.texts[0] = snake_case(to.texts[0]); // True
        } else if (tag == "point" || tag == "vector") {
            to.type = tag == "point" ? ParameterType::Point3 : ParameterType::Vector3;
            to.numbers = vector_of(node, 0);
        } else if (tag == "rgb" || tag == "srgb") {
            to.type = ParameterType::Rgb;
            to.numbers = parse_color(text(node, "value"), tag == "srgb");
            if (to.numbers.size() != 3)
                throw error(node, fmt::format("\"{}\" is not a colour", shortened(text(node, "value"))));
        } else if (tag == "blackbody") {
            to.type = ParameterType::Blackbody;
            std::string value = text(node, "temperature", text(node, "value"));
            if (value.ends_with('k') || value.ends_with('K')) value.pop_back();
            to.numbers = parse_numbers(value);
            if (to.numbers.size() != 1) throw error(node, "a black body has no temperature");
            if (node.attribute("scale")) to.numbers.push_back(numbers(node, "scale", 1, 1)[0]);
        } else if (tag == "spectrum") {
            read_spectrum(node, to);
        } else { // transform or animation
            to.type = ParameterType::Transform;
            to.numbers = transform_in(node, tag == "animation");
        }
        return to;
    }

    std::vector<double> vector_of(const pugi::xml_node& node, double missing) {
        if (node.attribute("value")) {
            std::vector<double> all = numbers(node, "value", 1, 3);
            if (all.size() == 1) all = {all[0], all[0], all[0]};
            if (all.size() == 2) all.push_back(missing);
            return all;
        }
        std::vector<double> all;
        for (const char* const name : {"x", "y", "z"})
            all.push_back(node.attribute(name) ? numbers(node, name, 1, 1)[0] : missing);
        return all;
    }

    void read_spectrum(const pugi::xml_node& node, Parameter& to) {
        to.type = ParameterType::Spectrum;
        if (node.attribute("filename")) {
            to.texts = {text(node, "filename")};
            return;
        }
        const std::string value = text(node, "value");
        std::string pairs = value;
        std::ranges::replace(pairs, ':', ' ');
        to.numbers = parse_numbers(pairs);
        const bool has_pairs = value.find(':') != std::string::npos;
        const bool is_finite = std::ranges::all_of(to.numbers, [](double x) { return std::isfinite(x); });
        if (!is_finite || to.numbers.empty() || (has_pairs && to.numbers.size() % 2 != 0))
            throw error(node, fmt::format("\"{}\" is not a spectrum", shortened(value)));
        if (!has_pairs && to.numbers.size() == 3) to.type = ParameterType::Rgb; // Mitsuba 0.6 takes it so
        if (!has_pairs && to.numbers.size() != 1 && to.numbers.size() != 3)
            throw error(node, "a spectrum is one number, or pairs such as \"400:0.2, 700:0.5\"");
    }

    std::vector<double> transform_in(const pugi::xml_node& node, bool is_motion) {
        if (is_motion) {
            context_.sink.leave_out({location_of(node), "motion is left out; its first transform is used"});
            return transform_in(node.child("transform"), false);
        }
        DoubleTransform transform;
        for (const pugi::xml_node& step : node.children()) {
            if (step.type() != pugi::node_element) continue;
            const std::string tag = snake_case(step.name());
            if (const auto known = attributes_of(tag, false); !known.empty()) leave_out_unknown_attributes(step, known);
            TransformStep read;
            if (tag == "translate" || tag == "scale" || tag == "rotate") {
                read.vector = vector_of(step, tag == "scale" ? 1 : 0);
                if (tag == "rotate") read.angle_deg = numbers(step, "angle", 1, 1)[0];
            } else if (tag == "matrix") {
                read.matrix = numbers(step, "value", 9, 16);
                read.is_flat = snake_case(text(node, "name")) == "to_uv";
            } else if (tag == "lookat" || tag == "look_at") {
                read.origin = numbers(step, "origin", 3, 3);
                read.target = numbers(step, "target", 3, 3);
                if (step.attribute("up")) read.up = numbers(step, "up", 3, 3);
            } else {
                throw error(step, "there is no such transform; expected translate, scale, rotate, matrix or lookat");
            }
            const auto made = make_transform(tag, read);
            if (!made) throw error(step, "the transform has no inverse or too few numbers");
            transform = compose(*made, transform);
        }
        return numbers_of(transform);
    }

    Context& context_;
    Document& document_;
    DefineValues values_;
    File file_;
    int files_ = 0;
    IncludedFiles included_;
    uint64_t first_bytes_ = 0, elements_ = 0;
};

} // namespace

Document read_document(const std::filesystem::path& path, std::span<const std::byte> text, Context& context) {
    Document document;
    Reader reader(context, document);
    reader.read(path.string(), text);
    reader.finish();
    return document;
}

} // namespace pertev::mitsuba
