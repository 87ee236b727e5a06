#include "render/commands/radiosity_options.h"

namespace twopass {

namespace {

template <class T>
std::string names_of(std::span<const Named<T>> table) {
  std::vector<std::string_view> names;
  for (const Named<T>& entry : table) names.push_back(entry.name);
  return join_names(names);
}

}  // namespace

std::vector<CLI::Option*> RadiosityCommandOptions::add_to(CLI::App& command) {
  return {
      command.add_option("--solver", solver, "Radiosity solver: " + names_of<Solver>(solver_names)),
      command.add_option("--form-factors", form_factors,
                         "Form factors: " + names_of<FormFactorMethod>(form_factor_method_names)),
      command
          .add_option("--radiosity-error", radiosity.relative_error,
                      "Relative error bound of the radiosity solver")
          ->check(CLI::Range(1e-12, 1.0))
          ->capture_default_str(),
      command.add_option("--elements", radiosity.max_elements, "Most radiosity elements")
          ->check(CLI::Range(1, 1 << 30)),
      command.add_option("--subdivision", subdivision,
                         "Sizes of elements: " + names_of<Subdivision>(subdivision_names)),
      command.add_flag("--overshoot", radiosity.overshoot, "Let the solver progressive overshoot"),
      command
          .add_option("--hemicube-resolution", radiosity.hemicube_resolution,
                      "Pixels along an edge of a hemicube, for --form-factors hemicube")
          ->check(CLI::Range(2, 1024))
          ->capture_default_str(),
  };
}

RadiosityOptions RadiosityCommandOptions::settle(std::uint32_t seed) const {
  RadiosityOptions settled = radiosity;
  settled.solver = value_of_name<Solver>(solver_names, solver, "--solver", "solver");
  settled.form_factors = value_of_name<FormFactorMethod>(form_factor_method_names, form_factors,
                                                         "--form-factors", "form factor method");
  settled.subdivision =
      value_of_name<Subdivision>(subdivision_names, subdivision, "--subdivision", "subdivision");
  settled.seed = seed;
  return settled;
}

}  // namespace twopass
