#include "radiosity/balance.h"

#include "render/core/interrupt.h"
#include "render/core/parallel.h"

namespace twopass {

C3d Balance::gather_directly(std::uint32_t i, std::span<const C3d> radiosity) const {
  if (!(area[i] > 0.0)) return C3d(0.0);
  C3d sum(0.0);
  for (ExchangeMatrix::InnerIterator it(exchange, i); it; ++it)
    sum += radiosity[static_cast<std::size_t>(it.col())] * static_cast<double>(it.value());
  return sum * (1.0 / area[i]);
}

std::vector<C3d> Balance::gather_all_directly(std::span<const C3d> radiosity) const {
  std::vector<C3d> result(count());
  throw_if_interrupted();
  parallel_for(count(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      result[i] = gather_directly(static_cast<std::uint32_t>(i), radiosity);
  });
  return result;
}

C3d Balance::gather(std::uint32_t i, std::span<const C3d> radiosity) const {
  if (!(area[i] > 0.0)) return C3d(0.0);
  C3d sum = gather_directly(i, radiosity);
  for (const SpecularLink& link : specular.of(i)) sum += radiosity[link.element] * C3d(link.weight);
  return sum;
}

std::vector<C3d> Balance::gather_all(std::span<const C3d> radiosity) const {
  std::vector<C3d> result(count());
  throw_if_interrupted();
  parallel_for(count(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = gather(static_cast<std::uint32_t>(i), radiosity);
  });
  return result;
}

}  // namespace twopass
