#include "render/commands/render_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace twopass {

std::string clamp_text(const PathLimits& limits) {
  std::string text;
  const auto add = [&](const char* what, float most) {
    if (most == infinity_f) return;
    char part[60];
    std::snprintf(part, sizeof part, "%s%s light clamped to %g", text.empty() ? "" : ", ", what, most);
    text += part;
  };
  add("direct", limits.clamp_direct);
  add("indirect", limits.clamp_indirect);
  return text;
}

std::string progress_text(const RenderProgress& at) {
  char noise[32] = "", text[160];
  if (std::isfinite(at.error)) std::snprintf(noise, sizeof noise, ", noise %.2g", at.error);
  std::snprintf(text, sizeof text, "pass %d, %.4g spp%s, %.3g Mrays/s", at.pass, at.samples_per_pixel, noise,
                1e-6 * at.rays_per_second);
  return text;
}

void report_render(std::span<const std::string> outputs, const RenderStatistics& s, const Console& console) {
  if (console.verbosity() == Verbosity::quiet) return;
  for (const std::string& output : outputs) std::printf("wrote %s\n", output.c_str());
  const double pixels = static_cast<double>(s.width) * s.height;
  std::printf("%s, %dx%d, %.4g samples a pixel (stopped by %s)", s.integrator.c_str(), s.width, s.height,
              static_cast<double>(s.samples) / pixels, s.outcome.stop_reason.c_str());
  if (std::isfinite(s.relative_error)) std::printf(", estimated noise %.3g", s.relative_error);
  if (s.outcome.pixels_stopped_early > 0.0)
    std::printf(", %.3g %% of the pixels stopped early", 100.0 * s.outcome.pixels_stopped_early);
  std::printf(", %.2f s (%.2f s CPU)\n", s.total.seconds, s.total.cpu_seconds);
  if (!s.clamped.empty()) std::printf("biased: %s W/(m2 sr) a path\n", s.clamped.c_str());
  if (s.bias)
    std::printf("bias of the picture's mean: %+.2f %% +- %.2f %% (95 %% confidence, %.2g samples)\n",
                100.0 * s.bias->mean, 100.0 * s.bias->ci95, static_cast<double>(s.bias->samples));
  if (s.bias_not_measured)
    std::printf("bias of the picture's mean: not measured, hardly any sample sees light that is looked up\n");
  // The estimate is worth as much as that of 16 equal pixels, or less: 1.22^2 = 1 + 2 / sqrt(16). Nobody sees
  // noise below a thousandth.
  if (std::isfinite(s.relative_error) && s.relative_error_bound > std::max(1e-3, 1.22 * s.relative_error)) {
    char text[200];
    std::snprintf(
        text, sizeof text,
        "few pixels hold most of the noise (rare bright samples): it may be as large as %.2g, or larger "
        "where such samples have not been met yet",
        s.relative_error_bound);
    console.note(text);
  }
  if (may_have_cracks(s.outcome.counts))
    console.note(s.scene_file + ": " + std::to_string(s.outcome.counts.escaped_rays) + " of " +
                 std::to_string(s.outcome.counts.rays) +
                 " rays left the scene: there are cracks between its surfaces, or openings as small");
  if (s.outcome.non_finite_samples > 0) {
    std::printf("%llu samples were not finite and counted as black",
                static_cast<unsigned long long>(s.outcome.non_finite_samples));
    if (const std::optional<SamplePlace>& place = s.outcome.first_non_finite)
      std::printf("; the first: sample %u of pixel %d,%d", place->sample, place->pixel.x, place->pixel.y);
    std::printf("\n");
  }
}

}  // namespace twopass
