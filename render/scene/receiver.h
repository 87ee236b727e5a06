// A point that receives light, as far as choosing lights and points of them is concerned.
#pragma once

#include "render/core/types.h"

namespace twopass {

struct Receiver {
  V3f position;
  V3f normal;       ///< unit shading normal on the side that receives
  bool is_diffuse;  ///< reflects by the cosine alone, and nothing from below; else light from both sides counts
};

}  // namespace twopass
