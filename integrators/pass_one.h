// What the radiosity pass leaves for integrators to read.
#pragma once

namespace twopass {

class CausticMap;
class Guide;
class IndirectField;
class Solution;

/// Results of pass one, each of which may be missing: integrators then do what they do without. REQUIRES: field
/// and guide are of the solution, and without caustics where there is a map of them; all outlive who reads
/// them.
struct PassOne {
  const Solution* solution = nullptr;
  const IndirectField* field = nullptr;  ///< null: indirect light is gathered everywhere
  const Guide* guide = nullptr;          ///< null: directions are drawn from the scattering models alone
  const CausticMap* caustics = nullptr;  ///< null: caustics are found by chance
  /// Gathering goes over one more diffuse surface before the solution is read: less of its error is seen, by
  /// longer paths.
  bool gathers_twice = false;
};

}  // namespace twopass
