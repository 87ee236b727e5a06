// The layers of a picture: what can be asked for, and how samples fill them.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "integrators/integrator.h"
#include "integrators/sample_layers.h"
#include "radiosity/solution.h"
#include "render/image/film.h"
#include "render/names_of_layers.h"

namespace twopass {

/// What is asked for beside the picture.
struct LayerRequest {
  std::vector<Aov> aovs{};  ///< in the order of the file
  bool light_groups = false;
  std::vector<CryptomatteKind> cryptomattes{};

  [[nodiscard]] bool empty() const { return aovs.empty() && !light_groups && cryptomattes.empty(); }
};

/// Most light groups that a picture is divided into.
inline constexpr std::size_t most_light_groups = 64;

/// The light groups of a scene. Throws Error when there are more than most_light_groups.
LightGroups light_groups_of(const Scene& scene);

/// What a film is to hold; `groups` where light groups are asked for.
FilmLayout layout_of(const LayerRequest& request, const LightGroups* groups, bool has_signed_weights);

/// The layers of one render. Const and thread-safe once built.
class Layers {
 public:
  /// `groups`: of the scene, where the request has light groups; `cached`: where the integrator reads a
  /// solution, too. REQUIRES: all but the request outlive this.
  Layers(LayerRequest request, const Scene& scene, const CameraDescription& camera, const Solution* solution,
         const LightGroups* groups, const GroupedLight* cached);

  /// Manifest and more of each Cryptomatte, as header attributes.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> cryptomatte_metadata() const;

  /// Room for the layers of some samples, for one thread.
  class Samples {
   public:
    explicit Samples(const Layers& layers) : layers_(layers) {}
    /// Gives each sample its room: they may be traced now.
    void prepare(std::span<PathSample> samples);
    /// Adds the k-th of them to a pixel of the film. `distance2`: squared, of the sample from the pixel's
    /// centre.
    void add(std::size_t k, const PathSample& sample, float weight, float distance2, Film& film,
             std::size_t pixel);

   private:
    const Layers& layers_;
    std::vector<SampleLayers> room_;
    std::vector<C3f> groups_;
    std::vector<float> values_;
  };

 private:
  void values_of(const SampleLayers& seen, bool is_finite, std::vector<float>& values) const;
  [[nodiscard]] C3f radiosity_at(const FirstSurface& first) const;

  LayerRequest request_;
  std::vector<std::size_t> channels_;  // by AOV
  const Scene& scene_;
  const Solution* solution_;
  const LightGroups* groups_;
  const GroupedLight* cached_;
  V3f eye_, forward_;                                            // depth is measured from and along
  std::vector<std::vector<std::uint32_t>> hashes_;               // by Cryptomatte, then shape
  std::vector<std::map<std::string, std::uint32_t>> manifests_;  // by Cryptomatte
};

}  // namespace twopass
