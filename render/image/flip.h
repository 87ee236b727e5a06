// FLIP: how visible the difference between two pictures is to somebody who flips between them.
//
// Source: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astrom, Fairchild, "FLIP: A Difference Evaluator for
// Alternating Images", PACMCGIT 3(2), 2020 (LDR); Andersson, Nilsson, Shirley, Akenine-Moeller, "Visualizing
// Errors in Rendered High Dynamic Range Images", Eurographics short papers, 2021 (HDR).
#pragma once

#include <span>
#include <vector>

#include "render/core/types.h"

namespace twopass {

/// Pixels per degree of vision, quoted as 67 in both papers: a 0.7 m wide display of 3840 pixels at 0.7 m.
inline constexpr float flip_pixels_per_degree = 67.0206f;

struct Flip {
  std::vector<float> map;  ///< error of each pixel, 0 equal to 1 as different as can be
  double mean = 0.0;
  float start_stops = 0.0f;  ///< range of the exposures, in stops; zero for LDR
  float stop_stops = 0.0f;
  int exposures = 1;
};

/// FLIP of two pictures as a display shows them: linear light of the sRGB primaries, clamped to [0,1].
/// REQUIRES: both hold width * height finite pixels.
Flip ldr_flip(std::span<const C3f> test, std::span<const C3f> reference, int width, int height);

/// HDR-FLIP of two linear Rec.709 pictures: the largest LDR-FLIP over exposures chosen from the reference, tone
/// mapped with the papers' approximation of ACES. REQUIRES: as above.
Flip hdr_flip(std::span<const C3f> test, std::span<const C3f> reference, int width, int height);

}  // namespace twopass
