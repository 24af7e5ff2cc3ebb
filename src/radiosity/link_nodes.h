#pragma once

// What links are between, and the light of it: clusters of triangles above, triangles, their patches and the patches
// that these were divided into below. Light that a cluster receives is kept by direction, in the three sums that what
// it sends is kept in too, so that each triangle below takes what its normal makes of it.
//
// Sources: clusters that send and receive: Sillion, "A Unified Hierarchical Algorithm for Global Illumination with
// Scattering Volumes and Object Clusters", IEEE TVCG 1(3), 1995; their light by direction: Christensen, Lischinski,
// Stollnitz, Salesin, "Clustering for Glossy Global Illumination", ACM TOG 16(1), 1997.

#include <span>
#include <vector>

#include "radiosity/cluster_tree.h"
#include "radiosity/form_factor_row.h"
#include "radiosity/link_oracle.h"
#include "radiosity/links.h"
#include "radiosity/radiosity_settings.h"
#include "radiosity/solved_scene.h"
#include "radiosity/work_watch.h"

namespace pertev {

class RowMaker;

class LinkNodes {
public:
    /// `coarse`: whole triangles. No patch whose edges are shorter than `patch_size` (metres) will be divided. `scene`
    /// and `watch` outlive it.
    LinkNodes(const SolvedScene& scene, PatchTree coarse, float patch_size, const RadiositySettings& settings,
              WorkWatch& watch);

    /// All of the scene; of a scene of one triangle side the patch itself.
    NodeCode root() const { return code_of_cluster(0); }
    /// The cluster, or its triangle where it has but one.
    NodeCode code_of_cluster(uint32_t cluster) const;
    const Cluster& cluster(NodeCode code) const { return clusters_.clusters[cluster_of(code)]; }
    const Ball& ball(NodeCode code) const { return is_cluster(code) ? cluster(code).ball : shape(code).ball; }
    const LinkedPatch& shape(PatchCode code) const {
        return is_patch(code) ? patch_shapes_[number_of(code)] : quad_shapes_[code];
    }
    const Patch& patch(PatchCode code) const {
        return is_patch(code) ? tree_.patches[number_of(code)] : quad_patches_[code];
    }
    const PatchQuad& quad(PatchCode code) const { return tree_.quads[code]; }
    const PatchTree& tree() const { return tree_; }
    /// The triangle, of those of a cluster, that has the share `u` in [0, 1) of their area before it.
    PatchCode triangle_at(const Cluster& cluster, double u) const;
    /// Half of it is that of backs.
    float area(NodeCode code) const;

    /// Reflected light that leaves it, W/m2; of a cluster the most that any of its triangles has.
    Rgb sent(PatchCode code) const { return is_patch(code) ? patch_sent_[number_of(code)] : quad_sent_[code]; }
    float most_sent(NodeCode code) const {
        return is_cluster(code) ? most_sent_[cluster_of(code)] : luminance(sent(code));
    }
    /// Sum of A B max(cosine, 0) towards `direction` (unit), W; and without the cosine.
    Rgb power_towards(NodeCode code, Vec3 direction) const;
    Rgb power(NodeCode code) const;

    /// Of patches that light reaches by way of no surface, its mean. W/m2, luminance.
    float mean_direct() const { return static_cast<float>(mean_of_lit(direct_)); }
    bool can_divide(NodeCode code) const {
        return is_cluster(code) || !is_patch(code) || shape(code).longest > patch_size_;
    }
    /// Patches over which that light changes by more than `limit`, W/m2.
    bool direct_changes(uint32_t patch, float limit) const { return direct_spread_[patch] > limit; }

    /// Gathers over all links, which lie in receivers' order, and passes light down and up. Returns the share of the
    /// light that has changed.
    double sweep(std::span<const Link> links);

    /// Share of the patches that direct light was not found for at the beginning, as the watch was over: they are
    /// black.
    double without_direct() const { return without_direct_; }

    /// Puts links in receivers' order: those of one stay in theirs.
    void sort(std::vector<Link>& links) const;

    /// Divides patches with a wish, [patches].
    void divide(std::span<const uint8_t> wishes);
    /// A link from before the last divide(): of what its patches have become.
    Link after_division(Link link) const {
        link.receiver = now(link.receiver);
        link.source = now(link.source);
        return link;
    }

    const std::vector<Rgb>& irradiance() const { return irradiance_; } // [patches] W/m2
    const std::vector<Rgb>& direct() const { return direct_; }         // of it, by way of no surface
    PatchTree take_tree() { return std::move(tree_); }
    std::size_t bytes() const;
    /// Of so many patches and triangle sides, at most.
    static std::size_t most_bytes(uint64_t patches, uint64_t faces);
    /// And beside these while it is made, before there are links.
    static std::size_t most_first_bytes(uint64_t faces);

private:
    NodeCode now(NodeCode code) const {
        if (!is_patch(code) || number_of(code) >= became_.size()) return code;
        const PatchCode quad = became_[number_of(code)];
        return quad == kNoPatch ? code : quad;
    }
    std::size_t index_of(NodeCode code) const;
    std::size_t index_count() const { return clusters_.clusters.size() + tree_.quads.size() + tree_.patches.size(); }
    void add_patches();
    /// Light by way of surfaces, before there are links: by the rays that found the direct light. About, but good for
    /// telling what is lit from what lies in walls and pillars; links then begin with what is sent by it.
    void spread_first_light();
    double mean_of_lit(std::span<const Rgb> light) const; // [patches]; 0: all is black
    bool find_direct(uint32_t patch, RowMaker& of_whole, RowMaker& of_quarter);
    void gather(std::span<const Link> links);
    double pass_on();
    void receive(NodeCode receiver, std::span<const Link> links);
    /// Of a patch, or of all in a tree of them: radiosity, W/m2, and what leaves it and has changed of that, W.
    struct Pushed {
        Rgb sent;
        double changed = 0, all = 0;
    };
    friend Pushed operator+(const Pushed& a, const Pushed& b) {
        return {a.sent + b.sent, a.changed + b.changed, a.all + b.all};
    }
    Pushed push(PatchCode code, Rgb above);
    void send();

    const SolvedScene& scene_;
    const SceneView& view_;
    uint32_t seed_;
    float patch_size_;
    WorkWatch& watch_;
    PatchTree tree_;
    ClusterTree clusters_;
    std::vector<double> area_before_; // [triangles of clusters_ + 1] m2
    std::vector<LinkedPatch> patch_shapes_, quad_shapes_;
    std::vector<Patch> quad_patches_;                                                          // what quads were
    std::vector<Rgb> direct_, gathered_, irradiance_, patch_sent_, quad_gathered_, quad_sent_; // W/m2
    std::vector<float> direct_spread_;                                                         // luminance, W/m2
    std::vector<SentLight> cluster_sent_, cluster_received_; // the latter W/m2, by where it comes from
    std::vector<Rgb> cluster_gathered_;                      // from everywhere alike, W/m2
    std::vector<float> most_sent_;
    std::vector<PatchCode> became_;                   // [patches] quads
    std::vector<uint32_t> stale_;                     // patches whose direct light is to be found
    std::vector<std::vector<FormFactor>> first_rows_; // [patches] until there are links
    double without_direct_ = 0;
};

} // namespace pertev
