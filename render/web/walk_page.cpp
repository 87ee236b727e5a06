#include "render/web/walk_page.h"

#include <cstring>

#include <nlohmann/json.hpp>

#include "render/core/error.h"
#include "render/web/base64.h"
#include "render/web/page_template.h"

namespace twopass {

namespace {

constexpr char page_html[] =
#include "web/walk.html.inc"
    ;
constexpr char page_css[] =
#include "web/walk.css.inc"
    ;
constexpr char page_js[] =
#include "web/walk.js.inc"
    ;
constexpr char three_js[] =
#include "web/three.min.js.inc"
    ;

// The JSON chunk of a display that glb_of made.
nlohmann::json description_of(std::span<const std::byte> glb, std::string_view where) {
  constexpr std::size_t json_begin = 20;
  const auto refuse = [&]() -> nlohmann::json {
    throw Error(std::string(where), "not a radiosity solution",
                "give a .radiosity or .glb file made with twopass solve");
  };
  std::uint32_t json_size = 0;
  if (glb.size() < json_begin || std::memcmp(glb.data(), "glTF", 4) != 0) return refuse();
  std::memcpy(&json_size, glb.data() + 12, sizeof json_size);
  if (json_size > glb.size() - json_begin) return refuse();
  const auto* begin = reinterpret_cast<const char*>(glb.data()) + json_begin;
  nlohmann::json json = nlohmann::json::parse(begin, begin + json_size, nullptr, false);
  if (json.is_discarded() || json.value("/asset/generator"_json_pointer, "") != "twopass") return refuse();
  return json;
}

std::string facts_of(const nlohmann::json& gltf) {
  std::size_t triangles = 0, shapes = 0;
  for (const nlohmann::json& mesh : gltf.value("meshes", nlohmann::json::array())) {
    ++shapes;
    for (const nlohmann::json& primitive : mesh.at("primitives"))
      triangles +=
          gltf.at("accessors").at(primitive.at("indices").get<std::size_t>()).at("count").get<std::size_t>() /
          3;
  }
  return std::to_string(shapes) + " shapes, " + std::to_string(triangles) + " triangles";
}

}  // namespace

std::string walk_page(std::string_view title, std::span<const std::byte> glb, std::string_view where) {
  std::string facts;
  try {
    facts = facts_of(description_of(glb, where));
  } catch (const nlohmann::json::exception&) {
    throw Error(std::string(where), "the file is damaged", "make it again with twopass solve");
  }
  return fill_in(page_html, {{"title", escape_html(title)},
                             {"facts", escape_html(facts)},
                             {"style", page_css},
                             {"three", three_js},
                             {"model", base64(glb)},
                             {"script", page_js}});
}

}  // namespace twopass
