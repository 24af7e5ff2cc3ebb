#include "tracer/combination.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

using namespace pertev;

TEST_CASE("every structure and traversal of the laboratory has a unique name, by which it is found") {
    std::set<std::string_view> names;
    for (const StructureKind kind : kValuesOf<StructureKind>) {
        CHECK(value_named<StructureKind>(name_of(kind)) == kind);
        CHECK(names.insert(name_of(kind)).second);
    }
    CHECK(names.size() == 13);
    CHECK(!value_named<StructureKind>("no such structure"));
    names.clear();
    for (const TraversalKind kind : kValuesOf<TraversalKind>) {
        CHECK(value_named<TraversalKind>(name_of(kind)) == kind);
        CHECK(names.insert(name_of(kind)).second);
    }
    CHECK(names.size() == 16);
    CHECK(!value_named<TraversalKind>(""));
    for (const Distribution d : {Distribution::OneAThread, Distribution::Persistent, Distribution::DynamicFetch}) {
        CHECK(value_named<Distribution>(name_of(d)) == d);
    }
    CHECK(!value_named<Distribution>("persist"));
}

TEST_CASE("RTA is switched only by its names") {
    const TraversalOptions others = {.near_first = false, .tests = TestKind::Fast};
    for (const char* name : {"on", "nodes", "off"}) {
        const auto options = rta_named(name, others);
        REQUIRE(options.has_value());
        CHECK(name_of_rta(*options) == std::string(name));
        CHECK(!options->near_first);
        CHECK(options->tests == TestKind::Fast);
    }
    CHECK(!rta_named("both", others));
}

TEST_CASE("names of combinations differ wherever their switches do, including refused ones") {
    std::set<std::string> names;
    for (const TraversalKind traversal : kValuesOf<TraversalKind>) {
        for (const bool near_first : {true, false}) {
            CHECK(names.insert(name_of({StructureKind::Binned, traversal, {.near_first = near_first}})).second);
        }
    }
    CHECK(name_of({StructureKind::Binned, TraversalKind::SkipLinks, {}}) == "binned skip-links rta");
    CHECK(name_of({StructureKind::Binned, TraversalKind::SkipLinks, {.near_first = false}}) ==
          "binned skip-links rta unordered");
    names.clear();
    CHECK(name_of({StructureKind::Binned, TraversalKind::Compressed, {.rta_at_pops = false}}) ==
          "binned compressed rta-at-nodes near");
    for (const bool rta : {true, false}) {
        for (const bool near_first : {true, false}) {
            for (const TestKind tests : kValuesOf<TestKind>) {
                for (const Distribution d :
                     {Distribution::OneAThread, Distribution::Persistent, Distribution::DynamicFetch}) {
                    CHECK(names.insert(name_of({StructureKind::Ploc, TraversalKind::IfIf, {rta, near_first, tests}, d}))
                              .second);
                }
            }
        }
    }
}

TEST_CASE("each structure has a traversal and each traversal a structure; kd-trees and octrees have only their own") {
    for (const StructureKind structure : kValuesOf<StructureKind>) {
        const auto traversals = std::ranges::count_if(
            kValuesOf<TraversalKind>, [&](TraversalKind traversal) { return !why_not(structure, traversal); });
        CHECK(traversals == (builder_of(structure) ? 14 : 1));
        const std::optional<TraversalKind> only = only_traversal_of(structure);
        CHECK(only.has_value() == (traversals == 1));
        if (only) CHECK(!why_not(structure, *only));
    }
    for (const TraversalKind traversal : kValuesOf<TraversalKind>) {
        CHECK(std::ranges::any_of(kValuesOf<StructureKind>, [&](StructureKind s) { return !why_not(s, traversal); }));
    }
}

TEST_CASE("an invalid combination is refused with its reason") {
    constexpr bool cpu = false, gpu = true;
    const TraversalOptions on;
    const auto reason = [](const Combination& c, bool on_cuda) { return why_not(c, on_cuda).value_or(""); };
    using enum Distribution;
    CHECK(reason({StructureKind::Binned, TraversalKind::WhileWhile, on, OneAThread}, cpu).empty());
    CHECK(reason({StructureKind::Binned, TraversalKind::WhileWhile, on, Persistent}, gpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, TraversalKind::WhileWhile, on, Persistent}, cpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, TraversalKind::Kd, on, OneAThread}, cpu).empty());
    CHECK_FALSE(reason({StructureKind::KdSah, TraversalKind::IfIf, on, OneAThread}, cpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, TraversalKind::Wide8Simd, on, OneAThread}, gpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, TraversalKind::SkipLinks, {true, false}, OneAThread}, cpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, TraversalKind::RestartTrail, on, DynamicFetch}, gpu).empty());
    const TraversalOptions woop = {.tests = TestKind::Woop};
    CHECK(reason({StructureKind::Binned, TraversalKind::Speculative, woop, DynamicFetch}, gpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, TraversalKind::IfIf, woop, OneAThread}, cpu).empty());
    const TraversalOptions at_nodes = {.rta_at_pops = false};
    CHECK(reason({StructureKind::Binned, TraversalKind::Compressed, at_nodes, Persistent}, gpu).empty());
    CHECK_FALSE(reason({StructureKind::Binned, TraversalKind::WhileWhile, at_nodes, OneAThread}, cpu).empty());
}
