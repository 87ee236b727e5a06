// What libFuzzer calls, for the format that the build names.
#include "tests/fuzz/fuzz_case.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  twopass::run_fuzz_case(twopass::FuzzFormat::TWOPASS_FUZZ_FORMAT, {reinterpret_cast<const char*>(data), size});
  return 0;
}
