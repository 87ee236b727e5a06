#include "render/commands/layer_options.h"

#include "render/commands/picture_outputs.h"
#include "render/core/error.h"
#include "render/image/picture.h"

namespace twopass {

void LayerOptions::add_to(CLI::App& command) {
  command.add_option(
      "--aov", aovs,
      "Layers of .exr files, with commas: light (diffuse, specular and transmission x _direct and "
      "_indirect, emission, background: they sum to the picture), denoise (albedo and N), all, or: "
      "albedo N Ng P Z uv id element radiosity cache choice samples variance invalid, and each of light");
  command.add_flag("--light-groups", light_groups,
                   "One layer light_NAME for each group of lights; they sum to the picture");
  command.add_option("--cryptomatte", cryptomattes,
                     "Cryptomatte layers of .exr files, with commas: object, material, asset, all");
  command.add_option("--exr-compression", compression,
                     "none, rle, zips (default), zip, piz; for colours alone: pxr24, "
                     "b44, b44a, dwaa, dwab");
  command.add_option("--exr-parts", parts, "single (default) or layer: a part for each layer");
  command.add_option("--exr-chromaticities", chromaticities,
                     "auto (default: unless they are those of Rec.709), always or never");
  add_denoise_option(command, denoise);
  command.add_flag("--exr-seconds", seconds,
                   "Write the time of rendering into .exr files, which then differ between equal renders");
  command
      .add_option(
          "--overscan", overscan,
          "Pixels rendered around the picture as well: the data window of .exr files is larger than their "
          "display window")
      ->check(CLI::Range(0, 1 << 14));
}

LayerRequest LayerOptions::request() const {
  LayerRequest request;
  const std::string guides = denoise ? "denoise" : "";
  if (const std::string list = aovs + (aovs.empty() || !denoise ? "" : ",") + guides; !list.empty())
    request.aovs = aovs_of(list);
  if (!cryptomattes.empty()) request.cryptomattes = cryptomattes_of(cryptomattes);
  request.light_groups = light_groups;
  return request;
}

void LayerOptions::check(const LayerRequest& request, const std::vector<std::string>& outputs,
                         const ExrOptions& exr) const {
  FilmLayout layout;
  for (const Aov aov : request.aovs) layout.layers.push_back(layer_of(aov));
  for (const CryptomatteKind kind : request.cryptomattes)
    layout.cryptomattes.emplace_back(cryptomatte_layer(kind));
  bool has_exr = false;
  for (const std::string& output : outputs) {
    if (is_display_referred(output)) continue;
    has_exr = true;
    check_exr(output, layout.channels(), exr);
  }
  const bool asked = !aovs.empty() || light_groups || !cryptomattes.empty();
  if (!has_exr && asked) throw Error(outputs.front(), "only .exr files hold layers", "add -o picture.exr");
}

void LayerOptions::settle(const LayerRequest& request, ExrOptions& exr) const {
  exr.compression =
      value_of_name<ExrCompression>(exr_compression_names, compression, "--exr-compression", "compression");
  exr.parts = value_of_name<ExrParts>(exr_parts_names, parts, "--exr-parts", "value");
  exr.chromaticities = value_of_name<ExrChromaticities>(exr_chromaticities_names, chromaticities,
                                                        "--exr-chromaticities", "value");
  exr.float_layers = {"variance"};
  for (const CryptomatteKind kind : request.cryptomattes)
    for (int layer = 0; layer < cryptomatte_levels / 2; ++layer)
      exr.float_layers.push_back(std::string(cryptomatte_layer(kind)) + "0" + std::to_string(layer));
  exr.integer_layers = {"id", "element"};
}

}  // namespace twopass
