// How much memory there is for this process.
#pragma once

namespace twopass {

/// Bytes that the process may have at most: the machine's memory, or less where a control group (as of a
/// scheduler's job) or `ulimit -v` says so. Infinity where nothing is known.
double memory_limit_bytes();

}  // namespace twopass
