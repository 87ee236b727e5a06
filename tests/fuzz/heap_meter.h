// How much memory the process has asked for and not given back.
#pragma once

#include <cstddef>

namespace twopass {

/// Forgets the peak: it is what is in use now.
void reset_heap_peak();
/// Most bytes in use since then, less those that were in use then. Under libFuzzer all of malloc, else what
/// operator new gives.
std::size_t heap_growth();

}  // namespace twopass
