#include <gtest/gtest.h>

#include "radiosity/display_mesh.h"
#include "radiosity/mesh_files.h"
#include "render/core/error.h"
#include "render/web/base64.h"
#include "render/web/page_template.h"
#include "render/web/walk_page.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

std::string encoded(std::string_view text) { return base64(std::as_bytes(std::span(text))); }

// The vectors of RFC 4648, section 10.
TEST(Base64, OfTheStandardsExamples) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xff\xfe\xfd"), "//79");
}

TEST(PageTemplate, FillsInWithoutLookingAgain) {
  EXPECT_EQ(fill_in("<{{a}}{{b}}>{{a}}", {{"a", "{{b}}"}, {"b", "2"}}), "<{{b}}2>{{b}}");
  EXPECT_EQ(fill_in("{ {x} }}", {}), "{ {x} }}");
  EXPECT_THROW(fill_in("{{none}}", {}), std::logic_error);
  EXPECT_EQ(escape_html("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
}

TEST(WalkPage, HoldsTheModelAndNeedsNothingElse) {
  const Scene scene(test::unit_room(C3f(0.5f), C3f(1.0f / pi_f), C3f(0.5f)));
  const std::vector<std::byte> glb = glb_of(display_mesh(scene, solve_radiosity(scene,
                                                                                [] {
                                                                                  RadiosityOptions o;
                                                                                  o.max_elements = 100;
                                                                                  return o;
                                                                                }())),
                                            scene, "a");
  const std::string page = walk_page("<script>alert(1)</script>", glb, "a");
  EXPECT_NE(page.find(base64(glb)), page.npos);
  EXPECT_NE(page.find("&lt;script&gt;alert(1)"), page.npos);
  EXPECT_EQ(page.find("<script>alert"), page.npos);
  for (const char* outside : {"src=\"", "href=\"", "@import", "fetch("}) {
    const std::string own = page.substr(0, page.find("<canvas"));
    EXPECT_EQ(own.find(outside), own.npos) << outside;
  }
  EXPECT_THROW(walk_page("x", std::span(glb).first(40), "a"), Error);
  EXPECT_THROW(walk_page("x", {}, "a"), Error);
}

}  // namespace
}  // namespace twopass
