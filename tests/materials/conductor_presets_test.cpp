// Conductors by name: the physics of the well-known metals, and errors that help.
#include "materials/conductor_presets.h"

#include <gtest/gtest.h>

#include "materials/fresnel.h"
#include "render/core/error.h"

namespace twopass {
namespace {

C3f reflectance(std::string_view name) {
  const ConductorIndex index = conductor_index_of(name, "here");
  return fresnel_conductor(1.0f, index.eta, index.k);
}

// Palik 1985 gives at 650, 550 and 450 nm about: Ag 0.98 0.98 0.97, Al 0.91 0.92 0.92, Au 0.97 0.82 0.39,
// Cu 0.95 0.66 0.56.
TEST(ConductorPresets, MetalsReflectAsMeasured) {
  const struct {
    const char* name;
    C3f reflectance;
  } metals[] = {{"Ag", C3f(0.98f, 0.97f, 0.94f)},
                {"Al", C3f(0.92f, 0.92f, 0.92f)},
                {"Au", C3f(0.97f, 0.80f, 0.36f)},
                {"Cu", C3f(0.95f, 0.62f, 0.53f)}};
  for (const auto& metal : metals)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(reflectance(metal.name)[k], metal.reflectance[k], 0.04f) << metal.name << ' ' << k;
}

TEST(ConductorPresets, NoneIsAMirror) { EXPECT_EQ(reflectance("none"), C3f(1.0f)); }

TEST(ConductorPresets, PalikIsKnownByBothNames) {
  EXPECT_EQ(conductor_index_of("TiN", "here").eta, conductor_index_of("TiN_palik", "here").eta);
  EXPECT_NE(conductor_index_of("Cu", "here").eta, conductor_index_of("Cu_palik", "here").eta);
}

TEST(ConductorPresets, AllAreAbsorbingMedia) {
  for (const char* name :
       {"a-C",        "Ag",       "Al",         "AlAs",     "AlAs_palik", "AlSb",     "AlSb_palik", "Au",
        "Be",         "Be_palik", "Cr",         "CsI",      "CsI_palik",  "Cu",       "Cu_palik",   "Cu2O",
        "Cu2O_palik", "CuO",      "CuO_palik",  "d-C",      "d-C_palik",  "Hg",       "Hg_palik",   "HgTe",
        "HgTe_palik", "Ir",       "Ir_palik",   "K",        "K_palik",    "Li",       "Li_palik",   "MgO",
        "MgO_palik",  "Mo",       "Mo_palik",   "Na_palik", "Nb",         "Nb_palik", "Ni_palik",   "Rh",
        "Rh_palik",   "Se",       "Se_palik",   "SiC",      "SiC_palik",  "SnTe",     "SnTe_palik", "Ta",
        "Ta_palik",   "Te",       "Te_palik",   "ThF4",     "ThF4_palik", "TiC",      "TiC_palik",  "TiN",
        "TiN_palik",  "TiO2",     "TiO2_palik", "VC",       "VC_palik",   "V_palik",  "VN",         "VN_palik",
        "W",          "none"}) {
    const ConductorIndex index = conductor_index_of(name, "here");
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(index.eta[k] >= 0.0f && index.k[k] >= 0.0f) << name;
      EXPECT_TRUE(index.eta[k] < 8.0f && index.k[k] < 10.0f) << name;
      EXPECT_TRUE(reflectance(name)[k] <= 1.0f) << name;
    }
  }
}

TEST(ConductorPresets, UnknownNamesListTheKnown) {
  try {
    conductor_index_of("Ag_palik", "scene.xml:7");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("scene.xml:7"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("VN_palik"), std::string::npos);
  }
}

}  // namespace
}  // namespace twopass
