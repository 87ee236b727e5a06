#include "radiosity/stochastic.h"

#include <atomic>
#include <utility>

#include "radiosity/landing.h"
#include "radiosity/power_ledger.h"
#include "radiosity/specular_path.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

// One emission of all direct light is 2^44 units in each channel: far below a ray's power, and light can be
// emitted 2^18 times before anything overflows, because no sum of powers under way exceeds what was emitted.
constexpr int emission_bits = 44;
constexpr double one_emission = static_cast<double>(std::int64_t{1} << emission_bits);
constexpr double most_emissions = 1 << 18;
// The part of all light that the first round emits to learn how many rays the rest will take.
constexpr double pilot_emissions = 1.0 / 8.0;
// Fewer shots tell nothing of that.
constexpr std::uint64_t fewest_pilot_shots = 256;
// Most that a round multiplies the light emitted so far by.
constexpr double most_growth = 4.0;
// The part of the error that the unshot light may use up.
constexpr double unshot_share = 0.1;
// A sweep for fewer rays than one in so many elements is not worth its while.
constexpr std::uint64_t elements_per_useful_ray = 16;
// An element of which hardly anything is exposed needs many tries to find an exposed point.
constexpr int most_starts = 256;

// Which rays an element shoots in an iteration: numbers of its own sequence.
struct Volley {
  std::uint32_t first, count;
};

// What is about to be shot, of all elements.
struct Outlook {
  PowerUnits unshot{};
  std::uint64_t shots = 0;
  C3d power{0.0};          // of the shots, units
  C3d power_of_shot{0.0};  // Sum over shots of power squared

  void operator+=(const Outlook& other) {
    for (int c = 0; c < 3; ++c) unshot[c] += other.unshot[c];
    shots += other.shots;
    power += other.power;
    power_of_shot += other.power_of_shot;
  }
};

// Sums over all elements of what has been reflected and of its standard deviation, units.
struct Reflected {
  C3d power{0.0}, deviation{0.0};

  void operator+=(const Reflected& other) {
    power += other.power;
    deviation += other.deviation;
  }
};

// `sum` and value(element) of all elements, added up in an order that does not depend on threads. REQUIRES: sum
// is zero.
template <class Sum, class Value>
Sum sum_over_elements(std::size_t count, Sum sum, const Value& value) {
  constexpr std::size_t piece = 4096;
  std::vector<Sum> part((count + piece - 1) / piece, sum);
  parallel_for(part.size(), 1, [&](std::size_t begin, std::size_t end) {
    throw_if_interrupted();
    for (std::size_t p = begin; p < end; ++p)
      for (std::size_t i = p * piece; i < std::min(count, (p + 1) * piece); ++i)
        part[p] += value(static_cast<std::uint32_t>(i));
  });
  for (const Sum& p : part) sum += p;
  return sum;
}

class Shooting {
 public:
  Shooting(const Scene& scene, const ElementMesh& mesh, std::span<const C3f> direct,
           const StochasticOptions& options)
      : scene_(scene),
        mesh_(mesh),
        element_rays_(scene, mesh),
        direct_(direct),
        options_(options),
        incoming_(mesh.count(), PowerUnits{}),
        unshot_(mesh.count(), C3f(0.0f)),
        received_(mesh.count(), C3f(0.0f)) {
    static_assert(sizeof(incoming_[0]) + sizeof(unshot_[0]) + sizeof(received_[0]) + sizeof(direct_[0]) ==
                  stochastic_bytes_per_element);
    choose_units();
  }

  StochasticResult run() {
    if (live_channels_ > 0) {
      if (options_.max_reflections >= 0)
        run_limited();
      else
        run_to_balance();
    }
    return finish();
  }

 private:
  [[nodiscard]] std::size_t count() const { return mesh_.count(); }

  // An element without area receives power only in so far as its area is not worth counting: it absorbs.
  [[nodiscard]] C3d reflectance(std::uint32_t i) const {
    C3d rho(0.0);
    if (!(mesh_.area(i) > 0.0)) return rho;
    for (int c = 0; c < 3; ++c)
      rho[c] = static_cast<double>(std::clamp(mesh_.reflectance(i)[c], 0.0f, largest_reflectance));
    return rho;
  }

  // rho A H, watts.
  [[nodiscard]] C3d first_watts(std::uint32_t i) const {
    const C3d rho = reflectance(i);
    C3d watts;
    for (int c = 0; c < 3; ++c)
      watts[c] = rho[c] * mesh_.area(i) * static_cast<double>(std::max(0.0f, direct_[i][c]));
    return watts;
  }

  [[nodiscard]] C3d first_units(std::uint32_t i) const {
    C3d units = first_watts(i);
    for (int c = 0; c < 3; ++c) units[c] = units_per_watt_[c] > 0.0 ? units[c] * units_per_watt_[c] : 0.0;
    return units;
  }

  // Each channel has its own unit, so that a faint one is as exact as the others, and counts as much.
  void choose_units() {
    const auto total = sum_over_elements(count(), C3d(0.0), [&](std::uint32_t i) { return first_watts(i); });
    double area = 0.0, weighted = 0.0;
    for (std::uint32_t i = 0; i < count(); ++i) {
      const C3d rho = reflectance(i);
      area += mesh_.area(i);
      weighted += mesh_.area(i) * (rho.x + rho.y + rho.z) / 3.0;
      for (int c = 0; c < 3; ++c) largest_[c] = std::max(largest_[c], rho[c]);
      if (mesh_.area(i) > 0.0) ++live_elements_;
    }
    mean_reflectance_ = area > 0.0 ? weighted / area : 0.0;
    for (int c = 0; c < 3; ++c) {
      units_per_watt_[c] = total[c] > 0.0 ? one_emission / total[c] : 0.0;
      if (!std::isfinite(units_per_watt_[c])) units_per_watt_[c] = 0.0;
      if (units_per_watt_[c] > 0.0) ++live_channels_;
    }
  }

  // ---- the schedule

  void run_to_balance() {
    const double wanted = options_.rays_per_element * static_cast<double>(live_elements_);
    const double guess = 1.0 / (1.0 - mean_reflectance_);  // power shot in all over power emitted
    quantum_ = guess * live_channels_ * one_emission / std::max(1.0, wanted);
    emit(pilot_emissions);
    settle();
    const double emissions = wanted * quantum_ / (amplification(guess) * live_channels_ * one_emission);
    emit_up_to(std::max(emissions, pilot_emissions));
    while (options_.until_relative_error && emissions_ < most_emissions) {
      const double target = (1.0 - unshot_share) * options_.relative_error;
      const double growth = std::pow(noise(reflected()) / target, 2.0);
      if (!(growth > 1.0)) break;
      emit_up_to(emissions_ * std::min(1.05 * growth, most_growth));
    }
    shoot_the_rest();
  }

  // How much power is shot for each unit that ends, which is the sum of the series of reflections.
  [[nodiscard]] double amplification(double guess) const {
    double shot = 0.0, ended = 0.0;
    for (int c = 0; c < 3; ++c) {
      shot += shot_power_[c];
      ended += static_cast<double>(ledger_.absorbed[c] + ledger_.escaped[c]);
    }
    return shots_ >= fewest_pilot_shots && ended > 0.0 ? shot / ended : guess;
  }

  void emit_up_to(double emissions) {
    emissions = std::min(emissions, most_emissions);
    if (emissions > emissions_) emit(emissions - emissions_);
    settle();
  }

  // Iterates until hardly any element has enough for a ray of full power. The rest waits for more.
  void settle() {
    for (;;) {
      const Outlook now = outlook();
      if (now.shots * elements_per_useful_ray < live_elements_ || now.shots == 0) return;
      iterate(now);
    }
  }

  // Lets rays carry less and less until what is left of the light does not matter.
  void shoot_the_rest() {
    const C3d power = reflected().power;
    for (;;) {
      const Outlook now = outlook();
      if (early_stop_bound(now.unshot, power) <= unshot_share * options_.relative_error) return;
      if (now.shots * elements_per_useful_ray < live_elements_ || now.shots == 0) {
        quantum_ *= 0.5;
        ++sequence_;
      } else {
        iterate(now);
      }
    }
  }

  // Iteration k carries the light of reflection k, all of it.
  void run_limited() {
    const double wanted = options_.rays_per_element * static_cast<double>(live_elements_);
    double terms = 0.0;
    for (int k = 0; k < options_.max_reflections; ++k) terms += std::pow(mean_reflectance_, k);
    quantum_ = terms * live_channels_ * one_emission / std::max(1.0, wanted);
    double emissions = 1.0;
    for (;;) {
      emit(emissions - emissions_);
      for (int k = 0; k < options_.max_reflections; ++k, ++sequence_) iterate(outlook());
      drop_unshot();
      if (!options_.until_relative_error || emissions_ >= most_emissions) return;
      const double growth = std::pow(noise(reflected()) / options_.relative_error, 2.0);
      if (!(growth > 1.0)) return;
      emissions = std::min(emissions_ * std::min(1.05 * growth, most_growth), most_emissions);
    }
  }

  // ---- power

  // Emits that many times the direct light.
  void emit(double emissions) {
    emissions_ += emissions;
    for (std::uint32_t i = 0; i < count(); ++i) {
      const C3d units = first_units(i);
      for (int c = 0; c < 3; ++c) {
        const auto before = static_cast<std::int64_t>(unshot_[i][c]);
        unshot_[i][c] = static_cast<float>(before + static_cast<std::int64_t>(units[c] * emissions));
        emitted_[c] += static_cast<std::int64_t>(unshot_[i][c]) - before;
      }
    }
  }

  void iterate(const Outlook& now) {
    shots_ += now.shots;
    shot_power_ += now.power;
    shot_squares_ += now.power_of_shot;
    shoot();
    reflect_incoming();
    ++iterations_;
  }

  // Notes what has arrived; what is reflected of it joins what is to be shot, everything else is absorbed.
  void reflect_incoming() {
    parallel_for(count(), 4096, [&](std::size_t begin, std::size_t end) {
      throw_if_interrupted();
      Fate fate;
      for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
        const C3d rho = reflectance(i);
        for (int c = 0; c < 3; ++c) {
          const std::int64_t arrived = std::exchange(incoming_[i][c], 0);
          const auto before = static_cast<std::int64_t>(unshot_[i][c]);
          received_[i][c] += static_cast<float>(arrived);
          unshot_[i][c] = whole_float(before + portion(arrived, rho[c]), before + arrived);
          fate.absorbed[c] += before + arrived - static_cast<std::int64_t>(unshot_[i][c]);
        }
      }
      ledger_.add(fate);
    });
  }

  void drop_unshot() {
    for (C3f& unshot : unshot_)
      for (int c = 0; c < 3; ++c) dropped_[c] += static_cast<std::int64_t>(std::exchange(unshot[c], 0.0f));
  }

  // (R28): the rays whose numbers the power of the element has passed since it last shot. The power reflected
  // in all says how many there have been, so that no counter is stored.
  [[nodiscard]] Volley volley(std::uint32_t i) const {
    const double unshot = static_cast<double>(unshot_[i].x) + static_cast<double>(unshot_[i].y) +
                          static_cast<double>(unshot_[i].z);
    if (!(unshot > 0.0)) return {0, 0};
    if (options_.max_reflections >= 0) return {0, whole(std::max(1.0, std::round(unshot / quantum_)))};
    const C3d power = power_reflected(i);
    const double all = std::max(unshot, power.x + power.y + power.z);
    // So that elements of equal power do not all shoot at the same time.
    const double phase = 0x1p-32 * static_cast<double>(hash_words(options_.seed, i) >> 32);
    const double first = std::floor((all - unshot) / quantum_ + phase);
    const double last = std::floor(all / quantum_ + phase);
    // Rounding must not make a full ray wait for ever.
    const double rays = std::max(last - first, unshot >= quantum_ ? 1.0 : 0.0);
    return {whole(std::fmod(first, 0x1p32)), whole(rays)};
  }

  static std::uint32_t whole(double x) { return static_cast<std::uint32_t>(std::min(x, 0x1p32 - 1.0)); }

  // Of direct and received light, up to now, units.
  [[nodiscard]] C3d power_reflected(std::uint32_t i) const {
    return first_units(i) * emissions_ + reflectance(i) * C3d(received_[i]);
  }

  [[nodiscard]] Outlook outlook() const {
    return sum_over_elements(count(), Outlook{}, [&](std::uint32_t i) {
      Outlook own;
      own.shots = volley(i).count;
      for (int c = 0; c < 3; ++c) {
        const auto unshot = static_cast<double>(unshot_[i][c]);
        own.unshot[c] = static_cast<std::int64_t>(unshot_[i][c]);
        if (own.shots == 0) continue;
        own.power[c] = unshot;
        own.power_of_shot[c] = unshot * unshot / static_cast<double>(own.shots);
      }
      return own;
    });
  }

  // ---- rays

  void shoot() {
    const auto seed = static_cast<std::uint32_t>(hash_words(options_.seed, sequence_));
    parallel_for(count(), 64, [&](std::size_t begin, std::size_t end) {
      throw_if_interrupted();
      Fate fate;
      for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i)
        if (const Volley rays = volley(i); rays.count > 0) shoot_from(i, rays, seed, fate);
      ledger_.add(fate);
    });
  }

  void shoot_from(std::uint32_t i, const Volley& volley, std::uint32_t seed, Fate& fate) {
    Parcel all;
    for (int c = 0; c < 3; ++c) all.power[c] = static_cast<std::int64_t>(std::exchange(unshot_[i][c], 0.0f));
    const ElementSampler points(mesh_, i);
    const auto size = static_cast<float>(std::sqrt(mesh_.whole_area(i)));
    const auto shoot_part = [&](std::size_t begin, std::size_t end, Fate& part) {
      for (auto k = static_cast<std::uint32_t>(begin); k < end; ++k)
        shoot_ray(points, size, sampler(seed, i, volley.first + k), share_of(all, k, volley.count), part);
    };
    constexpr std::uint32_t piece = 4096;
    if (volley.count <= piece) return shoot_part(0, volley.count, fate);
    // One element can have most of the light.
    parallel_for(volley.count, piece, [&](std::size_t begin, std::size_t end) {
      throw_if_interrupted();
      Fate part;
      shoot_part(begin, end, part);
      ledger_.add(part);
    });
  }

  [[nodiscard]] Sampler sampler(std::uint32_t seed, std::uint32_t element, std::uint32_t ray) const {
    if (options_.stratified) return {seed, element, ray};
    return {static_cast<std::uint32_t>(hash_words(seed, ray)), element, 0};
  }

  void shoot_ray(const ElementSampler& points, float size, Sampler sampler, const Parcel& parcel, Fate& fate) {
    if (parcel.is_empty()) return;
    for (int tries = 0; tries < most_starts; ++tries) {
      const ElementPoint start = points(sampler.next_2d());
      const V3f normal(start.normal);
      const Ray ray{start.ray_position(),
                    Frame(normal).to_world(square_to_cosine_hemisphere(sampler.next_2d()))};
      const Landing landing = element_rays_.cast(ray, normal, size, sampler, fate.rays);
      if (landing.kind == Landing::buried) continue;
      return land(ray, landing, sampler, parcel, fate);
    }
    absorb(parcel, fate);
  }

  void land(const Ray& ray, const Landing& landing, Sampler& sampler, const Parcel& parcel, Fate& fate) {
    switch (landing.kind) {
      case Landing::on_element:
        deposit(landing.element, parcel);
        if (landing.goes_on) follow(ray, landing.point, sampler, parcel, fate);
        return;
      case Landing::in_the_sky:
        return escape(parcel, fate);
      case Landing::on_specular:
        absorb(parcel, fate);
        return follow(ray, landing.point, sampler, parcel, fate);
      case Landing::on_lamp:
      case Landing::on_black:
      case Landing::buried:
        return absorb(parcel, fate);
    }
  }

  // (R15): what a surface passes on other than diffusely is taken back from what it absorbs, be that now, or
  // when what it reflects diffusely is taken from what it has received.
  void follow(const Ray& ray, const SurfacePoint& point, Sampler& sampler, const Parcel& parcel, Fate& fate) {
    SpecularPath path(scene_, ray, point, Carried::power, sampler);
    while (path.next()) {
      const SpecularPathEnd& end = path.end();
      Parcel passed = parcel;
      for (int c = 0; c < 3; ++c) {
        passed.power[c] = portion(parcel.power[c], static_cast<double>(end.weight[c]));
        fate.absorbed[c] -= passed.power[c];
      }
      if (passed.is_empty()) break;
      if (end.escaped) {
        escape(passed, fate);
        break;
      }
      const std::uint32_t element = mesh_.find(end.point);
      if (element == no_index)
        absorb(passed, fate);
      else
        deposit(element, passed);
    }
    fate.rays += path.rays();
  }

  void deposit(std::uint32_t element, const Parcel& parcel) {
    for (int c = 0; c < 3; ++c)
      if (parcel.power[c] > 0)
        std::atomic_ref(incoming_[element][c]).fetch_add(parcel.power[c], std::memory_order_relaxed);
  }
  static void absorb(const Parcel& parcel, Fate& fate) {
    for (int c = 0; c < 3; ++c) fate.absorbed[c] += parcel.power[c];
  }
  static void escape(const Parcel& parcel, Fate& fate) {
    for (int c = 0; c < 3; ++c) fate.escaped[c] += parcel.power[c];
  }

  // ---- the error

  // What the unshot power can add in all its reflections, over all power reflected; of the worst channel.
  [[nodiscard]] double early_stop_bound(const PowerUnits& unshot, const C3d& power) const {
    double worst = 0.0;
    for (int c = 0; c < 3; ++c)
      if (power[c] > 0.0)
        worst = std::max(worst, static_cast<double>(unshot[c]) / (1.0 - largest_[c]) / power[c]);
    return worst;
  }

  // (R29), summed over elements.
  [[nodiscard]] Reflected reflected() const {
    C3d shot(0.0);  // mean power of a shot, as seen by a unit of power
    for (int c = 0; c < 3; ++c)
      if (shot_power_[c] > 0.0) shot[c] = shot_squares_[c] / shot_power_[c];
    return sum_over_elements(count(), Reflected{}, [&](std::uint32_t i) {
      Reflected own;
      const C3d rho = reflectance(i);
      own.power = power_reflected(i);
      for (int c = 0; c < 3; ++c)
        own.deviation[c] = rho[c] * std::sqrt(shot[c] * static_cast<double>(received_[i][c]));
      return own;
    });
  }

  // (R30).
  [[nodiscard]] static double noise(const Reflected& reflected) {
    double worst = 0.0;
    for (int c = 0; c < 3; ++c)
      if (reflected.power[c] > 0.0) worst = std::max(worst, reflected.deviation[c] / reflected.power[c]);
    return worst;
  }

  StochasticResult finish() {
    StochasticResult result;
    result.iterations = iterations_;
    result.shots = shots_;
    result.rays = ledger_.rays;
    const Outlook rest = outlook();
    const Reflected all = reflected();
    for (int c = 0; c < 3; ++c) {
      result.audit.emitted[c] = emitted_[c];
      result.audit.absorbed[c] = ledger_.absorbed[c];
      result.audit.escaped[c] = ledger_.escaped[c];
      result.audit.unshot[c] = dropped_[c] + rest.unshot[c];
      if (units_per_watt_[c] > 0.0) result.audit.watts_per_unit[c] = 1.0 / (units_per_watt_[c] * emissions_);
      if (all.power[c] > 0.0)
        result.residual = std::max(result.residual, static_cast<double>(rest.unshot[c]) / all.power[c]);
    }
    result.noise = noise(all);
    result.error_bound = result.noise + early_stop_bound(rest.unshot, all.power);
    for (std::uint32_t i = 0; i < count(); ++i)
      for (int c = 0; c < 3; ++c)
        received_[i][c] =
            mesh_.area(i) > 0.0
                ? static_cast<float>(received_[i][c] * result.audit.watts_per_unit[c] / mesh_.area(i))
                : 0.0f;
    result.irradiance = std::move(received_);
    return result;
  }

  const Scene& scene_;
  const ElementMesh& mesh_;
  ElementRays element_rays_;
  std::span<const C3f> direct_;
  const StochasticOptions& options_;

  std::vector<PowerUnits> incoming_;  // of this iteration
  std::vector<C3f> unshot_;           // whole numbers of units
  std::vector<C3f> received_;         // of all iterations, units

  C3d units_per_watt_{0.0}, largest_{0.0};
  double mean_reflectance_ = 0.0;
  std::size_t live_elements_ = 0;  // that have an area
  int live_channels_ = 0;

  double quantum_ = 0.0;        // power of a ray, units of all channels together
  std::uint32_t sequence_ = 0;  // which sequence of points the elements are drawing from
  double emissions_ = 0.0;      // how many times the direct light has been emitted

  PowerUnits emitted_{}, dropped_{};
  Ledger ledger_;
  std::size_t iterations_ = 0;
  std::uint64_t shots_ = 0;
  C3d shot_power_{0.0}, shot_squares_{0.0};
};

}  // namespace

bool PowerAudit::balances() const {
  for (int c = 0; c < 3; ++c)
    if (emitted[c] != absorbed[c] + escaped[c] + unshot[c]) return false;
  return true;
}

StochasticResult solve_stochastic(const Scene& scene, const ElementMesh& mesh,
                                  std::span<const C3f> direct_irradiance, const StochasticOptions& options) {
  return Shooting(scene, mesh, direct_irradiance, options).run();
}

}  // namespace twopass
