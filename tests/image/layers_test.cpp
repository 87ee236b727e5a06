#include "render/image/layers.h"

#include <gtest/gtest.h>

namespace twopass {
namespace {

TEST(Layers, ChannelsAreGroupedByWhatStandsBeforeTheLastDot) {
  const Image image(
      2, 1,
      {"Z", "R", "G", "B", "A", "light.left.B", "light.left.G", "light.left.R", "N.X", "N.Y", "N.Z", "albedo.R",
       "albedo.G", "crypto00.R", "crypto00.G", "crypto00.B", "crypto00.A", "grey.Y"});
  const std::vector<Layer> layers = layers_of(image);
  std::vector<std::string> names;
  for (const Layer& layer : layers) names.push_back(layer.name);
  EXPECT_EQ(names, (std::vector<std::string>{"", "Z", "A", "light.left", "N", "albedo.R", "albedo.G",
                                             "crypto00", "crypto00.A", "grey"}));
  EXPECT_EQ(layers[0].kind, LayerKind::color);
  EXPECT_EQ(layers[1].kind, LayerKind::scalar);
  EXPECT_EQ(layers[3].channels, (std::array<int, 3>{7, 6, 5})) << "in the order R, G, B";
  EXPECT_EQ(layers[4].kind, LayerKind::vector);
  EXPECT_EQ(layers[9].kind, LayerKind::color);
}

TEST(Layers, ValuesOfALayer) {
  Image image(2, 1, {"B", "G", "R", "Z"});
  image.pixels = {1, 2, 3, 4, 5, 6, 7, 8};
  const std::vector<Layer> layers = layers_of(image);
  ASSERT_EQ(layers.size(), 2u);
  EXPECT_EQ(layer_pixels(image, layers[0])[1], C3f(7, 6, 5));
  EXPECT_EQ(layer_pixels(image, layers[1])[0], C3f(4, 4, 4));
  EXPECT_TRUE(layers_of(Image()).empty());
}

TEST(Layers, LuminanceAloneIsThePicture) {
  const std::vector<Layer> layers = layers_of(Image(1, 1, {"Y"}));
  ASSERT_EQ(layers.size(), 1u);
  EXPECT_EQ(layers[0].name, "");
  EXPECT_EQ(layers[0].kind, LayerKind::color);
}

}  // namespace
}  // namespace twopass
