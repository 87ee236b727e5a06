#include "render/load/ply_file.h"

#include <bit>
#include <cstring>

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class PlyFile : public LoadTest {
 protected:
  Mesh read(const std::string& text) const {
    Notes notes;
    return read_ply(write("mesh.ply", text), notes);
  }
  void expect_refused(const std::string& text, std::initializer_list<std::string_view> parts) const {
    expect_error([&] { read(text); }, parts);
  }
};

template <class T>
void put(std::string& to, T value, bool swapped) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (swapped) std::reverse(bytes, bytes + sizeof(T));
  to.append(bytes, sizeof(T));
}

const std::string square_header =
    "element vertex 4\nproperty float x\nproperty double y\nproperty short z\nproperty uchar red\n"
    "property uchar green\nproperty uchar blue\nelement face 2\nproperty list uchar int vertex_indices\n"
    "property float heat_x\nproperty float heat_y\nproperty float heat_z\nend_header\n";

void expect_square(const Mesh& mesh) {
  ASSERT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.positions[2], V3f(1.5f, 0.25f, -3));
  ASSERT_EQ(mesh.triangles.size(), 3u);  // a triangle and a quadrilateral
  EXPECT_EQ(mesh.triangles[0], V3u(0, 1, 2));
  EXPECT_EQ(mesh.triangles[1], V3u(0, 1, 2));
  EXPECT_EQ(mesh.triangles[2], V3u(0, 2, 3));
  ASSERT_EQ(mesh.attributes.size(), 2u);
  EXPECT_EQ(mesh.attributes[0].name, "vertex_color");
  ASSERT_EQ(mesh.attributes[0].values.size(), 4u);
  expect_near(mesh.attributes[0].values[0], V3f(1.0f, 0.2158605f, 0.0f));  // 128 of sRGB
  EXPECT_EQ(mesh.attributes[1].name, "face_heat");
  ASSERT_EQ(mesh.attributes[1].values.size(), 3u);
  EXPECT_EQ(mesh.attributes[1].values[0], C3f(1, 2, 3));
  EXPECT_EQ(mesh.attributes[1].values[1], C3f(4, 5, 6));
  EXPECT_EQ(mesh.attributes[1].values[2], C3f(4, 5, 6));
}

TEST_F(PlyFile, Ascii) {
  expect_square(read("ply\nformat ascii 1.0\ncomment made by hand\n" + square_header +
                     "0 0 -3 255 128 0\n1 0 -3 0 0 0\n1.5 2.5e-1 -3 0 0 0\n0 1 -3 9 9 9\n"
                     "3 0 1 2 1 2 3\n4 0 1 2 3 4 5 6"));
}

TEST_F(PlyFile, BinaryInBothByteOrders) {
  for (const bool big : {false, true}) {
    std::string text = std::string("ply\r\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
                       " 1.0\r\n" + square_header;
    const bool swapped = big != (std::endian::native == std::endian::big);
    const float xs[] = {0, 1, 1.5f, 0};
    const double ys[] = {0, 0, 0.25, 1};
    for (int i = 0; i < 4; ++i) {
      put(text, xs[i], swapped), put(text, ys[i], swapped), put(text, std::int16_t{-3}, swapped);
      text += i == 0 ? std::string("\xff\x80\x00", 3) : std::string(3, '\x09');
    }
    text += '\x03';
    for (const std::int32_t k : {0, 1, 2}) put(text, k, swapped);
    for (const float h : {1.0f, 2.0f, 3.0f}) put(text, h, swapped);
    text += '\x04';
    for (const std::int32_t k : {0, 1, 2, 3}) put(text, k, swapped);
    for (const float h : {4.0f, 5.0f, 6.0f}) put(text, h, swapped);
    expect_square(read(text));
  }
}

TEST_F(PlyFile, NormalsCoordinatesUnknownPropertiesAndElements) {
  const Mesh mesh = read(
      "ply\nformat ascii 1.0\nobj_info x\nelement camera 1\nproperty float view_x\nproperty list uchar float "
      "mess\n"
      "element face 2\nproperty list uchar uint other\nproperty list int uint vertex_index\n"
      "element vertex 3\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float z\n"
      "property float y\nproperty float x\nproperty float s\nproperty float t\nproperty float quality\n"
      "property list uchar float weights\nelement edge 1\nproperty int vertex1\nend_header\n"
      "7 2 1 2\n1 9 3 0 1 2\n0 2 0 1\n"
      "0 0 2 7 0 0 0.1 0.2 5 0\n0 0 1 7 0 1 0.3 0.4 6 2 1 1\n0 0 1 7 1 0 0.5 0.6 7 1 3\n3\n");
  EXPECT_EQ(mesh.positions[1], V3f(1, 0, 7));
  EXPECT_EQ(mesh.normals[0], V3f(0, 0, 1));
  EXPECT_EQ(mesh.uvs[2], V2f(0.5f, 0.6f));
  ASSERT_EQ(mesh.triangles.size(), 1u);  // the line is left out
  EXPECT_EQ(mesh.triangles[0], V3u(0, 1, 2));
  ASSERT_EQ(mesh.attributes.size(), 1u);
  EXPECT_EQ(mesh.attributes[0].name, "vertex_quality");
  EXPECT_EQ(mesh.attributes[0].values[2], C3f(7.0f));
}

// Names by Mitsuba's rules: runs of xyz, rgb, 012 or 123.
TEST_F(PlyFile, AttributesByTheirEndings) {
  const Mesh mesh = read(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float a_x\nproperty float a_y\nproperty float a_z\nproperty float tint_r\nproperty float "
      "tint_g\n"
      "property float tint_b\nproperty float k_1\nproperty float k_2\nproperty float k_3\nproperty float "
      "lone_x\n"
      "element face 1\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nend_header\n"
      "0 0 0 1 2 3 4 5 6 7 8 9 10\n1 0 0 1 2 3 4 5 6 7 8 9 10\n0 1 0 1 2 3 4 5 6 7 8 9 10\n3 0 1 2 255 0 0\n");
  std::vector<std::string> names;
  for (const MeshAttribute& attribute : mesh.attributes) names.push_back(attribute.name);
  EXPECT_EQ(names, (std::vector<std::string>{"vertex_a", "vertex_tint_color", "vertex_k", "vertex_lone_x",
                                             "face_color"}));
  EXPECT_EQ(mesh.attributes[2].values[0], C3f(7, 8, 9));
  EXPECT_EQ(mesh.attributes[4].values[0], C3f(1, 0, 0));
}

const std::string triangle_header =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST_F(PlyFile, ErrorsNameTheLineOrTheOffset) {
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n";
  expect_refused("plx\n", {"mesh.ply:1: this is no PLY file"});
  expect_refused("", {"mesh.ply:1"});
  expect_refused("ply\nformat ascii 1.0\n", {"mesh.ply:3: the header does not end"});
  expect_refused("ply\nformat ascii 2.0\nend_header\n", {"mesh.ply:2", "supported: format ... 1.0"});
  expect_refused("ply\nformat text 1.0\nend_header\n", {"mesh.ply:2", "'text'", "binary_little_endian"});
  expect_refused("ply\nformat ascii 1.0\nelement vertex -1\nend_header\n", {"mesh.ply:3"});
  expect_refused("ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n",
                 {"mesh.ply:4", "'quad'", "float32"});
  expect_refused("ply\nformat ascii 1.0\nproperty float x\nend_header\n", {"mesh.ply:3"});
  expect_refused(
      "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n",
      {"no faces", "cloud of points"});
  expect_refused(triangle_header + vertices + "3 0 1 3\n", {"mesh.ply:13", "vertex 3", "there are 3"});
  expect_refused(triangle_header + vertices + "3 0 1 28888888888888888888888\n",
                 {"mesh.ply:13", "vertex 2.888888889e+22", "there are 3"});
  expect_refused(triangle_header + vertices + "3 0 1 -1\n", {"mesh.ply:13", "vertex -1"});
  expect_refused(triangle_header + vertices + "3 0 1 1.5\n", {"mesh.ply:13", "no integer"});
  expect_refused(triangle_header + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", {"mesh.ply:11", "'y' is not finite"});
  expect_refused(triangle_header + "0 0 0\n1 1e60 0\n0 1 0\n3 0 1 2\n", {"mesh.ply:11", "'y' is not finite"});
  expect_refused(triangle_header + "0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n", {"mesh.ply:11", "'zero'"});
  expect_refused(triangle_header + "0 0 0\n1 0,5 0\n0 1 0\n3 0 1 2\n", {"mesh.ply:11", "'0,5'"});
  expect_refused(triangle_header + vertices + "3 0 1", {"mesh.ply:13", "cut off"});
  expect_refused(triangle_header + vertices + "200 0 1 2\n", {"mesh.ply:13", "a list cannot have this length"});
  std::string binary = triangle_header;
  binary.replace(binary.find("ascii"), 5, "binary_little_endian");
  expect_refused(binary + std::string(36, '\0') + "\x03" + std::string("\0\0\0\0\1\0\0\0\7\0\0\0", 12),
                 {": offset ", "vertex 7"});
  expect_refused(binary + std::string(36, '\0') + "\x03" + std::string(5, '\0'), {": offset "});
}

// A header may promise anything: memory follows what the file holds.
TEST_F(PlyFile, AbsurdHeadersTakeNoMemory) {
  for (const std::string count : {"4000000000", "9000000000000000000", "99999999999999999999999"})
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      std::string text = triangle_header;
      text.replace(text.find("ascii"), 5, format);
      std::string faces = text;
      text.replace(text.find("vertex 3"), 8, "vertex " + count);
      faces.replace(faces.find("face 1"), 6, "face " + count);
      expect_refused(text + "0 0 0\n", {"mesh.ply"});
      expect_refused(faces + "0 0 0\n1 0 0\n0 1 0\n0 0 0 0 0 0 0 0 0 0\n", {"mesh.ply"});
    }
  // Elements of nothing, as many as one likes.
  EXPECT_EQ(read("ply\nformat ascii 1.0\nelement void 9000000000000000000\n" +
                 triangle_header.substr(triangle_header.find("element")) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
                .triangles.size(),
            1u);
}

// Every way of cutting a file off is one error, and never more than one.
TEST_F(PlyFile, TruncatedAnywhere) {
  const std::string whole = triangle_header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2";
  EXPECT_EQ(read(whole).triangles.size(), 1u);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(message_of([&] { read(whole.substr(0, size)); }), "") << size;
}

TEST_F(PlyFile, ZeroBytesInTheHeaderAreRefused) {
  using namespace std::string_literals;
  const auto path = write("mesh.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty uch\0ar x\n"s);
  expect_error(
      [&] {
        Notes notes;
        read_ply(path, notes);
      },
      {"mesh.ply:4", "a zero byte in the header; the file is damaged"});
}

}  // namespace
}  // namespace twopass
