#include "materials/scattering_block.h"

namespace twopass {

TWOPASS_IN_LANES
void ScatteringBlock::prepare() {
  const std::size_t count = whole_vectors(count_);
  for (std::size_t i = 0; i < count; ++i) {
    const C3f reflectance(base_r_[i], base_g_[i], base_b_[i]);
    const RoughPlasticView seen = RoughPlasticView::of(
        {wo_x_[i], wo_y_[i], wo_z_[i]}, MicrofacetDistribution(Microfacet::ggx, alpha_[i], alpha_[i]), eta_[i],
        {specular_r_[i], specular_g_[i], specular_b_[i]}, reflectance, nonlinear_[i] > 0.0f, escape_[i],
        through_[i]);
    base_r_[i] = seen.base.x, base_g_[i] = seen.base.y, base_b_[i] = seen.base.z;
    coat_probability_[i] = seen.coat_probability;
  }
}

TWOPASS_IN_LANES
void ScatteringBlock::evaluate() {
  for (std::size_t i = 0; i < count_; ++i)
    through_in_[i] = coat_[i]->transmittance_at(std::max(0.0f, wi_z_[i]));
  const std::size_t count = whole_vectors(count_);
  for (std::size_t i = 0; i < count; ++i) {
    const BsdfValue at = view(i).evaluate({wi_x_[i], wi_y_[i], wi_z_[i]}, through_in_[i]);
    value_r_[i] = at.value.x, value_g_[i] = at.value.y, value_b_[i] = at.value.z;
    pdf_w_[i] = at.pdf_w;
  }
}

TWOPASS_IN_LANES
void ScatteringBlock::sample() {
  const std::size_t count = whole_vectors(count_);
  for (std::size_t i = 0; i < count; ++i) {
    V2f u(u_x_[i], u_y_[i]);
    const bool is_coat = choose(u.x, coat_probability_[i]);
    const V3f coat = view(i).draw_from_coat(u), base = RoughPlasticView::draw_from_base(u);
    wi_x_[i] = is_coat ? coat.x : base.x;
    wi_y_[i] = is_coat ? coat.y : base.y;
    wi_z_[i] = is_coat ? coat.z : base.z;
  }
  evaluate();
}

}  // namespace twopass
