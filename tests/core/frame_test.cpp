#include "render/core/frame.h"

#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "render/core/warp.h"

namespace twopass {
namespace {

TEST(Frame, IsOrthonormalAndRightHandedForEveryNormal) {
  for (std::uint32_t i = 0; i < 2000; ++i) {
    Sampler sampler(1, 0, i);
    V3f n = square_to_sphere(sampler.next_2d());
    if (i == 0) n = V3f(0, 0, 1);
    if (i == 1) n = V3f(0, 0, -1);
    const Frame frame(n);
    EXPECT_NEAR(frame.s.dot(frame.t), 0.0f, 1e-6f);
    EXPECT_NEAR(frame.s.dot(n), 0.0f, 1e-6f);
    EXPECT_NEAR(frame.s.length(), 1.0f, 1e-6f);
    EXPECT_NEAR((frame.s.cross(frame.t) - n).length(), 0.0f, 1e-6f);
    const V3f w(0.3f, -0.5f, 0.8f);
    EXPECT_NEAR((frame.to_local(frame.to_world(w)) - w).length(), 0.0f, 1e-6f);
  }
}

}  // namespace
}  // namespace twopass
