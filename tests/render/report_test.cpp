// Reports hold what they should, and nothing that a browser would misread or fetch.
#include "render/web/report.h"

#include <regex>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "render/web/compare_json.h"
#include "render/web/compare_page.h"
#include "render/web/page_template.h"

namespace twopass {
namespace {

TEST(Report, JsonDoesNotEndItsElement) {
  const std::string json = nlohmann::json("</script><!--").dump(), escaped = escape_json_in_html(json);
  EXPECT_EQ(escaped.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(escaped), nlohmann::json::parse(json));
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++found;
  return found;
}

// What stands in the element with the id, up to the next tag.
std::string content_of_id(const std::string& page, const std::string& id) {
  const std::size_t at = page.find("id=\"" + id + "\">");
  if (at == std::string::npos) return {};
  const std::size_t begin = page.find('>', at) + 1;
  return page.substr(begin, page.find('<', begin) - begin);
}

std::vector<ComparedLayer> layers(float step) {
  std::vector<ComparedLayer> result;
  for (const auto& [name, kind] : {std::pair("", LayerKind::color), std::pair("Z", LayerKind::scalar)}) {
    LayerPair pair{.name = name, .kind = kind, .width = 10, .height = 7};
    for (int i = 0; i < 70; ++i) {
      const float r = 0.25f * static_cast<float>(i % 5);
      pair.reference.emplace_back(r, r, r);
      pair.test.emplace_back(r + step, r, r + 2.0f * step);
    }
    Comparison comparison = compare(pair);
    result.push_back({std::move(pair), std::move(comparison)});
  }
  return result;
}

TEST(ComparePage, HoldsMeasuresFormulasPicturesAndTheNumbersThemselves) {
  const auto compared = layers(0.125f);
  const std::string page =
      compare_page({"a.exr", {{"twopass/spp", 16.0f}}}, {"b.exr", {}}, compared, DisplayTransform());
  for (const Measure& measure : measures())
    EXPECT_NE(page.find(escape_html(measure.formula)), std::string::npos);
  EXPECT_LT(page.find("Energy:"), page.find("Bias apart from noise")) << "energy comes first";
  EXPECT_LT(page.find("Bias apart from noise"), page.find("psnr"));
  EXPECT_NE(page.find("spp 16"), std::string::npos);
  EXPECT_EQ(count(page, "<img"), count(page, "alt=\"")) << "every picture has a text";
  EXPECT_EQ(count(page, "alt=\"\""), 0u);
  EXPECT_NE(page.find("<svg role=\"img\" aria-label="), std::string::npos);
  EXPECT_EQ(count(page, "data-mode="), 8u);

  const auto facts = nlohmann::json::parse(content_of_id(page, "report"));
  ASSERT_EQ(facts["layers"].size(), 2u);
  EXPECT_EQ(facts["layers"][0]["type"], "half") << "all values are halves";
  EXPECT_EQ(facts["layers"][1]["channels"], 1);
  EXPECT_EQ(content_of_id(page, "test0").size(), (70u * 3 * 2 + 2) / 3 * 4);
  EXPECT_EQ(content_of_id(page, "reference1").size(), (70u * 2 + 2) / 3 * 4);
  EXPECT_EQ(content_of_id(page, "flip0").size(), (70u + 2) / 3 * 4);
  const auto json = nlohmann::json::parse(content_of_id(page, "measures"));
  EXPECT_DOUBLE_EQ(json["relmse"], compared[0].result.relmse);
  EXPECT_DOUBLE_EQ(json["layers"]["Z"]["mse"], compared[1].result.mse);
  EXPECT_TRUE(json["layers"]["Z"]["flip"].is_null());
}

TEST(ComparePage, FloatsStayFloats) {
  const std::string page = compare_page({"a", {}}, {"b", {}}, layers(0.1f), DisplayTransform());
  const auto facts = nlohmann::json::parse(content_of_id(page, "report"));
  EXPECT_EQ(facts["layers"][0]["type"], "float");
  EXPECT_EQ(content_of_id(page, "test0").size(), 70u * 3 * 4 / 3 * 4);
}

TEST(ComparePage, NeedsNoNetworkAndSurvivesHostileNames) {
  const std::string evil = "</script><script>alert(1)</script><img onerror='a'>\"&.exr";
  const std::string page =
      compare_page({evil, {{"twopass/scene", evil}}}, {evil, {}}, layers(0.1f), DisplayTransform());
  EXPECT_EQ(page.find("alert(1)</script>"), std::string::npos);
  EXPECT_EQ(page.find("<img onerror"), std::string::npos);
  const std::regex fetched(R"((?:src|href)=["']?(?!data:|#)[^"' >])");
  EXPECT_FALSE(std::regex_search(page, fetched));
  for (const char* word : {"http://", "https://", "fetch(", "XMLHttpRequest", "import("})
    EXPECT_EQ(page.find(word), std::string::npos) << word;
  for (const char* tag :
       {"table", "figure", "section", "script", "svg", "html", "body", "thead", "tbody", "tr"})
    EXPECT_EQ(count(page, "<" + std::string(tag) + ">") + count(page, "<" + std::string(tag) + " "),
              count(page, "</" + std::string(tag) + ">"))
        << tag;
}

}  // namespace
}  // namespace twopass
