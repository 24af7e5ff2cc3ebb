// Written by tools/make_metals.py from refractiveindex.info (CC0): name, eta, k, file.
// clang-format off
{"aluminium", {1.5003f, 0.98485f, 0.60511f}, {7.6497f, 6.548f, 5.3468f}}, // main/Al/nk/Rakic
{"beryllium", {3.4558f, 3.339f, 3.0571f}, {3.1775f, 3.1507f, 3.1405f}}, // main/Be/nk/Rakic-LD
{"brass", {0.46021f, 0.52279f, 1.1255f}, {4.2719f, 2.668f, 1.8105f}}, // other/alloys/Cu-Zn/nk/Querry-Cu70Zn30
{"chromium", {3.247f, 3.1147f, 2.2856f}, {3.2865f, 3.3363f, 3.117f}}, // main/Cr/nk/Johnson
{"cobalt", {2.2579f, 2.0354f, 1.7135f}, {4.2284f, 3.7946f, 3.2381f}}, // main/Co/nk/Johnson
{"copper", {0.22533f, 1.0447f, 1.2957f}, {3.419f, 2.625f, 2.3624f}}, // main/Cu/nk/Johnson
{"gold", {0.041301f, 0.49737f, 1.4723f}, {5.653f, 2.256f, 1.7764f}}, // main/Au/nk/Johnson
{"iron", {2.923f, 2.9195f, 2.5464f}, {3.0773f, 2.9372f, 2.75f}}, // main/Fe/nk/Johnson
{"mercury", {2.0503f, 1.5195f, 1.0251f}, {5.3122f, 4.606f, 3.7954f}}, // main/Hg/nk/Inagaki
{"nickel", {2.0346f, 1.9034f, 1.7288f}, {4.2024f, 3.5703f, 2.8961f}}, // main/Ni/nk/Johnson
{"palladium", {1.7967f, 1.6219f, 1.3959f}, {4.366f, 3.8119f, 3.2128f}}, // main/Pd/nk/Johnson
{"platinum", {2.3527f, 2.0754f, 1.8326f}, {4.2399f, 3.668f, 3.0956f}}, // main/Pt/nk/Rakic-LD
{"silver", {0.056605f, 0.05502f, 0.043164f}, {4.4918f, 3.549f, 2.5903f}}, // main/Ag/nk/Johnson
{"tantalum", {1.0638f, 1.1317f, 1.2618f}, {5.9039f, 4.8369f, 3.9117f}}, // main/Ta/nk/Werner
{"titanium", {2.749f, 2.5078f, 2.2403f}, {3.8441f, 3.3974f, 3.0147f}}, // main/Ti/nk/Johnson
{"tungsten", {3.6944f, 3.442f, 3.3556f}, {2.9422f, 2.7332f, 2.5099f}}, // main/W/nk/Rakic-LD
{"vanadium", {3.4811f, 3.9617f, 3.6143f}, {2.9835f, 3.0757f, 3.4753f}}, // main/V/nk/Johnson
