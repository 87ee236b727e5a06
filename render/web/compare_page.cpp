#include "render/web/compare_page.h"

#include <cmath>

#include <half.h>
#include <nlohmann/json.hpp>

#include "render/image/error_view.h"
#include "render/web/base64.h"
#include "render/web/compare_json.h"
#include "render/web/page_template.h"
#include "render/web/report.h"

namespace twopass {

namespace {

constexpr char compare_js[] =
#include "web/compare.js.inc"
    ;

constexpr std::size_t most_embedded_bytes = std::size_t{256} << 20;
constexpr std::size_t worst_tile_count = 8;

// --- numbers for the script
// ---------------------------------------------------------------------------------------

// One value a pixel of a scalar layer, three of the others.
std::size_t channels_of(LayerKind kind) { return kind == LayerKind::scalar ? 1 : 3; }

bool is_half(const std::vector<C3f>& pixels) {
  for (const C3f& pixel : pixels)
    for (int c = 0; c < 3; ++c)
      if (std::isfinite(pixel[c]) && static_cast<float>(half(pixel[c])) != pixel[c]) return false;
  return true;
}

template <class Number>
std::string encoded(const std::vector<C3f>& pixels, std::size_t channels) {
  std::vector<Number> values;
  values.reserve(pixels.size() * channels);
  for (const C3f& pixel : pixels)
    for (std::size_t c = 0; c < channels; ++c)
      values.push_back(static_cast<Number>(pixel[static_cast<int>(c)]));
  return base64(std::as_bytes(std::span(values)));
}

std::string data_element(const std::string& id, const std::string& base64_text) {
  return "<script type=\"text/plain\" id=\"" + id + "\">" + base64_text + "</script>\n";
}

// --- pictures for everybody
// ---------------------------------------------------------------------------------------

Image shown(const std::vector<C3f>& pixels, int width, int height, const DisplayTransform& display) {
  Image image(width, height, {"R", "G", "B"});
  for (std::size_t i = 0; i < pixels.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) image.pixels[3 * i + c] = pixels[i][static_cast<int>(c)];
  display.apply(image.pixels);
  return image;
}

Image cut(const Image& image, const ErrorTile& tile) {
  Image part(tile.width, tile.height, image.channels);
  for (int y = 0; y < tile.height; ++y)
    for (int x = 0; x < tile.width; ++x)
      for (int c = 0; c < 3; ++c) part.at(x, y, c) = image.at(tile.x + x, tile.y + y, c);
  return part;
}

std::string figure(const Image& image, const std::string& alt, const std::string& caption, int width) {
  return "<figure><img src=\"" + png_uri(image) + "\" width=\"" + std::to_string(width) + "\" alt=\"" +
         escape_html(alt) + "\">" +
         (caption.empty() ? std::string() : "<figcaption>" + escape_html(caption) + "</figcaption>") +
         "</figure>\n";
}

// A width for the page: small pictures are enlarged by whole numbers.
int shown_width(int width) { return width >= 360 ? 360 : width * std::max(1, 360 / width); }

std::string layer_title(const std::string& name) { return name.empty() ? "picture" : name; }

// --- sections
// -----------------------------------------------------------------------------------------------------

std::string metadata_text(const PictureSource& source) {
  std::string text;
  for (const auto& [name, value] : source.metadata) {
    if (!name.starts_with("twopass/")) continue;
    if (!text.empty()) text += ", ";
    text += name.substr(8) + " ";
    if (const auto* words = std::get_if<std::string>(&value))
      text += *words;
    else if (const auto* number = std::get_if<float>(&value))
      text += number_text(*number);
    else
      text += std::to_string(std::get<int>(value));
  }
  return text;
}

std::string sources_table(const PictureSource& test, const PictureSource& reference) {
  std::string html = "<table><tbody>\n";
  for (const auto& [role, source] : {std::pair("test, t", &test), std::pair("reference, r", &reference)})
    html += "<tr><th scope=\"row\">" + std::string(role) + "</th><td>" + escape_html(source->file) +
            "</td><td class=\"quiet\">" + escape_html(metadata_text(*source)) + "</td></tr>\n";
  return html + "</tbody></table>\n";
}

std::string summary(const ComparedLayer& layer) {
  const Comparison& c = layer.result;
  const auto percent = [](double ratio) { return number_text(100.0 * (ratio - 1.0), 3) + " %"; };
  std::string html = "<p class=\"lead\">Energy: the test has ";
  for (int i = 0; i < 3; ++i)
    html += std::string(i ? ", " : "") + number_text(c.energy_ratio[i], 5) + " &plusmn; " +
            number_text(c.energy_ci95[i], 2);
  html += " of the reference's light in red, green and blue (" + percent(c.energy_ratio.x) + ", " +
          percent(c.energy_ratio.y) + ", " + percent(c.energy_ratio.z) +
          "; &plusmn;: 95 % of what noise that neighbours do not share would do).</p>\n<p>Bias apart from "
          "noise: of the "
          "relMSE of " +
          number_text(c.relmse, 4) + ", bias<sup>2</sup> is " + number_text(c.bias2, 3) + " &plusmn; " +
          number_text(c.bias2_error, 2) + " (standard error), and noise " + number_text(c.variance, 3) +
          ", by what the pixels of 8x8 blocks have in common. Errors that change from pixel to pixel count as "
          "noise, noise that a wide filter spreads over neighbours counts as bias.";
  if (c.known_variance)
    html += " By the variance layer of the files noise is " + number_text(*c.known_variance, 3) +
            ", which leaves a bias<sup>2</sup> of " + number_text(c.relmse - *c.known_variance, 3) + ".";
  return html + "</p>\n";
}

std::string measures_table(std::span<const ComparedLayer> layers) {
  std::string html =
      "<div class=\"wide\"><table><caption>t: test, r: reference, d = t - r. Pixels that are not finite in "
      "either "
      "are left out.</caption>\n<thead><tr><th scope=\"col\">measure</th>";
  for (const ComparedLayer& layer : layers)
    html += "<th scope=\"col\" class=\"n\">" + escape_html(layer_title(layer.pair.name)) + "</th>";
  html += "<th scope=\"col\">formula</th></tr></thead>\n<tbody>\n";
  for (const Measure& measure : measures()) {
    html += "<tr><th scope=\"row\">" + escape_html(measure.name) + "</th>";
    for (const ComparedLayer& layer : layers) {
      html += "<td class=\"n\">";
      if (measure.name == "energy_ratio" && layer.pair.kind != LayerKind::scalar)
        for (int c = 0; c < 3; ++c)
          html += std::string(c ? " " : "") + number_text(layer.result.energy_ratio[c], 5);
      else
        html += number_text(measure.value(layer.result));
      html += "</td>";
    }
    html += "<td class=\"formula\">" + escape_html(measure.formula) + "</td></tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string histogram_svg(const std::vector<float>& relative) {
  const ErrorHistogram histogram = error_histogram(relative);
  constexpr int left = 46, top = 8, bar = 14, height = 130;
  constexpr int count = static_cast<int>(std::tuple_size_v<decltype(histogram.bins)>), width = count * bar;
  std::size_t most = 1;
  for (const std::size_t n : histogram.bins) most = std::max(most, n);
  const auto pixels = static_cast<double>(relative.size());
  std::string svg = "<svg role=\"img\" aria-label=\"Histogram of the relative errors of the pixels\" width=\"" +
                    std::to_string(width + left + 20) + "\" height=\"" + std::to_string(height + 50) + "\">\n";
  for (int i = 0; i < count; ++i) {
    const std::size_t n = histogram.bins[static_cast<std::size_t>(i)];
    if (n == 0) continue;
    const double h = std::max(1.0, height * static_cast<double>(n) / static_cast<double>(most));
    svg += "<rect class=\"bar\" x=\"" + std::to_string(left + i * bar) + "\" y=\"" +
           number_text(top + height - h) + "\" width=\"" + std::to_string(bar - 1) + "\" height=\"" +
           number_text(h) + "\"><title>" + number_text(100.0 * static_cast<double>(n) / pixels, 3) +
           " % of the pixels</title></rect>\n";
  }
  for (int i = 0; i <= count; i += ErrorHistogram::bins_per_decade)
    svg += "<text text-anchor=\"middle\" x=\"" + std::to_string(left + i * bar) + "\" y=\"" +
           std::to_string(top + height + 16) + "\">1e" +
           std::to_string(ErrorHistogram::lowest_decade + i / ErrorHistogram::bins_per_decade) + "</text>\n";
  const std::string base = std::to_string(top + height);
  svg += "<path class=\"axis\" d=\"M" + std::to_string(left) + " " + base + "H" + std::to_string(left + width) +
         "\"/>\n<text text-anchor=\"end\" x=\"" + std::to_string(left - 6) + "\" y=\"" +
         std::to_string(top + 10) + "\">" + number_text(100.0 * static_cast<double>(most) / pixels, 2) +
         " %</text>\n<text x=\"" + std::to_string(left) + "\" y=\"" + std::to_string(top + height + 34) +
         "\">root of the pixel's relMSE</text></svg>\n";
  return svg + "<p class=\"quiet\">" + std::to_string(histogram.below) + " pixels are below that, " +
         std::to_string(histogram.above) + " above.</p>\n";
}

std::string tiles_section(const LayerPair& pair, const Image& test, const Image& reference) {
  const int size = std::clamp(std::max(pair.width, pair.height) / 24, 4, 32);
  std::string html = "<h2>Worst tiles</h2>\n<table><caption>Of " + std::to_string(size) + "x" +
                     std::to_string(size) +
                     " pixels, by relMSE; bias is the mean of d / sqrt(r^2 + 0.01)</caption>\n<thead><tr><th "
                     "scope=\"col\">at</th><th scope=\"col\" class=\"n\">relMSE</th><th scope=\"col\" "
                     "class=\"n\">bias</th><th scope=\"col\" class=\"n\">share of the error</th><th "
                     "scope=\"col\">test</th><th scope=\"col\">reference</th></tr></thead>\n<tbody>\n";
  for (const ErrorTile& tile : worst_tiles(pair, size, worst_tile_count)) {
    const std::string place = std::to_string(tile.x) + "," + std::to_string(tile.y) + "," +
                              std::to_string(tile.width) + "," + std::to_string(tile.height);
    const std::string at = std::to_string(tile.x) + ", " + std::to_string(tile.y);
    html += "<tr><td><a href=\"#viewer\" data-tile=\"" + place + "\">" + at + "</a></td><td class=\"n\">" +
            number_text(tile.relmse, 4) + "</td><td class=\"n\">" + number_text(tile.bias, 3) +
            "</td><td class=\"n\">" + number_text(100.0 * tile.share, 3) + " %</td><td>" +
            figure(cut(test, tile), "test at " + at, "", 64) + "</td><td>" +
            figure(cut(reference, tile), "reference at " + at, "", 64) + "</td></tr>\n";
  }
  return html + "</tbody></table>\n";
}

// What the first layer looks like, without a script.
std::string pictures_section(const ComparedLayer& layer, const ErrorMaps& maps, const Image& test,
                             const Image& reference, const DisplayTransform& display) {
  const int w = layer.pair.width, h = layer.pair.height, width = shown_width(w);
  const float most = quantile_of_magnitude(maps.difference, 0.99);
  const float most_magnitude = quantile_of_magnitude(maps.magnitude, 0.99);
  std::string html = "<section id=\"pictures\"><h2>Pictures</h2>\n<p class=\"quiet\">Seen through " +
                     escape_html(display.description()) + ".</p>\n<div class=\"pictures\">\n";
  html += figure(test, "the test picture", "test", width);
  html += figure(reference, "the reference picture", "reference", width);
  html += figure(
      colored(maps.difference, w, h, -most, most, diverging_colors()), "heat map of test minus reference",
      "t - r, mean of the channels: blue " + number_text(-most, 3) + ", white 0, red " + number_text(most, 3),
      width);
  html += figure(colored(maps.magnitude, w, h, 0.0f, most_magnitude, sequential_colors()),
                 "heat map of the magnitude of the difference",
                 "|t - r|, mean of the channels: black 0, light " + number_text(most_magnitude, 3) +
                     " (99 % of the pixels are below)",
                 width);
  if (!layer.result.flip_map.empty())
    html += figure(colored(layer.result.flip_map, w, h, 0.0f, 1.0f, sequential_colors()), "map of FLIP",
                   "FLIP: black 0, light 1", width);
  return html + "</div></section>\n";
}

std::string viewer_section(const nlohmann::ordered_json& layers) {
  std::string html =
      "<section id=\"viewer\" hidden><h2>Look</h2>\n<div class=\"tools\" id=\"modes\" role=\"group\" "
      "aria-label=\"What is shown\">\n";
  constexpr std::array<std::pair<const char*, const char*>, 8> modes{{{"test", "Test"},
                                                                      {"reference", "Reference"},
                                                                      {"signed", "Difference"},
                                                                      {"magnitude", "Magnitude"},
                                                                      {"relative", "Relative"},
                                                                      {"flip", "FLIP"},
                                                                      {"swipe", "Swipe"},
                                                                      {"side", "Side by side"}}};
  int key = 0;
  for (const auto& [mode, title] : modes)
    html += "<button type=\"button\" data-mode=\"" + std::string(mode) + "\" aria-pressed=\"false\">" +
            std::to_string(++key) + " " + title + "</button>\n";
  html += "</div>\n<div class=\"tools\"><label>Layer <select id=\"layer\">";
  int number = 0;
  for (const auto& layer : layers)
    html += "<option value=\"" + std::to_string(number++) + "\">" +
            escape_html(layer_title(layer["name"].get<std::string>())) + "</option>";
  html +=
      "</select></label>\n<label>Exposure <input id=\"exposure\" type=\"range\" min=\"-10\" max=\"10\" "
      "step=\"0.5\" value=\"0\"></label> <span id=\"stops\">0 stops</span>\n<span id=\"scale\"></span> <button "
      "type=\"button\" id=\"reset\">Reset</button></div>\n<canvas id=\"screen\" tabindex=\"0\" role=\"img\" "
      "aria-label=\"The pictures; arrow keys move the pixel that is read out\"></canvas>\n<div "
      "class=\"bar-legend\" id=\"legend\"><span id=\"low\"></span><canvas id=\"colors\" width=\"256\" "
      "height=\"1\" "
      "aria-hidden=\"true\"></canvas><span id=\"high\"></span></div>\n<div id=\"readout\"></div>\n<p "
      "class=\"quiet\"><kbd>1</kbd> to <kbd>8</kbd> what is shown, <kbd>f</kbd> flips between test and "
      "reference, "
      "<kbd>e</kbd> <kbd>E</kbd> exposure down and up, <kbd>d</kbd> <kbd>D</kbd> wider and narrower range of "
      "the "
      "maps, <kbd>l</kbd> next layer, <kbd>[</kbd> <kbd>]</kbd> the line of the swipe, wheel or <kbd>+</kbd> "
      "<kbd>-</kbd> zoom, drag to move, arrow keys the pixel, <kbd>r</kbd> reset. Not-finite pixels are "
      "magenta.</p>\n</section>\n";
  return html;
}

// Facts about the layers, and their pixels as far as there is room.
struct Embedded {
  nlohmann::ordered_json layers = nlohmann::ordered_json::array();
  std::string elements;
  std::vector<std::string> left_out;
};

Embedded embed(std::span<const ComparedLayer> layers) {
  Embedded embedded;
  std::size_t bytes = 0;
  for (const ComparedLayer& layer : layers) {
    const LayerPair& pair = layer.pair;
    const std::size_t channels = channels_of(pair.kind);
    const bool half_is_enough = is_half(pair.test) && is_half(pair.reference);
    bytes += 2 * pair.test.size() * channels * (half_is_enough ? sizeof(half) : sizeof(float));
    if (bytes > most_embedded_bytes) {
      embedded.left_out.push_back(layer_title(pair.name));
      continue;
    }
    const ErrorMaps maps = error_maps(pair);
    const std::string number = std::to_string(embedded.layers.size());
    embedded.layers.push_back({{"name", pair.name},
                               {"channels", channels},
                               {"type", half_is_enough ? "half" : "float"},
                               {"reach", quantile_of_magnitude(maps.magnitude, 0.99)},
                               {"relativeReach", quantile_of_magnitude(maps.relative, 0.99)},
                               {"flip", !layer.result.flip_map.empty()}});
    const auto text = [&](const std::vector<C3f>& pixels) {
      return half_is_enough ? encoded<half>(pixels, channels) : encoded<float>(pixels, channels);
    };
    embedded.elements += data_element("test" + number, text(pair.test));
    embedded.elements += data_element("reference" + number, text(pair.reference));
    if (layer.result.flip_map.empty()) continue;
    std::vector<std::uint8_t> flip;
    for (const float e : layer.result.flip_map)
      flip.push_back(static_cast<std::uint8_t>(std::lround(255.0f * e)));
    embedded.elements += data_element("flip" + number, base64(std::as_bytes(std::span(flip))));
  }
  return embedded;
}

}  // namespace

std::string compare_page(const PictureSource& test, const PictureSource& reference,
                         std::span<const ComparedLayer> layers, const DisplayTransform& display) {
  const ComparedLayer& first = layers.front();
  const int width = first.pair.width, height = first.pair.height;
  const Image test_image = shown(first.pair.test, width, height, display);
  const Image reference_image = shown(first.pair.reference, width, height, display);
  const ErrorMaps maps = error_maps(first.pair);
  const Embedded embedded = embed(layers);

  const std::string title = "twopass compare: " + test.file + " against " + reference.file;
  std::string body = "<h1>" + escape_html(test.file) + " against " + escape_html(reference.file) + "</h1>\n";
  body += "<p class=\"quiet\">" + std::to_string(width) + "x" + std::to_string(height) + " pixels, " +
          std::to_string(layers.size()) + (layers.size() == 1 ? " layer" : " layers") + "</p>\n";
  body += sources_table(test, reference) + summary(first);
  const bool is_viewable = !embedded.layers.empty() && embedded.left_out.size() < layers.size();
  if (is_viewable) body += viewer_section(embedded.layers);
  for (const std::string& name : embedded.left_out)
    body += "<p>The pixels of the layer " + escape_html(name) +
            " are too many to be looked at here; compare a part of it with --crop.</p>\n";
  body += pictures_section(first, maps, test_image, reference_image, display);
  body += "<h2>Measures</h2>\n" + measures_table(layers);
  body += "<h2>Histogram of errors</h2>\n" + histogram_svg(maps.relative);
  body += tiles_section(first.pair, test_image, reference_image);

  const nlohmann::ordered_json facts = {{"width", width}, {"height", height}, {"layers", embedded.layers}};
  const auto json_element = [](const char* id, const nlohmann::ordered_json& json) {
    return "<script type=\"application/json\" id=\"" + std::string(id) + "\">" +
           escape_json_in_html(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) +
           "</script>\n";
  };
  body += json_element("measures", comparison_json(layers));
  if (is_viewable) {
    body += json_element("report", facts) + embedded.elements;
    body += data_element("sequential", base64(std::as_bytes(std::span(sequential_colors()))));
    body += data_element("diverging", base64(std::as_bytes(std::span(diverging_colors()))));
  }
  return html_document(title, body, is_viewable ? compare_js : std::string_view());
}

}  // namespace twopass
