#include "render/scene/environment.h"

#include "render/core/warp.h"
#include "render/scene/data_hash.h"

namespace twopass {

namespace {

constexpr float uniform_pdf_w = 1.0f / (4.0f * pi_f);

// One function for what is the same everywhere, one for what is behind a pointer.
template <class OfConstant, class OfPointer>
auto visit_kind(const auto& kind, const OfConstant& of_constant, const OfPointer& of_pointer) {
  if (const auto* constant = std::get_if<0>(&kind)) return of_constant(*constant);
  if (const auto* map = std::get_if<1>(&kind)) return of_pointer(**map);
  return of_pointer(*std::get<2>(kind));
}

}  // namespace

C3f Environment::radiance(const V3f& direction) const {
  return visit_kind(
      kind_, [](const C3f& constant) { return constant; },
      [&](const auto& lit) { return shown(lit.radiance(direction)); });
}

EnvironmentSample Environment::sample(const V2f& u) const {
  return visit_kind(
      kind_,
      [&](const C3f& constant) {
        return EnvironmentSample{square_to_sphere(u), constant, uniform_pdf_w};
      },
      [&](const auto& lit) {
        const auto drawn = lit.sample(u);
        return EnvironmentSample{drawn.direction, shown(drawn.radiance), drawn.pdf_w};
      });
}

float Environment::pdf_w(const V3f& direction) const {
  return visit_kind(
      kind_, [](const C3f&) { return uniform_pdf_w; }, [&](const auto& lit) { return lit.pdf_w(direction); });
}

C3f Environment::mean_radiance() const {
  return visit_kind(
      kind_, [](const C3f& constant) { return constant; },
      [&](const auto& lit) { return shown(lit.mean_radiance()); });
}

Environment Environment::in_primaries(const ColorMatrix& primaries) const {
  Environment result = *this;
  if (auto* constant = std::get_if<C3f>(&result.kind_))
    *constant = primaries(*constant);
  else
    result.primaries_ = primaries;
  return result;
}

std::optional<C3f> Environment::constant() const {
  if (const auto* constant = std::get_if<C3f>(&kind_)) return *constant;
  return std::nullopt;
}

const char* Environment::kind_name() const {
  constexpr const char* names[] = {"constant", "envmap", "sunsky"};
  return is_black() ? "none" : names[kind_.index()];
}

std::uint64_t Environment::fingerprint() const {
  DataHash hash;
  hash.add(std::uint64_t{kind_.index()});
  hash.add(visit_kind(
      kind_,
      [](const C3f& constant) {
        DataHash own;
        own.add(constant);
        return own.value();
      },
      [](const auto& lit) { return lit.fingerprint(); }));
  if (primaries_)
    for (const C3f& color : primaries_->image) hash.add(color);
  return hash.value();
}

}  // namespace twopass
