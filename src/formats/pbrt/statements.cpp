#include "formats/pbrt/statements.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/limits.h"
#include "base/message_text.h"
#include "formats/described/transforms.h"
#include "formats/files/closest_name.h"
#include "formats/files/gunzip.h"
#include "formats/files/parse_number.h"
#include "formats/pbrt/read_parameters.h"

namespace pertev::pbrt {
namespace {

constexpr std::size_t kMostFiles = 64;     // most includes in each other
constexpr std::size_t kMostKept = 1 << 16; // states of begin statements in each other

std::string_view text_of(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

} // namespace

struct Statements::Statement {
    std::string_view name;
    void (Statements::*read)(Tokens&, const FileLocation&);
};

const std::vector<Statements::Statement>& Statements::all() {
    using S = Statements;
    static const std::vector<Statement> statements = {
        {"Accelerator", &S::accelerator},
        {"ActiveTransform", &S::active_transform},
        {"AreaLightSource", &S::area_light},
        {"Attribute", &S::attribute},
        {"AttributeBegin", &S::begin},
        {"AttributeEnd", &S::end},
        {"Camera", &S::camera},
        {"ColorSpace", &S::color_space},
        {"ConcatTransform", &S::concat_transform},
        {"CoordSysTransform", &S::coord_sys_transform},
        {"CoordinateSystem", &S::coordinate_system},
        {"Film", &S::film},
        {"Identity", &S::identity},
        {"Import", &S::import_file},
        {"Include", &S::include},
        {"Integrator", &S::integrator},
        {"LightSource", &S::light},
        {"LookAt", &S::look_at},
        {"MakeNamedMaterial", &S::make_named_material},
        {"MakeNamedMedium", &S::medium},
        {"Material", &S::material},
        {"MediumInterface", &S::medium_interface},
        {"NamedMaterial", &S::named_material},
        {"ObjectBegin", &S::begin_object},
        {"ObjectEnd", &S::end_object},
        {"ObjectInstance", &S::instance},
        {"Option", &S::option},
        {"PixelFilter", &S::pixel_filter},
        {"ReverseOrientation", &S::reverse_orientation},
        {"Rotate", &S::rotate},
        {"Sampler", &S::sampler},
        {"Scale", &S::scale},
        {"Shape", &S::shape},
        {"Texture", &S::texture},
        {"Transform", &S::transform},
        {"TransformBegin", &S::begin_transform},
        {"TransformEnd", &S::end_transform},
        {"TransformTimes", &S::transform_times},
        {"Translate", &S::translate},
        {"WorldBegin", &S::begin_world},
        {"WorldEnd", &S::end_world},
    };
    return statements;
}

const Statements::Statement* Statements::find(std::string_view name) {
    const auto found = std::ranges::find(all(), name, &Statement::name);
    return found == all().end() ? nullptr : &*found;
}

void Statements::read(std::string_view text, const std::filesystem::path& file, uint64_t file_bytes) {
    if (files_ == 0) first_bytes_ = file_bytes;
    bytes_ += file_bytes;
    text_bytes_ += text.size();
    const uint64_t most = justified_bytes(kFreeMeshBytes, first_bytes_);
    if (text_bytes_ > most) {
        throw Error(
            ErrorCode::OverLimit, FileLocation{file.string()},
            fmt::format("the included files take over {} MiB, more than the scene's file justifies", most >> 20));
    }
    ++files_;
    Tokens tokens(text);
    while (tokens.peek().kind != TokenKind::End) {
        context_.sink.check();
        const Token token = tokens.next();
        const FileLocation location{file.string(), token.line};
        const Statement* const statement = token.kind == TokenKind::Word ? find(token.text) : nullptr;
        if (statement != nullptr) {
            read_one(tokens, *statement, location);
            continue;
        }
        std::vector<std::string_view> known;
        for (const Statement& other : all()) known.push_back(other.name);
        context_.sink.leave_out({location, fmt::format("\"{}\" is not a statement and is left out{}",
                                                       shortened(token.text), did_you_mean(token.text, known))});
        while (tokens.peek().kind != TokenKind::End && find(tokens.peek().text) == nullptr) tokens.next();
    }
    if (--files_ == 0) finish();
}

void Statements::read_one(Tokens& tokens, const Statement& statement, const FileLocation& location) {
    try {
        (this->*statement.read)(tokens, location);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        context_.sink.leave_out(error.remark().and_then(fmt::format("; {} is left out", statement.name)));
    }
}

void Statements::finish() {
    if (kept_.empty()) return;
    context_.sink.warn(
        fmt::format("{} lacks its end", counted(kept_.size(), "AttributeBegin, TransformBegin or ObjectBegin")));
}

std::string Statements::take_text(Tokens& tokens, const FileLocation& location) {
    const bool has_brackets = tokens.peek().kind == TokenKind::Open;
    if (has_brackets) tokens.next();
    if (tokens.peek().kind != TokenKind::Quoted)
        throw Error(ErrorCode::BadInput, location,
                    fmt::format("expected a quoted name, not \"{}\"", shortened(tokens.peek().text)));
    const Token token = tokens.next();
    if (has_brackets && tokens.peek().kind == TokenKind::Close) tokens.next();
    if (token.is_open_ended)
        throw Error(ErrorCode::BadInput, location, fmt::format("\"{}\" has no closing quote", shortened(token.text)));
    return unescaped(token.text);
}

std::vector<double> Statements::take_numbers(Tokens& tokens, std::size_t count, const FileLocation& location) {
    const bool has_brackets = tokens.peek().kind == TokenKind::Open;
    if (has_brackets) tokens.next();
    std::vector<double> numbers;
    while (numbers.size() < count) {
        std::string_view text = tokens.peek().text;
        const auto number = tokens.peek().kind == TokenKind::Word ? parse_float<double>(text) : std::nullopt;
        if (!number || !text.empty() || !(std::abs(*number) <= 1e300)) {
            throw Error(
                ErrorCode::BadInput, location,
                fmt::format("expected {} finite numbers; \"{}\" is none", count, shortened(tokens.peek().text)));
        }
        numbers.push_back(*number);
        tokens.next();
    }
    if (has_brackets && tokens.peek().kind != TokenKind::Close)
        throw Error(ErrorCode::BadInput, location, fmt::format("expected {} numbers and ]", count));
    if (has_brackets) tokens.next();
    return numbers;
}

Parameters Statements::take_parameters(Tokens& tokens, const FileLocation& location, std::string what,
                                       const char* attribute) {
    Parameters parameters(location, std::move(what));
    parameters.set_color_space(world_.state.color_space);
    read_parameters(tokens, parameters, context_.sink);
    const auto& defaults = world_.state.attributes;
    if (*attribute == '\0' || !defaults) return parameters;
    if (const auto found = defaults->find(attribute); found != defaults->end()) parameters.add_missing(found->second);
    return parameters;
}

void Statements::read_file(Tokens& tokens, const FileLocation& location, bool keeps_state) {
    const std::string name = take_text(tokens, location);
    if (files_ >= kMostFiles)
        throw Error(ErrorCode::BadInput, location, fmt::format("{} files include each other", files_));
    const auto path = context_.access.find(base_of(context_, location, name), name, context_.sink);
    if (!path) throw Error(ErrorCode::BadInput, location, fmt::format("there is no file {}", shortened(name)));
    included_.count(*path, files_ > 1, location);
    const UnzippedFile included = read_unzipped(*path);
    const std::size_t depth = kept_.size();
    if (!keeps_state) kept_.push_back({.state = world_.state});
    read(text_of(included.bytes), *path, included.size);
    if (keeps_state || kept_.size() <= depth) return;
    world_.state = kept_[depth].state;
    kept_.resize(depth);
}

void Statements::include(Tokens& tokens, const FileLocation& location) { read_file(tokens, location, true); }
void Statements::import_file(Tokens& tokens, const FileLocation& location) { read_file(tokens, location, false); }

void Statements::begin(Tokens&, const FileLocation& location) {
    if (kept_.size() >= kMostKept)
        throw Error(ErrorCode::OverLimit, location,
                    fmt::format("over {} statements begin within each other", kMostKept));
    kept_.push_back({.state = world_.state});
}

void Statements::end(Tokens&, const FileLocation& location) {
    if (kept_.empty() || kept_.back().is_object)
        throw Error(ErrorCode::BadInput, location, "there is no AttributeBegin before it");
    world_.state = std::move(kept_.back().state);
    kept_.pop_back();
}

void Statements::begin_transform(Tokens& tokens, const FileLocation& location) {
    begin(tokens, location);
    kept_.back().is_transform_alone = true;
}

void Statements::end_transform(Tokens&, const FileLocation& location) {
    if (kept_.empty() || !kept_.back().is_transform_alone)
        throw Error(ErrorCode::BadInput, location, "there is no TransformBegin before it");
    world_.state.transforms = kept_.back().state.transforms;
    world_.state.is_active = kept_.back().state.is_active;
    kept_.pop_back();
}

void Statements::begin_world(Tokens&, const FileLocation&) {
    world_.state.transforms = {};
    world_.state.is_active = {true, true};
    world_.coordinate_systems["world"] = world_.state.transforms;
}

void Statements::end_world(Tokens&, const FileLocation&) {}

void Statements::begin_object(Tokens& tokens, const FileLocation& location) {
    const std::string name = take_text(tokens, location);
    world_.begin_object(name, location);
    begin(tokens, location);
    kept_.back().is_object = true;
}

void Statements::end_object(Tokens&, const FileLocation& location) {
    world_.end_object(location);
    while (!kept_.empty() && !kept_.back().is_object) kept_.pop_back(); // blocks that lack their end
    if (kept_.empty()) return;
    world_.state = std::move(kept_.back().state);
    kept_.pop_back();
}

void Statements::instance(Tokens& tokens, const FileLocation& location) {
    world_.add_instance(take_text(tokens, location), location, bytes_);
}

void Statements::apply(const DoubleTransform& transform, bool replaces, const FileLocation& location) {
    if (!is_finite(transform)) throw Error(ErrorCode::BadInput, location, "the transform is not finite");
    for (std::size_t i = 0; i < 2; ++i) {
        if (!world_.state.is_active[i]) continue;
        DoubleTransform& to = world_.state.transforms[i];
        to = replaces ? transform : compose(to, transform);
    }
}

void Statements::identity(Tokens&, const FileLocation& location) { apply({}, true, location); }

void Statements::translate(Tokens& tokens, const FileLocation& location) {
    const std::vector<double> t = take_numbers(tokens, 3, location);
    apply(translation_by({t[0], t[1], t[2]}), false, location);
}

void Statements::scale(Tokens& tokens, const FileLocation& location) {
    const std::vector<double> s = take_numbers(tokens, 3, location);
    apply(scale_by({s[0], s[1], s[2]}), false, location);
}

void Statements::rotate(Tokens& tokens, const FileLocation& location) {
    const std::vector<double> r = take_numbers(tokens, 4, location);
    apply(make_rotation(r[0], {r[1], r[2], r[3]}), false, location);
}

void Statements::look_at(Tokens& tokens, const FileLocation& location) {
    const std::vector<double> n = take_numbers(tokens, 9, location);
    apply(make_look_at({n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}), false, location);
}

void Statements::transform(Tokens& tokens, const FileLocation& location) {
    apply(transform_of(take_numbers(tokens, 16, location)), true, location);
}

void Statements::concat_transform(Tokens& tokens, const FileLocation& location) {
    apply(transform_of(take_numbers(tokens, 16, location)), false, location);
}

void Statements::coordinate_system(Tokens& tokens, const FileLocation& location) {
    world_.coordinate_systems[take_text(tokens, location)] = world_.state.transforms;
}

void Statements::coord_sys_transform(Tokens& tokens, const FileLocation& location) {
    const std::string name = take_text(tokens, location);
    const auto found = world_.coordinate_systems.find(name);
    if (found == world_.coordinate_systems.end())
        throw Error(ErrorCode::BadInput, location, fmt::format("there is no coordinate system {}", shortened(name)));
    world_.state.transforms = found->second;
}

void Statements::active_transform(Tokens& tokens, const FileLocation& location) {
    const Token token = tokens.peek();
    const bool is_start = token.is_word("StartTime"), is_end = token.is_word("EndTime");
    if (!is_start && !is_end && !token.is_word("All"))
        throw Error(ErrorCode::BadInput, location, "expected StartTime, EndTime or All");
    tokens.next();
    world_.state.is_active = {!is_end, !is_start};
}

void Statements::transform_times(Tokens& tokens, const FileLocation& location) {
    (void)take_numbers(tokens, 2, location);
}

void Statements::reverse_orientation(Tokens&, const FileLocation&) {
    world_.state.is_reversed = !world_.state.is_reversed;
}

} // namespace pertev::pbrt
