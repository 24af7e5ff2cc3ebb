"""Ways to break lobes with parameters of OpenPBR and of other renderers (see mutations.py)."""

MUTATIONS = [
    ("dispersion without the density of two channels", "statistical/openpbr_lobes",
     ("src/shading/lobes/glass_lobe.h", "pdf += (1.0f / 3.0f) * value.pdf;", "pdf = value.pdf;")),
    ("all colours refracted as red", "statistical/openpbr_lobes",
     ("src/shading/lobes/glass_lobe.h", "static_cast<float>(channel - 1) * spread", "-1.0f * spread")),
    ("a weight of the reflection that leaves it at grazing angles", "statistical/bsdf_energy",
     ("src/shading/make_reflection.h", "SpecularLobe{p.base_color, metal, alpha_from_roughness(p.roughness), f0, p.weight}", "SpecularLobe{p.base_color, metal, alpha_from_roughness(p.roughness), f0, 1}")),
    ("rough diffuse without the light of further bounces", "statistical/openpbr_lobes",
     ("src/shading/lobes/rough_diffuse_lobe.h", "+ more * tint_of_more(once);", "+ 0.0f * more * tint_of_more(once);")),
    ("rough diffuse sampled as if its cosine were not clipped", "statistical/bsdf_sampling",
     ("src/shading/lobes/rough_diffuse_lobe.h", "max(h.z, 0.0f) * kInvPi / cut;", "max(h.z, 0.0f) * kInvPi;")),
    ("rough diffuse gains light beneath a reflection", "statistical/openpbr_lobes",
     ("src/shading/lobes/rough_diffuse_lobe.h", "(1.0f - 0.008f * roughness)", "(1.0f + 0.008f * roughness)")),
    ("an F82 tint at another angle", "statistical/openpbr_lobes", ("src/shading/lobes/fresnel.h", "cos_o * w * (1.0f - cos_o)", "cos_o * w")),
    ("a tint that is lost on the way to the lobe", "statistical/openpbr_lobes", ("src/shading/lobes/packed_lobes.h", "surface(lobe.widths, lobe.film, lobe.tint)", "surface(lobe.widths, lobe.film)")),
    ("Beckmann's microfacets masked as GGX's", "statistical/mitsuba_lobes statistical/bsdf_sampling",
     ("src/shading/lobes/microfacets.h", "return is_beckmann ? beckmann::slope_length(", "return false ? beckmann::slope_length(")),
    ("Beckmann's microfacets compensated as GGX's", "statistical/openpbr_lobes",
     ("src/shading/lobes/microfacets.h", "(is_beckmann ? beckmann_lost(cosine, width)", "(false ? beckmann_lost(cosine, width)")),
    ("single scattering that is compensated", "statistical/mitsuba_lobes", ("src/shading/lobes/packed_lobes.h", "(widths.is_single ? kSingle : 0u)", "0u")),
    ("a measured metal with the numbers of another", "unit/set_materials", ("src/scene/metals.cpp", "std::ranges::find(kMetals, name, &MeasuredMetal::name)", "std::ranges::find_if(kMetals, [&](auto& m) { return m.name > name; })")),
]
