#include "tracer/combination.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

using namespace pertev;

TEST_CASE("every structure and walk of the laboratory has a name of its own, by which it is found") {
    std::set<std::string_view> names;
    for (const StructureKind kind : kValuesOf<StructureKind>) {
        CHECK(value_named<StructureKind>(name_of(kind)) == kind);
        CHECK(names.insert(name_of(kind)).second);
    }
    CHECK(names.size() == 13);
    CHECK(!value_named<StructureKind>("no such structure"));
    names.clear();
    for (const WalkKind kind : kValuesOf<WalkKind>) {
        CHECK(value_named<WalkKind>(name_of(kind)) == kind);
        CHECK(names.insert(name_of(kind)).second);
    }
    CHECK(names.size() == 16);
    CHECK(!value_named<WalkKind>(""));
    for (const Distribution d : {Distribution::OneAThread, Distribution::Persistent, Distribution::DynamicFetch}) {
        CHECK(value_named<Distribution>(name_of(d)) == d);
    }
    CHECK(!value_named<Distribution>("persist"));
}

TEST_CASE("RTA is switched by its names, and by nothing else") {
    const WalkOptions others = {.near_first = false, .tests = TestKind::Fast};
    for (const char* name : {"on", "nodes", "off"}) {
        const auto options = rta_named(name, others);
        REQUIRE(options.has_value());
        CHECK(name_of_rta(*options) == std::string(name));
        CHECK(!options->near_first);
        CHECK(options->tests == TestKind::Fast);
    }
    CHECK(!rta_named("both", others));
}

TEST_CASE("names of combinations differ wherever their switches do, those refused included") {
    std::set<std::string> names;
    for (const WalkKind walk : kValuesOf<WalkKind>) {
        for (const bool near_first : {true, false}) {
            CHECK(names.insert(name_of({StructureKind::Binned, walk, {.near_first = near_first}})).second);
        }
    }
    CHECK(name_of({StructureKind::Binned, WalkKind::SkipLinks, {}}) == "binned skip-links rta");
    CHECK(name_of({StructureKind::Binned, WalkKind::SkipLinks, {.near_first = false}}) ==
          "binned skip-links rta unordered");
    names.clear();
    CHECK(name_of({StructureKind::Binned, WalkKind::Compressed, {.rta_at_pops = false}}) ==
          "binned compressed rta-at-nodes near");
    for (const bool rta : {true, false}) {
        for (const bool near_first : {true, false}) {
            for (const TestKind tests : kValuesOf<TestKind>) {
                for (const Distribution d :
                     {Distribution::OneAThread, Distribution::Persistent, Distribution::DynamicFetch}) {
                    CHECK(names.insert(name_of({StructureKind::Ploc, WalkKind::IfIf, {rta, near_first, tests}, d}))
                              .second);
                }
            }
        }
    }
}

TEST_CASE("each structure has a walk and each walk a structure; kd-trees and octrees have none but their own") {
    for (const StructureKind structure : kValuesOf<StructureKind>) {
        const auto walks =
            std::ranges::count_if(kValuesOf<WalkKind>, [&](WalkKind walk) { return !why_not(structure, walk); });
        CHECK(walks == (builder_of(structure) ? 14 : 1));
        const std::optional<WalkKind> only = only_walk_of(structure);
        CHECK(only.has_value() == (walks == 1));
        if (only) CHECK(!why_not(structure, *only));
    }
    for (const WalkKind walk : kValuesOf<WalkKind>) {
        CHECK(std::ranges::any_of(kValuesOf<StructureKind>, [&](StructureKind s) { return !why_not(s, walk); }));
    }
}

TEST_CASE("a combination that makes no sense says why") {
    constexpr bool cpu = false, gpu = true;
    const WalkOptions on;
    const auto reason = [](const Combination& c, bool on_cuda) { return why_not(c, on_cuda).value_or(""); };
    using enum Distribution;
    CHECK(reason({StructureKind::Binned, WalkKind::WhileWhile, on, OneAThread}, cpu).empty());
    CHECK(reason({StructureKind::Binned, WalkKind::WhileWhile, on, Persistent}, gpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, WalkKind::WhileWhile, on, Persistent}, cpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, WalkKind::Kd, on, OneAThread}, cpu).empty());
    CHECK_FALSE(reason({StructureKind::KdSah, WalkKind::IfIf, on, OneAThread}, cpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, WalkKind::Wide8Simd, on, OneAThread}, gpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, WalkKind::SkipLinks, {true, false}, OneAThread}, cpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, WalkKind::RestartTrail, on, DynamicFetch}, gpu).empty());
    const WalkOptions woop = {.tests = TestKind::Woop};
    CHECK(reason({StructureKind::Binned, WalkKind::Speculative, woop, DynamicFetch}, gpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, WalkKind::IfIf, woop, OneAThread}, cpu).empty());
    const WalkOptions at_nodes = {.rta_at_pops = false};
    CHECK(reason({StructureKind::Binned, WalkKind::Compressed, at_nodes, Persistent}, gpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, WalkKind::WhileWhile, at_nodes, OneAThread}, cpu).empty());
}
