// Our OBJ parser against tinyobjloader, on files that both read: the same numbers, indices and faces.
#include <random>
#include <sstream>

#include <tiny_obj_loader.h>

#include "render/load/obj_file.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

/// A well-formed file of random statements, without what tinyobjloader cannot read.
std::string random_obj(std::mt19937& random) {
  const auto below = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  const auto number = [&]() -> std::string {
    std::ostringstream out;
    out.precision(1 + below(12));
    if (below(3) == 0) out << std::scientific;
    out << std::uniform_real_distribution<double>(-1.0, 1.0)(random) * std::pow(10.0, below(7) - 3);
    return out.str();
  };
  const auto blanks = [&] { return std::string(1 + below(3), below(4) == 0 ? '\t' : ' '); };
  const char* line_end = below(2) == 0 ? "\n" : "\r\n";
  std::string text;
  int positions = 0, uvs = 0, normals = 0;
  for (int i = 0; i < 200; ++i) {
    const int kind = positions < 4 ? 0 : below(6);
    if (kind == 0) {
      text += std::string("v") + blanks() + number() + blanks() + number() + blanks() + number();
      ++positions;
    } else if (kind == 1) {
      text += std::string("vt") + blanks() + number() + blanks() + number();
      ++uvs;
    } else if (kind == 2) {
      text += std::string("vn") + blanks() + number() + blanks() + number() + blanks() + number();
      ++normals;
    } else {
      const bool with_uv = uvs > 0 && below(2) == 0, with_normal = normals > 0 && below(2) == 0;
      const bool backwards = below(3) == 0;
      const auto index = [&](int count) {
        return std::to_string(backwards ? -1 - below(count) : 1 + below(count));
      };
      text += "f";
      for (int corner = 3 + below(3); corner > 0; --corner) {
        text += blanks() + index(positions);
        if (with_uv || with_normal) text += "/";
        if (with_uv) text += index(uvs);
        if (with_normal) text += std::string("/") + index(normals);
      }
    }
    text += line_end;
  }
  return text + "f 1 2 3\n";
}

TEST(ObjPeer, ReadsWhatTinyobjloaderReads) {
  std::mt19937 random(7);
  for (int repeat = 0; repeat < 50; ++repeat) {
    const std::string text = random_obj(random);
    tinyobj::ObjReaderConfig config;
    config.triangulate = false;
    tinyobj::ObjReader peer;
    ASSERT_TRUE(peer.ParseFromString(text, "", config)) << peer.Error();
    Notes notes;
    const ObjFile file = parse_obj(text, "a.obj", notes);

    const tinyobj::attrib_t& attributes = peer.GetAttrib();
    ASSERT_EQ(3 * file.positions.size(), attributes.vertices.size());
    ASSERT_EQ(2 * file.uvs.size(), attributes.texcoords.size());
    ASSERT_EQ(3 * file.normals.size(), attributes.normals.size());
    // Its numbers are put together from digits in double: right to a unit in the last place.
    for (std::size_t i = 0; i < attributes.vertices.size(); ++i)
      ASSERT_FLOAT_EQ(file.positions[i / 3][static_cast<int>(i % 3)], attributes.vertices[i]);
    for (std::size_t i = 0; i < attributes.texcoords.size(); ++i)
      ASSERT_FLOAT_EQ(file.uvs[i / 2][static_cast<int>(i % 2)], attributes.texcoords[i]);
    for (std::size_t i = 0; i < file.normals.size(); ++i) {
      const float* n = &attributes.normals[3 * i];
      expect_near(file.normals[i], V3f(V3d(n[0], n[1], n[2]).normalized()));
    }

    std::size_t face = 0, corner = 0;
    const auto same = [](std::uint32_t ours, int theirs) {
      return theirs < 0 ? ours == no_obj_index : ours == static_cast<std::uint32_t>(theirs);
    };
    for (const tinyobj::shape_t& shape : peer.GetShapes()) {
      for (const unsigned count : shape.mesh.num_face_vertices) {
        ASSERT_LT(face, file.faces.size());
        ASSERT_EQ(file.faces[face++].corner_count, count);
      }
      for (const tinyobj::index_t& index : shape.mesh.indices) {
        const ObjCorner& ours = file.corners[corner++];
        ASSERT_TRUE(same(ours.position, index.vertex_index) && same(ours.uv, index.texcoord_index) &&
                    same(ours.normal, index.normal_index));
      }
    }
    ASSERT_EQ(face, file.faces.size());
    ASSERT_EQ(corner, file.corners.size());
  }
}

}  // namespace
}  // namespace twopass
