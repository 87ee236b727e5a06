#include "render/load/serialized_file.h"

#include <cstring>

#include <zlib.h>

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

template <class T>
void put(std::string& to, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  to.append(bytes, sizeof(T));
}

std::string compressed(const std::string& text) {
  uLongf size = compressBound(text.size());
  std::string result(size, ' ');
  compress(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(text.data()),
           text.size());
  result.resize(size);
  return result;
}

std::string prefix(int version) {
  std::string text;
  put(text, std::uint16_t{0x041c});
  put(text, static_cast<std::uint16_t>(version));
  return text;
}

struct Options {
  int version = 4;
  bool is_double = false;
  std::uint32_t flags = 0;
  float height = 0.0f;  // of its plane
  std::uint64_t vertices = 4, triangles = 2;
  std::uint32_t last_index = 3;
};

// A square, as one mesh of a file.
std::string mesh(const Options& options) {
  std::string data;
  put(data, options.flags | (options.is_double ? 0x2000u : 0x1000u));
  if (options.version == 4) data += std::string("square") + '\0';
  put(data, options.vertices);
  put(data, options.triangles);
  const auto numbers = [&](std::initializer_list<float> values) {
    for (const float x : values) options.is_double ? put(data, double{x}) : put(data, x);
  };
  const float z = options.height;
  numbers({0, 0, z, 1, 0, z, 1, 1, z, 0, 1, z});
  if (options.flags & 1u) numbers({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 2});
  if (options.flags & 2u) numbers({0, 0, 0.5f, 0, 0.5f, 0.25f, 0, 0.25f});
  if (options.flags & 8u) numbers({1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1});
  for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, options.last_index}) put(data, k);
  return prefix(options.version) + compressed(data);
}

std::string file(int version, const std::vector<std::string>& meshes) {
  std::string text;
  std::vector<std::uint64_t> offsets;
  for (const std::string& one : meshes) {
    offsets.push_back(text.size());
    text += one;
  }
  for (const std::uint64_t offset : offsets)
    version == 3 ? put(text, static_cast<std::uint32_t>(offset)) : put(text, offset);
  put(text, static_cast<std::uint32_t>(meshes.size()));
  return text;
}

class SerializedFile : public LoadTest {
 protected:
  SerializedMesh read(const std::string& text, int index = 0) const {
    return read_serialized(write("m.serialized", text), index);
  }
};

TEST_F(SerializedFile, EveryFlagInBothVersionsAndPrecisions) {
  for (const int version : {3, 4})
    for (const bool is_double : {false, true})
      for (const std::uint32_t flags : {0x0u, 0x1u, 0x2u, 0x8u, 0x10u, 0x1bu}) {
        const SerializedMesh read_mesh =
            read(file(version, {mesh({version, is_double, flags, 0.5f, 4, 2, 3})}));
        const Mesh& m = read_mesh.mesh;
        ASSERT_EQ(m.positions.size(), 4u);
        EXPECT_EQ(m.positions[2], V3f(1, 1, 0.5f));
        EXPECT_EQ(m.triangles[1], V3u(0, 2, 3));
        EXPECT_EQ(read_mesh.face_normals, (flags & 0x10u) != 0);
        EXPECT_EQ(m.normals, flags & 1u ? std::vector<V3f>(4, V3f(0, 0, 1)) : std::vector<V3f>());
        EXPECT_EQ(m.uvs.size(), flags & 2u ? 4u : 0u);
        EXPECT_TRUE(m.uvs.empty() || m.uvs[2] == V2f(0.5f, 0.25f));
        EXPECT_EQ(m.attributes.size(), flags & 8u ? 1u : 0u);
        for (const MeshAttribute& attribute : m.attributes) {
          EXPECT_EQ(attribute.name, "vertex_color");
          EXPECT_EQ(attribute.values,
                    (std::vector<C3f>{C3f(1, 0, 0), C3f(0, 1, 0), C3f(0, 0, 1), C3f(1, 1, 1)}));
        }
      }
}

TEST_F(SerializedFile, ShapeIndexThroughTheTable) {
  for (const int version : {3, 4}) {
    std::vector<std::string> meshes;
    for (int k = 0; k < 3; ++k) meshes.push_back(mesh({version, k == 1, 0, static_cast<float>(k), 4, 2, 3}));
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(read(file(version, meshes), k).mesh.positions[0].z, static_cast<float>(k));
    expect_error([&] { read(file(version, meshes), 3); }, {"shape_index 3", "3 meshes"});
  }
}

TEST_F(SerializedFile, HostileFilesAreOneError) {
  const std::string good = file(4, {mesh({})});
  expect_error([&] { read(""); }, {"m.serialized", "too early"});
  expect_error([&] { read("PK\3\4 and more"); }, {"no mesh at offset 0"});
  expect_error([&] { read(prefix(5) + good.substr(4)); }, {"version 5", "3 and 4"});
  expect_error([&] { read(prefix(4) + std::string(100, 'x')); }, {"mesh at offset 0", "ends too early"});
  // Four billion vertices in a few bytes, and what overflows when multiplied.
  for (const std::uint64_t many :
       {std::uint64_t{4000000000}, std::uint64_t{1} << 33, std::uint64_t{1} << 62, ~std::uint64_t{0}}) {
    Options vertices, triangles;
    vertices.vertices = triangles.triangles = many;
    expect_error([&] { read(file(4, {mesh(vertices)})); }, {"mesh at offset 0"});
    expect_error([&] { read(file(4, {mesh(triangles)})); }, {"mesh at offset 0"});
  }
  Options index, more, infinite;
  index.last_index = 4;
  expect_error([&] { read(file(4, {mesh(index)})); }, {"triangle 1 names vertex 4", "there are 4"});
  more.vertices = 40;  // fits the bound, but not what is there
  expect_error([&] { read(file(4, {mesh(more)})); }, {"ends too early"});
  infinite.height = infinity_f;
  expect_error([&] { read(file(4, {mesh(infinite)})); }, {"vertex 0 is not finite"});
  // Tables that point anywhere.
  std::string table = good;
  put(table, std::uint64_t{0});
  put(table, std::uint32_t{0xffffffffu});
  expect_error([&] { read(table, 1); }, {"table of meshes is larger"});
  std::string outside = file(4, {mesh({}), mesh({})});
  std::memset(outside.data() + outside.size() - 12, 0x7f, 8);
  expect_error([&] { read(outside, 1); }, {"outside of the file"});
  for (std::size_t size = 0; size + 24 < good.size(); size += 3)
    EXPECT_NE(message_of([&] { read(good.substr(0, size)); }), "") << size;
}

}  // namespace
}  // namespace twopass
