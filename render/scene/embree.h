// Embree 3 or 4, whichever there is; internal to the ray caster.
#pragma once

#if TWOPASS_EMBREE_VERSION >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
