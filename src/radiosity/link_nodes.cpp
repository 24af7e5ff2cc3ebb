#include "radiosity/link_nodes.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/error.h"
#include "base/parallel_for.h"
#include "math/tree_sum.h"
#include "radiosity/row_maker.h"

namespace pertev {
namespace {

constexpr uint32_t kDirectRays = 32; // per quarter of a patch, and 16 to emitters
constexpr uint32_t kFirstBounces = 12;

struct Lit {
    double light = 0, area = 0; // W, m2
};

Lit operator+(Lit a, Lit b) { return {a.light + b.light, a.area + b.area}; }

/// Level of a triangle side's light: the exponent of the greatest power of 4 that is not above light / mean, from -6 to
/// 1.
int light_level(float light, double mean) {
    const double power = 0.5 * std::logb(static_cast<double>(light) / mean);
    return to_int(static_cast<float>(std::floor(power)), -6, 1);
}

/// Light that a node receives: independent of direction, and by direction.
struct Received {
    Rgb even;
    SentLight directed;
};

Received operator+(Received a, const Received& b) {
    a.even += b.even;
    a.directed.add(b.directed);
    return a;
}

} // namespace

LinkNodes::LinkNodes(const SolvedScene& scene, PatchTree coarse, float patch_size, const RadiositySettings& settings,
                     WorkWatch& watch)
    : scene_(scene), view_(scene.view()), seed_(settings.seed), patch_size_(patch_size), watch_(watch),
      tree_(std::move(coarse)) {
    PERTEV_CHECK(tree_.quads.empty());
    first_rows_.resize(tree_.patches.size());
    add_patches();
    spread_first_light();
    const double mean = mean_of_lit(irradiance_);
    std::vector<uint32_t> faces;
    std::vector<Ball> balls;
    std::vector<Vec3> normals;
    std::vector<int> levels;
    for (uint32_t face = 0; face < tree_.roots.size(); ++face) {
        if (tree_.roots[face] == kNoPatch) continue;
        faces.push_back(face);
        balls.push_back(shape(tree_.roots[face]).ball);
        normals.push_back(shape(tree_.roots[face]).normal);
        levels.push_back(mean > 0 ? light_level(luminance(irradiance_[number_of(tree_.roots[face])]), mean) : 0);
    }
    clusters_ = make_clusters(faces, balls, normals, levels);
    area_before_ = {0};
    for (const uint32_t face : clusters_.faces) {
        area_before_.push_back(area_before_.back() + static_cast<double>(shape(tree_.roots[face]).area));
    }
    cluster_sent_.resize(clusters_.clusters.size());
    cluster_received_.resize(clusters_.clusters.size());
    cluster_gathered_.resize(clusters_.clusters.size());
    max_sent_.resize(clusters_.clusters.size());
    pass_on();
}

void LinkNodes::spread_first_light() {
    const std::size_t count = tree_.patches.size();
    for (uint32_t k = 0; k < kFirstBounces && !watch_.is_over(); ++k) {
        parallel_for(count, 64, [&](uint64_t i) { gathered_[i] = pertev::gather(first_rows_[i], patch_sent_); });
        parallel_for(count, 4096, [&](uint64_t i) {
            irradiance_[i] = direct_[i] + gathered_[i];
            patch_sent_[i] = tree_.patches[i].reflectance * irradiance_[i];
        });
    }
    std::vector<std::vector<FormFactor>>().swap(first_rows_);
}

NodeCode LinkNodes::code_of_cluster(uint32_t number) const {
    const Cluster& cluster = clusters_.clusters[number];
    return cluster.count == 1 ? tree_.roots[clusters_.faces[cluster.first]] : kIsCluster | number;
}

PatchCode LinkNodes::triangle_at(const Cluster& cluster, double u) const {
    const double first = area_before_[cluster.first], last = area_before_[cluster.first + cluster.count];
    const auto begin = area_before_.begin() + cluster.first + 1;
    const auto found = std::upper_bound(begin, begin + cluster.count - 1, first + u * (last - first));
    return tree_.roots[clusters_.faces[cluster.first + static_cast<uint32_t>(found - begin)]];
}

float LinkNodes::area(NodeCode code) const {
    if (!is_cluster(code)) return shape(code).area;
    const Cluster& c = cluster(code);
    return static_cast<float>(area_before_[c.first + c.count] - area_before_[c.first]);
}

Rgb LinkNodes::power_towards(NodeCode code, Vec3 direction) const {
    if (is_cluster(code)) return cluster_sent_[cluster_of(code)].towards(direction);
    const LinkedPatch& from = shape(code);
    return (from.area * max(dot(from.normal, direction), 0.0f)) * sent(code);
}

Rgb LinkNodes::power(NodeCode code) const {
    return is_cluster(code) ? cluster_sent_[cluster_of(code)].all : shape(code).area * sent(code);
}

double LinkNodes::mean_of_lit(std::span<const Rgb> light) const {
    const Lit lit = tree_sum(light.size(), [&](uint64_t i) -> Lit {
        if (is_black(light[i])) return {};
        const float area = tree_.patches[i].area;
        return {static_cast<double>(area * luminance(light[i])), static_cast<double>(area)};
    });
    return lit.area > 0 ? lit.light / lit.area : 0;
}

double LinkNodes::sweep(std::span<const Link> links) {
    gather(links);
    return pass_on();
}

double LinkNodes::pass_on() {
    const std::size_t faces = clusters_.faces.size();
    // A cluster's number is less than those of its halves.
    std::vector<Rgb> above(faces);
    for (const Cluster& cluster : clusters_.clusters) {
        const auto number = static_cast<std::size_t>(&cluster - clusters_.clusters.data());
        if (cluster.count == 1) {
            const Vec3 normal = shape(tree_.roots[clusters_.faces[cluster.first]]).normal;
            above[cluster.first] = cluster_gathered_[number] + cluster_received_[number].towards(normal);
            continue;
        }
        for (const uint32_t half : {cluster.left, cluster.right}) {
            cluster_gathered_[half] += cluster_gathered_[number];
            cluster_received_[half].add(cluster_received_[number]);
        }
    }
    std::vector<Pushed> pushed(faces);
    parallel_for(faces, 64, [&](uint64_t i) { pushed[i] = push(tree_.roots[clusters_.faces[i]], above[i]); });
    send();
    const Pushed sum = tree_sum(faces, [&](uint64_t i) -> const Pushed& { return pushed[i]; });
    return sum.all > 0 ? sum.changed / sum.all : 0;
}

void LinkNodes::gather(std::span<const Link> links) {
    std::ranges::fill(gathered_, Rgb{});
    std::ranges::fill(quad_gathered_, Rgb{});
    std::ranges::fill(cluster_gathered_, Rgb{});
    std::ranges::fill(cluster_received_, SentLight{});
    parallel_for_ranges(links.size(), 1024, [&](uint64_t begin, uint64_t end) {
        // Links of a receiver belong to the range of its first one.
        while (begin > 0 && begin < end && links[begin].receiver == links[begin - 1].receiver) ++begin;
        while (begin < end) {
            uint64_t last = begin + 1;
            while (last < links.size() && links[last].receiver == links[begin].receiver) ++last;
            receive(links[begin].receiver, links.subspan(begin, last - begin));
            begin = last;
        }
    });
}

void LinkNodes::receive(NodeCode receiver, std::span<const Link> links) {
    const Ball& here = ball(receiver);
    if (is_cluster(receiver)) {
        const Received received = tree_sum(links.size(), [&](uint64_t i) -> Received {
            const Link& link = links[i];
            const Ball& there = ball(link.source);
            if (!(link.factor > 0)) return {};
            if (balls_meet(here, there)) return {link.factor * power(link.source), {}};
            const Vec3 direction = normalize(there.centre - here.centre);
            Received of;
            of.directed.add(direction, link.factor * power_towards(link.source, -direction));
            return of;
        });
        cluster_gathered_[cluster_of(receiver)] = received.even;
        cluster_received_[cluster_of(receiver)] = received.directed;
        return;
    }
    const Rgb received = tree_sum(links.size(), [&](uint64_t i) -> Rgb {
        const Link& link = links[i];
        if (!(link.factor > 0)) return {};
        if (!is_cluster(link.source)) return link.factor * sent(link.source);
        const Ball& there = ball(link.source);
        if (balls_meet(here, there)) return link.factor * power(link.source);
        return link.factor * power_towards(link.source, -normalize(there.centre - here.centre));
    });
    (is_patch(receiver) ? gathered_[number_of(receiver)] : quad_gathered_[receiver]) = received;
}

/// Pushes and pulls light in a tree of parts: each part of a quad receives the quad's gathered light, and the quad's
/// radiosity is the mean of its parts'.
LinkNodes::Pushed LinkNodes::push(PatchCode code, Rgb above) {
    if (is_patch(code)) {
        const uint32_t i = number_of(code);
        const Patch& patch = tree_.patches[i];
        irradiance_[i] = direct_[i] + above + gathered_[i];
        const Rgb sent = patch.reflectance * irradiance_[i];
        const float change = abs(luminance(sent) - luminance(patch_sent_[i]));
        patch_sent_[i] = sent;
        return {sent, static_cast<double>(patch.area * change), static_cast<double>(patch.area * luminance(sent))};
    }
    const Rgb received = above + quad_gathered_[code];
    Pushed sum = tree_sum(4, [&](uint64_t k) { return push(tree_.quads[code].child[k], received); });
    quad_sent_[code] = sum.sent = 0.25f * sum.sent;
    return sum;
}

void LinkNodes::send() {
    for (std::size_t i = clusters_.clusters.size(); i-- > 0;) {
        const Cluster& cluster = clusters_.clusters[i];
        cluster_sent_[i] = {};
        if (cluster.count == 1) {
            const PatchCode face = tree_.roots[clusters_.faces[cluster.first]];
            cluster_sent_[i].add(shape(face).normal, shape(face).area * sent(face));
            max_sent_[i] = luminance(sent(face));
        } else {
            cluster_sent_[i].add(cluster_sent_[cluster.left]);
            cluster_sent_[i].add(cluster_sent_[cluster.right]);
            max_sent_[i] = max(max_sent_[cluster.left], max_sent_[cluster.right]);
        }
    }
}

std::size_t LinkNodes::index_of(NodeCode code) const {
    if (is_cluster(code)) return cluster_of(code);
    const std::size_t clusters = clusters_.clusters.size();
    return is_patch(code) ? clusters + tree_.quads.size() + number_of(code) : clusters + code;
}

void LinkNodes::sort(std::vector<Link>& links) const {
    std::vector<uint32_t> next(index_count() + 1);
    for (const Link& link : links) ++next[index_of(link.receiver) + 1];
    for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
    std::vector<Link> sorted(links.size());
    for (const Link& link : links) sorted[next[index_of(link.receiver)]++] = link;
    links = std::move(sorted);
}

void LinkNodes::divide(std::span<const uint8_t> requested) {
    became_.assign(requested.size(), kNoPatch);
    for (uint32_t i = 0; i < requested.size(); ++i) {
        if (requested[i] == 0 || tree_.patches.size() + 3 > kMaxPatches) continue;
        const auto quad = static_cast<uint32_t>(tree_.quads.size());
        quad_shapes_.push_back(patch_shapes_[i]);
        quad_patches_.push_back(tree_.patches[i]);
        quad_sent_.push_back(patch_sent_[i]);
        quad_gathered_.push_back({});
        tree_.split(view_, i);
        const Rgb direct = direct_[i]; // the whole's, until theirs is found: where that is ended it is not black
        const float spread = direct_spread_[i];
        direct_.resize(tree_.patches.size(), direct);
        direct_spread_.resize(tree_.patches.size(), spread);
        became_[i] = quad;
        patch_shapes_[i] = linked_patch(view_, tree_.patches[i]);
        stale_.push_back(i);
    }
    add_patches();
}

void LinkNodes::add_patches() {
    for (auto i = static_cast<uint32_t>(patch_shapes_.size()); i < tree_.patches.size(); ++i) {
        patch_shapes_.push_back(linked_patch(view_, tree_.patches[i]));
        stale_.push_back(i);
    }
    direct_.resize(tree_.patches.size());
    direct_spread_.resize(tree_.patches.size());
    gathered_.resize(tree_.patches.size());
    irradiance_.resize(tree_.patches.size());
    patch_sent_.resize(tree_.patches.size());
    const RadiositySettings whole = {.rays = 2 * kDirectRays, .seed = seed_},
                            quarter = {.rays = kDirectRays, .seed = seed_};
    const RowMakers of_whole(scene_, tree_, whole, &watch_), of_quarter(scene_, tree_, quarter, &watch_);
    watch_.begin("direct light", stale_.size());
    std::atomic<uint64_t> found{0};
    parallel_for_ranges(stale_.size(), 8, [&](uint64_t begin, uint64_t end) {
        const std::unique_ptr<RowMaker> makers[] = {of_whole.for_thread(), of_quarter.for_thread()};
        for (uint64_t k = begin; k < end && !watch_.is_over(); ++k) {
            if (!find_direct(stale_[k], *makers[0], *makers[1])) break;
            ++found;
            watch_.done();
        }
    });
    if (tree_.quads.empty() && !stale_.empty()) { // parts have that of their whole
        without_direct_ = 1 - static_cast<double>(found) / static_cast<double>(stale_.size());
    }
    stale_.clear();
}

/// Finds the direct light of a patch that may be divided, per quarter, to decide whether it should be. Returns false,
/// with the patch unchanged, if the watch was over meanwhile, because rows are then incomplete.
bool LinkNodes::find_direct(uint32_t number, RowMaker& of_whole, RowMaker& of_quarter) {
    const Patch& patch = tree_.patches[number];
    const uint32_t parts = can_divide(kIsPatch | number) ? 4 : 1;
    Rgb sum;
    float least = kInfinity, most = 0;
    FormFactorRow row, first;
    for (uint32_t k = 0; k < parts; ++k) {
        Patch part = patch;
        if (parts > 1) part.corners = patch.corners.child(k);
        const uint32_t key = hash_words(number, static_cast<uint32_t>(tree_.quads.size()), k, 0x64697265u).x;
        (parts > 1 ? of_quarter : of_whole).make(part, key, row);
        Rgb light = row.direct;
        for (const FormFactor& from : row.factors) {
            light += from.factor * tree_.patches[from.patch].exitance;
            first.factors.push_back({from.patch, from.factor / static_cast<float>(parts)});
        }
        sum += light;
        least = min(least, luminance(light)), most = max(most, luminance(light));
    }
    if (watch_.is_over()) return false;
    direct_[number] = (1.0f / static_cast<float>(parts)) * sum;
    direct_spread_[number] = most - least;
    patch_sent_[number] = patch.reflectance * direct_[number];
    if (!first_rows_.empty()) {
        first.sort();
        first_rows_[number].assign(first.factors.begin(), first.factors.end());
    }
    return true;
}

std::size_t LinkNodes::max_first_bytes(uint64_t faces) {
    return faces * (sizeof(std::vector<FormFactor>) + kOfAllocation + 4 * (kDirectRays + 16) * sizeof(FormFactor));
}

std::size_t LinkNodes::bytes() const { return max_bytes(tree_.patches.size(), clusters_.faces.size()); }

std::size_t LinkNodes::max_bytes(uint64_t patches, uint64_t faces) {
    const uint64_t quads = patches / 3 + 1, clusters = 2 * faces;
    return (patches + quads) * (sizeof(LinkedPatch) + sizeof(Patch) + 5 * sizeof(Rgb) + 2 * sizeof(uint32_t)) +
           clusters * (sizeof(Cluster) + 2 * sizeof(SentLight) + 2 * sizeof(Rgb) + sizeof(uint32_t)) +
           faces * (3 * sizeof(double) + sizeof(Rgb));
}

} // namespace pertev
