// Wavefront MTL files as plain records: what each statement says, checked, nothing interpreted yet.
//
// The statements are those of the 1995 specification (Wavefront, "The Advanced Visualizer", appendix B2) and of
// the PBR extension that exporters agree on (Clara.io: Pr Pm Ps Pc Pcr aniso anisor and their maps, norm).
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "render/core/types.h"
#include "render/load/notes.h"

namespace twopass {

/// A texture statement: a file and its options. A texture value t is used as base + gain t, at the texture
/// coordinates scale (u, v) + offset.
struct MtlMap {
  std::string file;
  std::uint32_t line = 0;          ///< in the MTL file, counted from 1
  V2f offset{0.0f}, scale{1.0f};   ///< -o, -s
  float base = 0.0f, gain = 1.0f;  ///< -mm
  float bump = 1.0f;               ///< -bm
  bool clamp = false;              ///< -clamp on: nothing beyond the unit square's border repeats
  bool nearest = false;            ///< -blendu off and -blendv off
  char channel = 0;                ///< -imfchan: r, g, b, m (matte), l (luminance), z; 0: not given
};

/// One material; what the file does not say is unset.
struct MtlRecord {
  std::string name;
  std::uint32_t line = 0;
  std::optional<C3f> kd, ks, ke, tf;
  std::optional<float> ns, ni;
  std::optional<float> d;  ///< opacity: d, or else 1 - Tr
  std::optional<int> illum;
  std::optional<float> pr, pm, ps, pc, pcr, aniso;
  std::optional<MtlMap> map_kd, map_ks, map_ke, map_d, map_ns, map_bump, norm, map_pr, map_pm, map_ps;
};

/// The materials of MTL text whose names are `wanted`, by name; of several definitions of a name, the first.
/// `file` is the text's name in errors and notes. Throws Error with file:line for malformed, negative and
/// infinite numbers. What our materials cannot express is left out and counted in notes, by keyword.
std::map<std::string, MtlRecord> parse_mtl(std::string_view text, const std::string& file,
                                           const std::set<std::string>& wanted, Notes& notes);

}  // namespace twopass
