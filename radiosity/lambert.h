// The form factor from a differential element to a polygon: Lambert's sum over the edges. No visibility.
#pragma once

#include "radiosity/polygon.h"

namespace twopass {

/// The form factor from the differential element at `p` with unit normal `n` to the front of `source`, in [0,
/// 1]: the fraction of the element's diffuse power that arrives there when nothing is in between. The part of
/// the source below the element's horizon does not count; 0 if `p` is not strictly in front of the source's
/// plane. Equation (R2); relative error about 1e-15 times distance / size of the source. REQUIRES: `n` has unit
/// length.
double point_form_factor(const V3d& p, const V3d& n, const Polygon& source);

/// The same without asking on which side of the source `p` lies, and without the clamp: for callers that have
/// clipped both polygons against each other. Negative if the source shows its back.
double signed_point_form_factor(const V3d& p, const V3d& n, const Polygon& source);

}  // namespace twopass
