#include "lab/thesis_recipes.h"

#include <algorithm>

namespace pertev {
namespace {

constexpr Rgb kAmbient = {0.02f, 0.02f, 0.02f}; // so that unlit surfaces are not black

void add_ambient(RenderSettings& settings) { settings.ambient = kAmbient; }
template <RasterShading kShading>
void shade(RenderSettings& settings) {
    settings.look.shading = kShading;
    add_ambient(settings);
}
void draw_edges(RenderSettings& settings) { settings.look.is_wireframe = true; }
void take_few_photons(RenderSettings& settings) { settings.photon_map.photons = kThesisPhotons; }
void gather_directly(RenderSettings& settings) {
    take_few_photons(settings);
    settings.photon_map.gather = PhotonGather::Direct;
}
void gather_caustic(RenderSettings& settings) {
    settings.photon_map.photons = thesis_detail(settings.height).photons;
    settings.photon_map.gather = PhotonGather::Direct;
}

constexpr ThesisRecipe kRecipes[] = {
    {.name = "section-2.1-wireframe",
     .title = "rasterisation",
     .shows = "Wireframe: the edges of triangles alone, by Bresenham's lines with depth.",
     .scene = ThesisScene::PlasticBall,
     .integrator = "raster",
     .settings = "`wireframe`",
     .set = draw_edges},
    {.name = "section-2.1-flat",
     .title = "rasterisation",
     .shows = "Flat shading: light is found once a triangle. The ball shows its triangles. Nothing casts a shadow.",
     .scene = ThesisScene::PlasticBall,
     .integrator = "raster",
     .settings = "`ambient=0.02,0.02,0.02` `shading=flat`",
     .set = shade<RasterShading::Flat>},
    {.name = "section-2.1-gouraud",
     .title = "rasterisation",
     .shows = "Gouraud shading: light is found at the corners and interpolated. The ball's highlight is smeared over "
              "its triangles, and the walls lack the light in their middles.",
     .scene = ThesisScene::PlasticBall,
     .integrator = "raster",
     .settings = "`ambient=0.02,0.02,0.02` `shading=gouraud`",
     .set = shade<RasterShading::Gouraud>},
    {.name = "section-2.1-phong",
     .title = "rasterisation",
     .shows = "Phong shading: normals are interpolated and light is found in each pixel. The highlight is round.",
     .scene = ThesisScene::PlasticBall,
     .integrator = "raster",
     .settings = "`ambient=0.02,0.02,0.02` `shading=phong`",
     .set = shade<RasterShading::Phong>},
    {.name = "section-2.1-cast",
     .title = "ray casting",
     .shows = "One ray finds what a pixel shows, and a shadow ray whether the point light is seen from there.",
     .scene = ThesisScene::PlasticBall,
     .integrator = "cast",
     .settings = "`ambient=0.02,0.02,0.02`",
     .set = add_ambient},
    {.name = "section-2.1.3-whitted",
     .title = "Whitted's ray tracing",
     .shows = "Mirror and glass send rays on. Shadows are hard, also that of the glass; no light goes from wall to "
              "wall.",
     .scene = ThesisScene::TwoBalls,
     .integrator = "whitted",
     .settings = "`ambient=0.02,0.02,0.02`",
     .set = add_ambient},
    {.name = "figure-3.3",
     .title = "hard shadows",
     .shows = "A point light in the lamp's place, by ray casting.",
     .scene = ThesisScene::PointLight,
     .integrator = "cast",
     .is_whole = true},
    {.name = "figure-3.4",
     .title = "soft shadows",
     .shows = "The lamp itself, by distributed ray tracing: each sample asks another point of it.",
     .integrator = "distributed",
     .is_whole = true},
    {.name = "figure-3.6",
     .title = "indirect light alone",
     .shows = "What path tracing finds beyond the light that comes from the lamp itself.",
     .integrator = "indirect",
     .is_whole = true},
    {.name = "figure-3.7a",
     .title = "radiosity",
     .shows =
         "Progressive refinement after few steps, in each of which the patch with the most unsent light has sent it. "
         "What none of these sees is dark.",
     .way = ThesisWay::Radiosity,
     .integrator = "radiosity",
     .panel = {.is_early = true, .has_ambient = false, .is_flat = true}},
    {.name = "figure-3.7b",
     .title = "radiosity",
     .shows = "The same moment with ambient light: what is still unsent is shown as if it were spread evenly.",
     .way = ThesisWay::Radiosity,
     .integrator = "radiosity",
     .panel = {.is_early = true, .is_flat = true}},
    {.name = "figure-3.7c",
     .title = "radiosity",
     .shows = "Solved: all light has been sent, by Gauss-Seidel. Each patch has one light.",
     .way = ThesisWay::Radiosity,
     .integrator = "radiosity",
     .panel = {.is_flat = true}},
    {.name = "figure-3.7d",
     .title = "radiosity",
     .shows = "The same light, found anew in smaller patches where it changes, and interpolated between their corners.",
     .way = ThesisWay::Radiosity,
     .integrator = "radiosity"},
    {.name = "figure-3.8",
     .title = "the Cornell box with a mirror sphere",
     .shows = "Path tracing: what the sphere shows, and the light that it throws on wall and floor.",
     .scene = ThesisScene::MirrorBall,
     .integrator = "path",
     .is_whole = true},
    {.name = "figure-3.9a",
     .title = "photon map",
     .shows =
         "The photons of one pass, where surfaces keep them: each is a dot of the light that it makes its place send "
         "on. Those that come from the lamp itself are not kept: shadow rays find that light.",
     .way = ThesisWay::Photons,
     .integrator = "photon_map",
     .set = take_few_photons},
    {.name = "figure-3.9b",
     .title = "photon map",
     .shows = "The map looked up at the first surface: light is as blurred as the photons are sparse.",
     .integrator = "photon_map",
     .settings = "`gather=direct`",
     .set = gather_directly},
    {.name = "figure-3.9c",
     .title = "photon map",
     .shows = "Final gathering: one ray goes on from the first surface, and the map is looked up where it arrives.",
     .integrator = "photon_map",
     .set = take_few_photons},
    {.name = "figure-3.10a",
     .title = "the caustic under glass",
     .shows =
         "The photons of one pass as dots. Those that the ball of clear glass has sent on lie close together on the "
         "floor; the ball shows what lies behind it.",
     .way = ThesisWay::Photons,
     .scene = ThesisScene::Caustic,
     .integrator = "photon_map",
     .set = take_few_photons},
    {.name = "figure-3.10b",
     .title = "the caustic under glass",
     .shows = "The picture by photon maps: the caustic has a map of its own, whose photons are all aimed at the glass.",
     .scene = ThesisScene::Caustic,
     .integrator = "photon_map",
     .settings = "`gather=direct`",
     .set = gather_caustic,
     .stops = 3.5f},
    {.name = "chapter-3-bidirectional",
     .title = "bidirectional path tracing and irradiance caching",
     .shows = "Bidirectional path tracing: paths from the camera and from the lamp are joined.",
     .integrator = "bidirectional"},
    {.name = "chapter-3-irradiance-cache",
     .title = "bidirectional path tracing and irradiance caching",
     .shows = "Irradiance caching: what walls send each other is found at few places and interpolated between them.",
     .integrator = "irradiance_cache"},
    {.name = "figure-4.1a",
     .title = "points found in a tree",
     .shows =
         "The nearest twelve points to the cross, found in a kd-tree: each line is the plane of a node, through its "
         "point.",
     .way = ThesisWay::KdTree},
    {.name = "figure-4.1b",
     .title = "points found in a tree",
     .shows = "The points in a circle about the cross, found in an octree: each box holds the points of a node.",
     .way = ThesisWay::Octree},
    {.name = "chapter-4-bvh",
     .title = "what a ray tests in three structures",
     .shows = "Bounding volume hierarchy by the surface area heuristic.",
     .way = ThesisWay::Work,
     .scene = ThesisScene::MirrorBall},
    {.name = "chapter-4-kd-tree",
     .title = "what a ray tests in three structures",
     .shows = "kd-tree by the surface area heuristic.",
     .way = ThesisWay::Work,
     .scene = ThesisScene::MirrorBall,
     .structure = StructureKind::KdSah},
    {.name = "chapter-4-octree",
     .title = "what a ray tests in three structures",
     .shows = "Octree.",
     .way = ThesisWay::Work,
     .scene = ThesisScene::MirrorBall,
     .structure = StructureKind::Octree},
};

} // namespace

std::span<const ThesisRecipe> thesis_recipes() { return kRecipes; }

ThesisDetail thesis_detail(uint32_t panel_height) {
    constexpr uint32_t kFullHeight = 384; // height of a panel at 1024x768
    constexpr uint32_t kFinestMm = 80, kEarlySteps = 200, kFullPhotons = 1u << 16;
    const uint32_t mm = std::clamp(kFinestMm * kFullHeight / std::max(1u, panel_height), kFinestMm, 4 * kFinestMm);
    const uint32_t area = mm * mm, finest = kFinestMm * kFinestMm;
    return {static_cast<float>(mm) / 1000, kEarlySteps * finest / area, kFullPhotons * finest / area};
}

} // namespace pertev
