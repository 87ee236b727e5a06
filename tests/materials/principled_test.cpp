// The principled models against the published formulas in double precision, and the statistics of their
// sampling over the whole sphere.
#include "materials/principled.h"

#include <string>

#include <gtest/gtest.h>

#include "materials/bsdf.h"
#include "materials/principled_lobes.h"
#include "render/core/sampler.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

V3f direction(float cos_theta, float phi) {
  const float s = std::sqrt(std::max(0.0f, 1.0f - cos_theta * cos_theta));
  return {s * std::cos(phi), s * std::sin(phi), cos_theta};
}

// ---------------------------------------------------------------------------------------------------------
// The formulas once more, in angles and in double precision: Burley 2012 and 2015, Walter et al. 2007.

double weight5(double c) { return std::pow(1.0 - c, 5.0); }

/// GGX by the slopes of the normal, Walter et al. 2007, equation (33), stretched.
double ggx(const V3d& h, double ax, double ay) {
  const double sx = h.x / h.z / ax, sy = h.y / h.z / ay;
  return 1.0 / (pi * ax * ay * std::pow(h.z, 4) * std::pow(1.0 + sx * sx + sy * sy, 2));
}

/// Smith's masking by Heitz 2014, equations (43) and (72).
double smith(const V3d& w, double ax, double ay) {
  const double phi = std::atan2(w.y, w.x), theta = std::acos(std::abs(w.z));
  const double alpha = std::hypot(ax * std::cos(phi), ay * std::sin(phi));
  const double a = 1.0 / (alpha * std::tan(theta));
  return 1.0 / (1.0 + (-1.0 + std::sqrt(1.0 + 1.0 / (a * a))) / 2.0);
}

/// Fresnel's equations in the angles (Born & Wolf, equation 1.5.21).
double fresnel_in_angles(double cos_i, double eta) {
  const double i = std::acos(cos_i), sin_t = std::sin(i) / eta;
  if (sin_t >= 1.0) return 1.0;
  const double t = std::asin(sin_t);
  if (i < 1e-6) return std::pow((eta - 1.0) / (eta + 1.0), 2);
  const double s = std::sin(i - t) / std::sin(i + t), p = std::tan(i - t) / std::tan(i + t);
  return (s * s + p * p) / 2.0;
}

C3d tinted(const C3f& base, double amount) {
  const double y = 0.2126 * base.x + 0.7152 * base.y + 0.0722 * base.z;
  if (y == 0.0) return C3d(1.0);
  return C3d(1.0) * (1.0 - amount) + C3d(base) / y * amount;
}

C3d schlick_in_double(const C3d& f0, double cos_i, double eta) {
  const double sin_t = std::sin(std::acos(cos_i)) / eta;
  const double w = weight5(eta > 1.0 ? cos_i : sin_t < 1.0 ? std::cos(std::asin(sin_t)) : 0.0);
  return f0 * (1.0 - w) + C3d(w);
}

/// pi f / base colour of the diffuse part (Burley 2012, section 5.3, and 2015, section 4.2).
double diffuse_in_double(double o, double i, double d, double roughness, double flatness) {
  const double fd90 = 0.5 + 2.0 * roughness * d * d, fss90 = roughness * d * d;
  // Burley 2015 splits the 2012 form into a base and a retro-reflective part.
  const double rr = 2.0 * roughness * d * d;
  const double base = (1.0 - weight5(o) / 2.0) * (1.0 - weight5(i) / 2.0);
  const double retro = rr * (weight5(o) + weight5(i) + weight5(o) * weight5(i) * (rr - 1.0));
  // The sum is the form of 2012.
  EXPECT_NEAR(base + retro, (1.0 + (fd90 - 1.0) * weight5(o)) * (1.0 + (fd90 - 1.0) * weight5(i)), 1e-12);
  const double fss = (1.0 + (fss90 - 1.0) * weight5(o)) * (1.0 + (fss90 - 1.0) * weight5(i));
  const double flat = 1.25 * (fss * (1.0 / (o + i) - 0.5) + 0.5);
  return (base + retro) * (1.0 - flatness) + flat * flatness;
}

struct Widths {
  double x, y;
};
Widths widths(double roughness, double anisotropic) {
  const double aspect = std::sqrt(1.0 - 0.9 * anisotropic);
  return {std::max(0.001, roughness * roughness / aspect), std::max(0.001, roughness * roughness * aspect)};
}

C3d root(const C3f& c) { return {std::sqrt(double(c.x)), std::sqrt(double(c.y)), std::sqrt(double(c.z))}; }

C3d published(const Principled& m, const V3d& o, const V3d& i) {
  const double opaque = (1.0 - m.metallic) * (1.0 - m.spec_trans), glass = (1.0 - m.metallic) * m.spec_trans;
  const Widths a = widths(m.roughness, m.anisotropic);
  const double g = smith(o, a.x, a.y) * smith(i, a.x, a.y), eta = m.eta;
  if (i.z < 0.0) {
    V3d h = -(o + i * eta).normalized();
    if (h.z < 0.0) h = -h;
    const double oh = o.dot(h), ih = i.dot(h);
    if (oh <= 0.0 || ih >= 0.0) return C3d(0.0);
    // Walter et al. 2007, equation (21), times cos i, over eta^2 for radiance.
    const double f = std::abs(oh * ih / (o.z * i.z)) * eta * eta * (1.0 - fresnel_in_angles(oh, eta)) * g *
                     ggx(h, a.x, a.y) / std::pow(oh + eta * ih, 2) / (eta * eta);
    return root(m.base_color) * (glass * f * std::abs(i.z));
  }
  const V3d h = (o + i).normalized();
  const double d = o.dot(h), dielectric = fresnel_in_angles(d, eta);
  const double facets = ggx(h, a.x, a.y) * g / (4.0 * o.z * i.z);
  if (m.inside) return C3d(glass * dielectric * facets * i.z);
  const double r0 = std::pow((eta - 1.0) / (eta + 1.0), 2);
  const C3d fresnel = schlick_in_double(C3d(m.base_color), d, eta) * m.metallic +
                      (C3d(dielectric) * (1.0 - m.spec_tint) +
                       schlick_in_double(tinted(m.base_color, 1.0) * r0, d, eta) * m.spec_tint) *
                          (1.0 - m.metallic);
  C3d f = fresnel * facets;
  // Clear coat: GTR1 of Burley 2012, equation (4), and his code's product without 1 / (4 cos cos).
  const double alpha = 0.1 + (0.001 - 0.1) * m.clearcoat_gloss, a2 = alpha * alpha;
  const double gtr1 = (a2 - 1.0) / (pi * std::log(a2) * (1.0 + (a2 - 1.0) * h.z * h.z));
  f += schlick_in_double(C3d(0.04), d, eta) *
       (0.25 * m.clearcoat * gtr1 * smith(o, 0.25, 0.25) * smith(i, 0.25, 0.25));
  f += C3d(m.base_color) * (opaque / pi * diffuse_in_double(o.z, i.z, d, m.roughness, m.flatness));
  if (opaque > 0.0) f += tinted(m.base_color, m.sheen_tint) * (m.sheen * (1.0 - m.metallic) * weight5(d));
  return f * i.z;
}

C3d published(const PrincipledThin& m, const V3d& o, const V3d& i) {
  const V3d upper(i.x, i.y, std::abs(i.z)), h = (o + upper).normalized();
  const double d = o.dot(h), dielectric = fresnel_in_angles(d, m.eta), passing = m.diff_trans / 2.0;
  if (i.z < 0.0) {
    const Widths a = widths((0.65 * m.eta - 0.35) * m.roughness, m.anisotropic);
    double f = (1.0 - m.spec_trans) * passing / pi;
    if (i.dot(h) < 0.0)
      f += m.spec_trans * (1.0 - dielectric) * ggx(h, a.x, a.y) * smith(o, a.x, a.y) * smith(i, a.x, a.y) /
           (4.0 * o.z * upper.z);
    return C3d(m.base_color) * (f * upper.z);
  }
  const Widths a = widths(m.roughness, m.anisotropic);
  const double r0 = std::pow((m.eta - 1.0) / (m.eta + 1.0), 2);
  const C3d fresnel = C3d(dielectric) * (1.0 - m.spec_tint) +
                      schlick_in_double(tinted(m.base_color, 1.0) * r0, d, m.eta) * m.spec_tint;
  const C3d diffuse = C3d(m.base_color) * (diffuse_in_double(o.z, i.z, d, m.roughness, m.flatness) / pi) +
                      tinted(m.base_color, m.sheen_tint) * (m.sheen * weight5(d));
  return (fresnel *
              (m.spec_trans * ggx(h, a.x, a.y) * smith(o, a.x, a.y) * smith(i, a.x, a.y) / (4.0 * o.z * i.z)) +
          diffuse * ((1.0 - m.spec_trans) * (1.0 - passing))) *
         i.z;
}

// ---------------------------------------------------------------------------------------------------------

struct Case {
  std::string name;
  Bsdf bsdf;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

template <class Change>
Bsdf principled(const Change& change) {
  Principled m;
  m.base_color = C3f(0.7f, 0.4f, 0.2f);
  change(m);
  return m;
}
template <class Change>
Bsdf principled_inside(const Change& change) {
  return std::get<Principled>(principled(change)).from_behind();
}
template <class Change>
Bsdf thin(const Change& change) {
  PrincipledThin m;
  m.base_color = C3f(0.7f, 0.4f, 0.2f);
  change(m);
  return m;
}

using P = Principled;
using T = PrincipledThin;

const Case cases[] = {
    {"plain", principled([](P&) {})},
    {"metal", principled([](P& m) { m.metallic = 0.9f; })},
    {"brushed", principled([](P& m) { m.metallic = 1.0f, m.anisotropic = 0.8f, m.roughness = 0.6f; })},
    {"coated", principled([](P& m) { m.clearcoat = 1.0f, m.roughness = 0.6f; })},
    {"velvet", principled([](P& m) { m.sheen = 1.0f, m.sheen_tint = 0.5f, m.roughness = 0.9f; })},
    {"flat", principled([](P& m) { m.flatness = 0.8f, m.spec_tint = 0.6f; })},
    {"glass", principled([](P& m) { m.spec_trans = 1.0f, m.eta = 1.4f; })},
    {"glass_inside", principled_inside([](P& m) { m.spec_trans = 1.0f, m.eta = 1.4f; })},
    {"milky", principled([](P& m) { m.spec_trans = 0.6f, m.metallic = 0.3f, m.roughness = 0.7f; })},
    {"milky_inside",
     principled_inside([](P& m) { m.spec_trans = 0.6f, m.metallic = 0.3f, m.roughness = 0.7f; })},
    {"bubble", principled([](P& m) { m.spec_trans = 0.8f, m.eta = 0.75f, m.spec_tint = 0.5f; })},
    {"all", principled([](P& m) {
       m.metallic = 0.3f, m.spec_trans = 0.4f, m.clearcoat = 0.7f, m.sheen = 0.5f, m.sheen_tint = 0.3f;
       m.flatness = 0.5f, m.spec_tint = 0.2f, m.anisotropic = 0.5f;
       m.diffuse_reflectance_sampling_rate = 2.0f, m.main_specular_sampling_rate = 0.5f;
       m.clearcoat_sampling_rate = 3.0f;
     })},
    {"thin_plain", thin([](T&) {})},
    {"thin_leaf", thin([](T& m) { m.diff_trans = 0.8f, m.sheen = 0.7f, m.flatness = 0.5f; })},
    {"thin_film", thin([](T& m) { m.spec_trans = 1.0f, m.spec_tint = 0.5f; })},
    {"thin_all", thin([](T& m) {
       m.spec_trans = 0.6f, m.diff_trans = 1.2f, m.anisotropic = 0.6f, m.roughness = 0.7f, m.eta = 1.3f;
       m.sheen = 0.5f, m.sheen_tint = 1.0f, m.flatness = 0.2f, m.spec_tint = 0.3f;
       m.diffuse_reflectance_sampling_rate = 2.0f, m.specular_transmittance_sampling_rate = 0.5f;
     })},
};

class PrincipledTest : public testing::TestWithParam<Case> {};

TEST_P(PrincipledTest, IsThePublishedFormula) {
  const Bsdf& bsdf = GetParam().bsdf;
  double most = 0.0;
  for (std::uint32_t n = 0; n < 20000; ++n) {
    Sampler sampler(11, n, 0);
    const V2f a = sampler.next_2d(), b = sampler.next_2d();
    const V3f o = direction(0.01f + 0.99f * a.x, 6.2f * a.y), i = direction(1.98f * b.x - 0.99f, 6.2f * b.y);
    if (std::abs(i.z) < 0.01f) continue;
    const C3f ours = eval(bsdf, o, i);
    const V3d od = V3d(o).normalized(), id = V3d(i).normalized();
    const C3d expected = std::holds_alternative<P>(bsdf) ? published(std::get<P>(bsdf), od, id)
                                                         : published(std::get<T>(bsdf), od, id);
    for (int k = 0; k < 3; ++k) {
      ASSERT_NEAR(ours[k], expected[k], 1e-6 + 2e-3 * expected[k]) << o << ' ' << i;
      most = std::max(most, expected[k]);
    }
  }
  EXPECT_GT(most, 0.1);  // not a comparison of zeros
}

TEST_P(PrincipledTest, SampleAgreesWithEvalAndPdf) {
  const Bsdf& bsdf = GetParam().bsdf;
  for (const float c : {1.0f, 0.9f, 0.5f, 0.1f, 1e-3f, 1e-6f, 1e-20f}) {
    const V3f wo = direction(c, 0.3f);
    for (std::uint32_t i = 0; i < 2000; ++i) {
      Sampler sampler(1, 2, i);
      const auto drawn = sample(bsdf, wo, sampler.next_2d());
      if (!drawn) continue;
      ASSERT_TRUE(is_finite(drawn->wi) && is_finite(drawn->weight) && std::isfinite(drawn->pdf_w));
      ASSERT_GT(drawn->pdf_w, 0.0f);
      ASSERT_NEAR(drawn->wi.length(), 1.0f, 1e-5f);
      ASSERT_FALSE(drawn->is_specular);
      EXPECT_EQ(drawn->eta != 1.0f, drawn->wi.z < 0.0f && std::holds_alternative<P>(bsdf));
      EXPECT_EQ(pdf_w(bsdf, wo, drawn->wi), drawn->pdf_w);
      const C3f f = eval(bsdf, wo, drawn->wi);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(f[k], drawn->weight[k] * drawn->pdf_w, 1e-5f * f[k]);
    }
  }
}

TEST_P(PrincipledTest, IsFiniteEverywhere) {
  const Bsdf& bsdf = GetParam().bsdf;
  const float heights[] = {1.0f, 0.999999f, 0.5f, 1e-3f, 1e-6f, 1e-12f, 1e-20f};
  for (const float a : heights)
    for (const float b : heights)
      for (const float sign : {1.0f, -1.0f})
        for (const float phi : {0.0f, 1.0f, pi_f}) {
          const V3f wo = direction(a, 0.0f), wi = direction(sign * b, phi);
          const C3f f = eval(bsdf, wo, wi);
          const float pdf = pdf_w(bsdf, wo, wi);
          ASSERT_TRUE(is_finite(f) && std::isfinite(pdf)) << wo << ' ' << wi << ' ' << f << ' ' << pdf;
          ASSERT_TRUE(f.x >= 0.0f && f.y >= 0.0f && f.z >= 0.0f && pdf >= 0.0f);
        }
}

// Cells of the whole sphere, and one more for what facets send to the wrong side: its expectation is what the
// density lacks of 1.
TEST_P(PrincipledTest, DirectionsFollowTheDensity) {
  const Bsdf& bsdf = GetParam().bsdf;
  constexpr int nz = 16, nphi = 12, fine = 16, n = 1 << 16;
  const float views[] = {0.95f, 0.6f, 0.25f};
  for (const float c : views) {
    const V3f wo = direction(c, 1.0f);
    std::vector<double> seen(nz * nphi + 1, 0.0), expected(nz * nphi + 1, 0.0);
    for (std::uint32_t i = 0; i < n; ++i) {
      Sampler sampler(3, i, 0);
      const auto drawn = sample(bsdf, wo, sampler.next_2d());
      if (!drawn) {
        seen.back() += 1;
        continue;
      }
      const float phi = std::atan2(drawn->wi.y, drawn->wi.x) + pi_f;
      seen[std::min(nz - 1, static_cast<int>((drawn->wi.z + 1) / 2 * nz)) * nphi +
           std::min(nphi - 1, static_cast<int>(phi / (2 * pi_f) * nphi))] += 1;
    }
    double inside = 0.0;
    for (int a = 0; a < nz * fine; ++a)
      for (int b = 0; b < nphi * fine; ++b) {
        const V3f wi = direction((static_cast<float>(a) + 0.5f) / (nz * fine) * 2 - 1,
                                 (static_cast<float>(b) + 0.5f) / (nphi * fine) * 2 * pi_f - pi_f);
        const double mass = 4.0 * pi / (nz * nphi * fine * fine) * pdf_w(bsdf, wo, wi);
        expected[a / fine * nphi + b / fine] += n * mass;
        inside += mass;
      }
    EXPECT_LT(inside, 1.0 + 1e-3);
    expected.back() = n * std::max(0.0, 1.0 - inside);
    EXPECT_GT(inside, 0.7);  // what rough facets send to the wrong side
    EXPECT_GT(test::chi2_test(seen, expected), test::sidak(1e-3, std::size(cases) * std::size(views)))
        << "cosine " << c << " density integrates to " << inside;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, PrincipledTest, testing::ValuesIn(cases),
                         [](const testing::TestParamInfo<Case>& model) { return model.param.name; });

// ---------------------------------------------------------------------------------------------------------

TEST(Principled, SpecularIsTheReflectanceAtNormalIncidence) {
  EXPECT_NEAR(eta_of_specular(0.5f), 1.5f, 1e-6f);
  for (const float s : {0.0f, 0.1f, 0.5f, 1.0f}) {
    const float eta = eta_of_specular(s);
    EXPECT_NEAR((eta - 1) * (eta - 1) / ((eta + 1) * (eta + 1)), 0.08f * s, 1e-7f);
  }
}

TEST(Principled, IsBlackInsideWithoutGlass) {
  const Principled behind = Principled{}.from_behind();
  EXPECT_TRUE(is_black(behind.eval(direction(0.5f, 0.0f), direction(0.4f, 2.0f))));
  EXPECT_TRUE(is_black(behind.diffuse_reflectance()));
  EXPECT_FALSE(behind.sample(direction(0.5f, 0.0f), V2f(0.3f, 0.4f)).has_value());
}

// Radiance over eta^2 is reversible (Veach 1997, section 5.2): the view from the other side is the same path.
TEST(Principled, GlassIsReversible) {
  const Principled front = std::get<Principled>(
      principled([](P& m) { m.spec_trans = 0.7f, m.metallic = 0.2f, m.eta = 1.4f, m.anisotropic = 0.6f; }));
  const Principled back = front.from_behind();
  EXPECT_FLOAT_EQ(back.eta * front.eta, 1.0f);
  int compared = 0;
  for (std::uint32_t n = 0; n < 1000; ++n) {
    Sampler sampler(5, n, 0);
    const V2f a = sampler.next_2d(), b = sampler.next_2d();
    const V3f wo = direction(0.05f + 0.95f * a.x, 6.2f * a.y), wi = direction(-0.05f - 0.95f * b.x, 6.2f * b.y);
    const C3f there = front.eval(wo, wi) * (front.eta * front.eta / -wi.z);
    const C3f again = back.eval(V3f(wi.x, wi.y, -wi.z), V3f(wo.x, wo.y, -wo.z)) * (1.0f / wo.z);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(there[k], again[k], 1e-5f + 1e-3f * there[k]);
    compared += there.x > 0.01f;
  }
  EXPECT_GT(compared, 100);
}

/// Reflected and transmitted share of even light seen from the cosine `c`; power, not radiance, is counted.
double albedo(const Bsdf& bsdf, float c) {
  test::Estimate sum;
  for (std::uint32_t i = 0; i < 1 << 14; ++i) {
    Sampler sampler(9, i, 0);
    const auto drawn = sample(bsdf, direction(c, 0.4f), sampler.next_2d());
    sum.add(drawn ? drawn->weight.y * drawn->eta * drawn->eta : 0.0);
  }
  return sum.mean();
}

// Glass, metal and sheets give back at most what they get. The opaque base adds its diffuse reflection to the
// facets' without taking from it, retro-reflects and may have sheen: white exceeds 1 as stated.
TEST(Principled, StatedAlbedosOfWhite) {
  const auto most = [](const auto& change) {
    const auto white = [&](auto& m) { change(m), m.base_color = C3f(1.0f); };
    double value = 0.0;
    for (const float roughness : {0.1f, 0.5f, 1.0f})
      for (const float c : {1.0f, 0.7f, 0.4f, 0.2f, 0.05f})
        value = std::max(value, albedo(principled([&](P& m) { white(m), m.roughness = roughness; }), c));
    return value;
  };
  EXPECT_LE(most([](P& m) { m.spec_trans = 1.0f; }), 1.0 + 5e-3);
  EXPECT_LE(most([](P& m) { m.metallic = 1.0f; }), 1.0 + 5e-3);
  const double base = most([](P&) {}), sheen = most([](P&m) { m.sheen = 1.0f; }),
               coat = most([](P&m) { m.clearcoat = 1.0f; }), flat = most([](P&m) { m.flatness = 1.0f; });
  EXPECT_NEAR(base, 1.50, 0.02);
  EXPECT_NEAR(sheen, 1.58, 0.02);
  EXPECT_NEAR(coat, 1.51, 0.02);
  EXPECT_NEAR(flat, 1.68, 0.02);
}

// Both directions averaged by midpoints; without an index step only the diffuse lobes are left.
TEST(Principled, DiffuseReflectanceIsTheAverage) {
  const auto average = [](const auto& model) {
    constexpr int n = 48;
    C3d sum(0.0);
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b)
        for (int c = 0; c < n; ++c) {
          const V3f wo = direction((static_cast<float>(a) + 0.5f) / n, 0.0f);
          const V3f wi =
              direction((static_cast<float>(b) + 0.5f) / n, (static_cast<float>(c) + 0.5f) / n * pi_f);
          sum += C3d(model.eval(wo, wi)) * (2.0 * wo.z * 2.0 * pi / (n * n * n));
        }
    return sum;
  };
  for (const float roughness : {0.0f, 0.5f, 1.0f})
    for (const float flatness : {0.0f, 0.3f, 1.0f}) {
      Principled m = std::get<P>(principled([](P& p) { p.sheen = 0.8f, p.sheen_tint = 0.5f; }));
      m.eta = 1.0f, m.roughness = roughness, m.flatness = flatness;
      PrincipledThin t;
      t.diff_trans = 0.6f, t.sheen = 0.5f, t.roughness = roughness, t.flatness = flatness;
      const C3d expected = average(m), expected_thin = average(t);
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(m.diffuse_reflectance()[k], expected[k], 1e-3);
        EXPECT_NEAR(t.diffuse_reflectance()[k], expected_thin[k], 1e-3);
      }
    }
  // Never more than a radiosity solution can bear.
  Principled bright;
  bright.base_color = C3f(1.0f), bright.roughness = 1.0f, bright.sheen = 1.0f;
  EXPECT_EQ(bright.diffuse_reflectance(), C3f(1.0f));
}

TEST(PrincipledThin, CanBeLambertsTransmission) {
  PrincipledThin leaf;
  leaf.diff_trans = 2.0f;
  EXPECT_TRUE(is_black(leaf.eval(direction(0.5f, 0.0f), direction(0.4f, 1.0f))));
  EXPECT_NEAR(leaf.eval(direction(0.5f, 0.0f), direction(-0.4f, 1.0f)).x, 0.5f * 0.4f / pi_f, 1e-6f);
  EXPECT_TRUE(is_black(leaf.diffuse_reflectance()));
}

// The distributions of sines have closed forms: GTR1's from Burley 2012, equation (5).
TEST(Gtr1Facets, SinesFollowTheClosedForm) {
  for (const float gloss : {0.0f, 0.8f, 1.0f}) {
    const Gtr1Facets facets = Gtr1Facets::from_gloss(gloss);
    const double a2 = double(facets.alpha) * facets.alpha;
    constexpr int n = 1 << 14, cells = 16;
    std::vector<double> seen(cells, 0.0), expected(cells, double(n) / cells);
    for (std::uint32_t i = 0; i < n; ++i) {
      Sampler sampler(4, i, 0);
      const V3f h = facets.sample(sampler.next_2d());
      const double sin2 = double(h.x) * h.x + double(h.y) * h.y;
      const double below = std::log1p(sin2 * (1.0 - a2) / a2) / -std::log(a2);
      seen[std::min(cells - 1, static_cast<int>(below * cells))] += 1;
      // The derivative of the distribution is the density: 2 pi D cos sin per angle, pi D per square of a sine.
      const double slope = (1.0 - a2) / a2 / (1.0 + sin2 * (1.0 - a2) / a2) / -std::log(a2);
      ASSERT_NEAR(pi * facets.distribution(h), slope, 1e-3 * slope);
    }
    EXPECT_GT(test::chi2_test(seen, expected), 1e-4);
  }
}

TEST(Bsdf, StaysSmall) { EXPECT_LE(sizeof(Bsdf), 128u); }

}  // namespace
}  // namespace twopass
