#include "materials/conductor_presets.h"

#include <string>
#include <vector>

#include "render/core/names.h"

namespace twopass {

namespace {

/// Known by one name. Ag, Al, Au and Cu are integrals of the spectra at luxpop.com (tests/load has them); the
/// others are the integrals of Mitsuba's spectra that the Tungsten renderer (B. Bitterli) publishes, which
/// agree with ours to 1e-4 where both were made, 3e-3 in the index of copper's red.
const Named<ConductorIndex> single[] = {
    {"none", {C3f(0.0f), C3f(1.0f)}},  // an ideal mirror
    {"a-C", {C3f(2.9441f, 2.22715f, 1.968167f), C3f(0.8874329f, 0.7993216f, 0.8152863f)}},
    {"Ag", {C3f(0.1552762f, 0.116728f, 0.1383876f), C3f(4.828355f, 3.122222f, 2.146901f)}},
    {"Al", {C3f(1.657501f, 0.8804047f, 0.5212444f), C3f(9.223811f, 6.269502f, 4.837004f)}},
    {"Au", {C3f(0.143036f, 0.3753071f, 1.442045f), C3f(3.982997f, 2.385556f, 1.603359f)}},
    {"Cr", {C3f(4.369683f, 2.916702f, 1.654701f), C3f(5.206434f, 4.231365f, 3.754947f)}},
    {"Cu", {C3f(0.2010055f, 0.9237495f, 1.102215f), C3f(3.913262f, 2.453045f, 2.14209f)}},
    {"Cu_palik", {C3f(0.212684f, 0.919988f, 1.102408f), C3f(3.921563f, 2.457149f, 2.136653f)}},
    {"Na_palik", {C3f(0.06026653f, 0.05614124f, 0.06199095f), C3f(3.179291f, 2.11248f, 1.579094f)}},
    {"Ni_palik", {C3f(2.367275f, 1.663358f, 1.467055f), C3f(4.498833f, 3.050164f, 2.345427f)}},
    {"V_palik", {C3f(4.277513f, 3.513154f, 2.761126f), C3f(3.491184f, 2.889358f, 3.111697f)}},
    {"W", {C3f(4.370703f, 3.300297f, 2.998267f), C3f(3.500678f, 2.604865f, 2.273193f)}},
};

/// Known with and without "_palik": E. D. Palik (ed.), Handbook of Optical Constants of Solids, 1985 and 1991;
/// integrals as above. Negative integrals, colours out of gamut, are zero as in Mitsuba 3.
const Named<ConductorIndex> palik[] = {
    {"AlAs", {C3f(3.605102f, 3.232937f, 2.217561f), C3f(0.0006670247f, 0.0f, 0.00742612f)}},
    {"AlSb", {C3f(0.0f, 4.142755f, 4.669769f), C3f(0.0f, 0.09376652f, 1.300739f)}},
    {"Be", {C3f(4.185059f, 3.18506f, 2.784091f), C3f(3.83544f, 3.010126f, 2.869009f)}},
    {"CsI", {C3f(2.144903f, 1.702316f, 1.662419f), C3f(0.0f, 0.0f, 0.0f)}},
    {"Cu2O", {C3f(3.549283f, 2.952062f, 2.73692f), C3f(0.1132179f, 0.194666f, 0.6001681f)}},
    {"CuO", {C3f(3.245382f, 2.449629f, 2.197411f), C3f(0.520274f, 0.5707373f, 0.7172251f)}},
    {"d-C", {C3f(2.711252f, 2.318581f, 2.228857f), C3f(0.0f, 0.0f, 0.0f)}},
    {"Hg", {C3f(2.398931f, 1.440025f, 0.9095512f), C3f(6.327627f, 4.371941f, 3.42179f)}},
    {"HgTe", {C3f(4.779527f, 3.230998f, 2.660025f), C3f(1.631983f, 1.580819f, 1.729575f)}},
    {"Ir", {C3f(3.08641f, 2.082194f, 1.617887f), C3f(5.592151f, 4.067176f, 3.267261f)}},
    {"K", {C3f(0.06404931f, 0.04641006f, 0.0381842f), C3f(2.104216f, 1.348936f, 0.9132114f)}},
    {"Li", {C3f(0.2657872f, 0.1956102f, 0.2209199f), C3f(3.540174f, 2.311131f, 1.668593f)}},
    {"MgO", {C3f(2.089589f, 1.650722f, 1.594876f), C3f(0.0f, 0.0f, 0.0f)}},
    {"Mo", {C3f(4.483701f, 3.525458f, 2.776077f), C3f(4.111131f, 3.420872f, 3.150603f)}},
    {"Nb", {C3f(3.420135f, 2.790192f, 2.395586f), C3f(3.441382f, 2.737644f, 2.579913f)}},
    {"Rh", {C3f(2.585795f, 1.860187f, 1.554428f), C3f(6.782293f, 4.70295f, 3.976089f)}},
    {"Se", {C3f(4.059261f, 2.842695f, 2.820758f), C3f(0.7543792f, 0.6385151f, 0.5215872f)}},
    {"Se-e", {C3f(5.724272f, 4.165399f, 4.08161f), C3f(0.8713747f, 1.105285f, 1.564779f)}},
    {"SiC", {C3f(3.172345f, 2.525968f, 2.479362f), C3f(7.284e-07f, 0.0f, 1.0015e-05f)}},
    {"SnTe", {C3f(4.525187f, 1.981153f, 1.281682f), C3f(0.0f, 0.0f, 0.0f)}},
    {"Ta", {C3f(2.062585f, 2.393092f, 2.628068f), C3f(2.408047f, 1.741371f, 1.947038f)}},
    {"Te", {C3f(7.39084f, 4.482103f, 2.637071f), C3f(3.256141f, 3.527391f, 3.292168f)}},
    {"Te-e", {C3f(7.50904f, 4.29646f, 2.369873f), C3f(5.584208f, 4.947623f, 3.997515f)}},
    {"ThF4", {C3f(1.830719f, 1.442227f, 1.387649f), C3f(0.0f, 0.0f, 0.0f)}},
    {"TiC", {C3f(3.700467f, 2.837436f, 2.582303f), C3f(3.265691f, 2.351559f, 2.172786f)}},
    {"TiN", {C3f(1.648469f, 1.150448f, 1.37978f), C3f(3.36846f, 1.943489f, 1.102012f)}},
    {"TiO2", {C3f(3.45662f, 2.801708f, 2.905149f), C3f(0.0001026662f, 0.0f, 0.0006356902f)}},
    {"TiO2-e", {C3f(3.106557f, 2.513155f, 2.582384f), C3f(2.89537e-05f, 0.0f, 0.0001775555f)}},
    {"VC", {C3f(3.657567f, 2.75273f, 2.532681f), C3f(3.068352f, 2.198669f, 1.963182f)}},
    {"VN", {C3f(2.865601f, 2.119182f, 1.940077f), C3f(3.032326f, 2.056108f, 1.616293f)}},
};

constexpr std::string_view palik_suffix = "_palik";

}  // namespace

ConductorIndex conductor_index_of(std::string_view name, std::string_view where) {
  static const std::vector<std::string> palik_names = [] {
    std::vector<std::string> names;
    for (const auto& entry : palik) names.push_back(std::string(entry.name).append(palik_suffix));
    return names;
  }();
  std::vector<Named<ConductorIndex>> table(std::begin(single), std::end(single));
  for (std::size_t i = 0; i < palik_names.size(); ++i) {
    table.push_back(palik[i]);
    table.push_back({palik_names[i], palik[i].value});
  }
  return value_of_name<ConductorIndex>(table, name, where, "conductor");
}

}  // namespace twopass
