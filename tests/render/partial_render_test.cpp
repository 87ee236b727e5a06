#include "render/partial_render.h"

#include "tests/image/files.h"

namespace twopass {
namespace {

using PartialRenders = FileTest;

Film film_of(int width, int height, int samples) {
  Film film(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int i = 0; i < 2; ++i) {
        PixelBatch batch;
        for (int s = 0; s < samples / 2; ++s) batch.add(C3f(0.1f * static_cast<float>(x + s), 0.3f, 1e-3f));
        film.add_pixel(x, y, batch);
      }
  return film;
}

PartialRender some_part() {
  PartialRender part;
  part.identity = {"0.1.0", "00aa", "00bb", {{"integrator", "path"}, {"seed", "7"}}};
  part.ranges = {{4, 8}, {12, 16}};
  part.all_samples = 16;
  part.footprint_samples = 12;
  part.state.costs = {{1ull << 60, 2, 3}, 4};
  part.state.plan = {
      .in_pass = true, .before = 4, .after = 8.1, .error = 1.0 / 3.0, .step = 5, .pilot_samples = 32};
  return part;
}

TEST_F(PartialRenders, ComeBackAsTheyWere) {
  PartialRender part = some_part();
  part.state.plan.levels.assign(12, 77);
  part.state.plan.variances.assign(SampleShares::level_count(), 0.1);
  part.state.plan.variances[3] = 1e300;
  part.state.plan.shares_of = 16;
  ExrOptions options;
  options.pixel_type = PixelType::float_;
  options.compression = ExrCompression::piz;
  options.parts = ExrParts::layer;
  options.chromaticities = ExrChromaticities::never;
  options.color_space = "lin_ap1_scene";
  options.float_layers = {"CryptoObject00"};
  options.integer_layers = {"samples"};
  options.world_to_camera = M44f(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16);
  save_partial(file("a.exr"), film_of(4, 3, 4), part, options);
  const PartialFile stored(file("a.exr"));
  EXPECT_EQ(stored.options().compression, ExrCompression::piz);
  EXPECT_EQ(stored.options().parts, ExrParts::layer);
  EXPECT_EQ(stored.options().chromaticities, ExrChromaticities::never);
  EXPECT_EQ(stored.options().color_space, "lin_ap1_scene");
  EXPECT_EQ(stored.options().float_layers, options.float_layers);
  EXPECT_EQ(stored.options().integer_layers, options.integer_layers);
  EXPECT_EQ(stored.options().world_to_camera, options.world_to_camera);
  const PartialRender& read = stored.part();
  EXPECT_EQ(read.identity, part.identity);
  EXPECT_EQ(ranges_text(read.ranges), "4 to 7 and 12 to 15");
  EXPECT_EQ(read.all_samples, 16u);
  EXPECT_EQ(read.footprint_samples, 12);
  EXPECT_EQ(stored.options().pixel_type, PixelType::float_);
  EXPECT_EQ(read.state.costs.counts.rays, 1ull << 60);
  EXPECT_EQ(read.state.costs.non_finite_samples, 4u);
  Film film(4, 3);
  PlanState plan;
  stored.merge_into(film, &plan);
  EXPECT_TRUE(plan.in_pass);
  EXPECT_EQ(plan.after, 8.1);
  EXPECT_EQ(plan.error, 1.0 / 3.0);
  EXPECT_EQ(plan.step, 5);
  EXPECT_EQ(plan.pilot_samples, 32);
  EXPECT_EQ(plan.levels, part.state.plan.levels);
  EXPECT_EQ(plan.variances, part.state.plan.variances);
  EXPECT_EQ(plan.shares_of, 16u);
  part.state.plan.error = std::numeric_limits<double>::infinity();
  part.can_resume = false;
  save_partial(file("a.exr"), film_of(4, 3, 4), part, {});
  EXPECT_FALSE(PartialFile(file("a.exr")).part().can_resume);
}

TEST_F(PartialRenders, LayersAndCryptomattesComeAlong) {
  FilmLayout layout;
  layout.layers = {{"diffuse", {"R", "G", "B"}, Reduction::mean},
                   {"P", {"X", "Y", "Z"}, Reduction::nearest},
                   {"", {"bad"}, Reduction::total},
                   {"", {"n"}, Reduction::samples}};
  layout.cryptomattes = {"CryptoObject", "CryptoMaterial"};
  layout.has_signed_weights = true;
  const auto some_film = [&](std::uint32_t seed) {
    Film film(7, 5, layout);
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 7; ++x)
        for (std::uint32_t k = 0; k < 3; ++k) {
          const std::size_t i = film.index(x, y);
          const float f = 0.1f * static_cast<float>(static_cast<std::uint32_t>(x) + seed + k);
          PixelBatch batch;
          batch.add(C3f(f, 2.0f, 3.0f), 1.0f, 1.0f + f);
          film.add_pixel(x, y, batch);
          const std::vector<float> values{f, 1.0f, 0.5f, f, 2.0f * f, 3.0f, 1.0f};
          film.layers().add(i, values, 1.0f + f, f);
          film.cryptomattes()[0].add(i, seed + k, 1.0f + f);
          if (x > 3) film.cryptomattes()[1].add(i, 7u, 1.0f);
        }
    return film;
  };
  const Film a = some_film(1), b = some_film(2);
  Film expected = a;
  expected.merge(b);
  save_partial(file("a.exr"), a, some_part(), {});
  save_partial(file("b.exr"), b, some_part(), {});
  Film merged(7, 5, PartialFile(file("a.exr")).layout());
  EXPECT_EQ(merged.layout().channels(), layout.channels());
  PartialFile(file("a.exr")).merge_into(merged);
  PartialFile(file("b.exr")).merge_into(merged);
  EXPECT_EQ(merged.resolve_all().pixels, expected.resolve_all().pixels);
  Film bare(7, 5);
  EXPECT_TRUE(contains(error_of([&] { PartialFile(file("a.exr")).merge_into(bare); }), "other layers"));
}

TEST_F(PartialRenders, FilesWithoutTheirDescriptionAreRefused) {
  write_film(file("a.exr"), film_of(4, 3, 4), {}, {});
  EXPECT_TRUE(contains(error_of([&] { PartialFile(file("a.exr")); }), "no description"));
  ExrOptions options;
  for (const char* text : {"", "{", "[]", R"({"format":2})", R"({"format":99})"}) {
    options.metadata = {{"twopass/partial", std::string(text)}};
    write_film(file("a.exr"), film_of(4, 3, 4), {}, options);
    EXPECT_TRUE(contains(error_of([&] { PartialFile(file("a.exr")); }), "description cannot be read")) << text;
  }
}

TEST(SampleRanges, AreJoinedAndOverlapsRefused) {
  EXPECT_EQ(ranges_text(joined_ranges({{0, 4}}, {{4, 8}}, "b")), "0 to 7");
  EXPECT_EQ(ranges_text(joined_ranges({{8, 12}}, {{0, 4}}, "b")), "0 to 3 and 8 to 11");
  EXPECT_EQ(ranges_text(joined_ranges({{0, 4}, {8, 12}}, {{4, 8}, {20, 21}}, "b")), "0 to 11 and 20 to 20");
  EXPECT_EQ(ranges_text(joined_ranges({{0, 4}}, {{2, 2}}, "b")), "0 to 3") << "an empty part";
  for (const SampleRange& range : {SampleRange{3, 8}, {0, 4}, {1, 2}, {0, 100}})
    EXPECT_TRUE(contains(error_of([&] { joined_ranges({{0, 4}}, {range}, "b.exr"); }), "b.exr: its samples "));
}

TEST(RenderIdentity, TheFirstDifferenceIsNamed) {
  const RenderIdentity a = some_part().identity;
  const auto message = [&](auto change) {
    RenderIdentity b = a;
    change(b);
    return error_of([&] { check_same_render(b, "b.exr", a, "a.exr"); });
  };
  check_same_render(a, "b.exr", a, "a.exr");
  EXPECT_TRUE(contains(message([](RenderIdentity& b) { b.version = "0.2.0"; }), "version 0.2.0"));
  EXPECT_TRUE(contains(message([](RenderIdentity& b) { b.scene = "x"; }), "another scene"));
  EXPECT_TRUE(contains(message([](RenderIdentity& b) { b.solution = ""; }), "another radiosity solution"));
  EXPECT_TRUE(contains(message([](RenderIdentity& b) { b.settings[1].second = "8"; }),
                       "b.exr: its seed is 8, that of a.exr is 7; "));
  EXPECT_TRUE(contains(message([](RenderIdentity& b) { b.settings.pop_back(); }), "settings"));
}

}  // namespace
}  // namespace twopass
