#include "render/load/serialized_file.h"

#include <bit>
#include <cstring>

#include "render/core/deflate.h"
#include "render/core/error.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

constexpr std::uint16_t magic = 0x041c;
enum Flag : std::uint32_t {
  normals = 0x1,
  texture_coordinates = 0x2,
  colors = 0x8,
  flat = 0x10,
  double_precision = 0x2000
};
constexpr const char* damaged = "the file is cut off or damaged";

/// Numbers of the file that are not compressed.
class File {
 public:
  File(const std::filesystem::path& path) : name_(path.string()), bytes_(read_text_file(path)) {}

  template <class T>
  [[nodiscard]] T number(std::size_t offset) const {
    if (bytes_.size() < sizeof(T) || offset > bytes_.size() - sizeof(T))
      throw Error(name_, "the file ends too early", damaged);
    T value;
    std::memcpy(&value, bytes_.data() + offset, sizeof(T));
    return value;
  }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] std::span<const std::byte> from(std::size_t offset) const {
    return std::as_bytes(std::span(bytes_)).subspan(offset);
  }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_, bytes_;
};

void check_magic(const File& file, std::size_t offset) {
  if (file.number<std::uint16_t>(offset) != magic)
    throw Error(file.name(), "there is no mesh at offset " + std::to_string(offset),
                "a .serialized file of Mitsuba has one there");
}

/// Where a mesh starts: the table at the end of the file says it; the first one is at the beginning.
std::size_t offset_of(const File& file, std::uint16_t version, std::size_t index) {
  if (index == 0) return 0;
  const std::size_t entry = version == 3 ? sizeof(std::uint32_t) : sizeof(std::uint64_t);
  const auto count = file.size() < 4 ? 0 : file.number<std::uint32_t>(file.size() - 4);
  if (index >= count)
    throw Error(file.name(), "there is no shape_index " + std::to_string(index),
                "the file has " + std::to_string(count) + " meshes, numbered from 0");
  const std::size_t from_end = 4 + entry * (count - index);
  if (from_end > file.size()) throw Error(file.name(), "its table of meshes is larger than the file", damaged);
  const std::size_t at = file.size() - from_end;
  const std::uint64_t offset = version == 3 ? file.number<std::uint32_t>(at) : file.number<std::uint64_t>(at);
  if (offset > file.size() || file.size() - offset < 4)
    throw Error(file.name(), "its table of meshes points outside of the file", damaged);
  return static_cast<std::size_t>(offset);
}

/// One mesh's stream.
class MeshReader {
 public:
  MeshReader(const File& file, std::size_t offset, std::uint16_t version)
      : where_(file.name() + ": mesh at offset " + std::to_string(offset)),
        version_(version),
        compressed_(file.from(offset + 4)),
        stream_(compressed_) {}

  SerializedMesh run() {
    const auto flags = take<std::uint32_t>();
    is_double_ = (flags & double_precision) != 0;
    if (version_ >= 4) skip_name();
    const auto vertices = take<std::uint64_t>(), triangles = take<std::uint64_t>();
    check_counts(flags, vertices, triangles);

    SerializedMesh result;
    result.face_normals = (flags & flat) != 0;
    Mesh& mesh = result.mesh;
    read_floats(vertices, mesh.positions);
    if (flags & normals) {
      read_floats(vertices, mesh.normals);
      for (V3f& n : mesh.normals) n = unit(n);
    }
    if (flags & texture_coordinates) read_floats(vertices, mesh.uvs);
    if (flags & colors)
      read_floats(vertices, mesh.attributes.emplace_back(MeshAttribute{"vertex_color", {}}).values);
    read_triangles(triangles, static_cast<std::uint32_t>(vertices), mesh.triangles);
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& what, const char* hint = damaged) const {
    throw Error(where_, what, hint);
  }
  void read(std::span<std::byte> to) {
    if (!stream_.read(to)) fail("its data ends too early");
  }
  template <class T>
  T take() {
    T value;
    read(std::as_writable_bytes(std::span(&value, 1)));
    return value;
  }
  void skip_name() {
    constexpr int longest = 1 << 16;
    for (int i = 0; i < longest; ++i)
      if (take<char>() == 0) return;
    fail("its name does not end");
  }

  /// What is promised must be able to come out of what there is.
  void check_counts(std::uint32_t flags, std::uint64_t vertices, std::uint64_t triangles) const {
    if (vertices > 0xffffffffu || triangles > 0xffffffffu)
      fail("more than 4294967295 vertices or triangles", "divide the mesh, or the file is damaged");
    const std::uint64_t floats =
        3 + (flags & normals ? 3 : 0) + (flags & texture_coordinates ? 2 : 0) + (flags & colors ? 3 : 0);
    const std::uint64_t bytes = vertices * floats * (is_double_ ? 8 : 4) + triangles * 12;
    if (bytes / Inflater::largest_ratio > compressed_.size())
      fail(std::to_string(vertices) + " vertices and " + std::to_string(triangles) +
           " triangles do not fit into the file");
  }

  /// Arrays grow as their data comes in, so that a promise alone takes no memory.
  template <class V>
  void read_floats(std::uint64_t count, std::vector<V>& to) {
    constexpr std::size_t piece = 1 << 16, channels = V::dimensions();
    std::vector<double> doubles(is_double_ ? piece * channels : 0);
    std::vector<float> floats(piece * channels);
    while (to.size() < count) {
      const std::size_t some = std::min<std::size_t>(piece, count - to.size());
      if (is_double_) {
        read(std::as_writable_bytes(std::span(doubles).first(some * channels)));
        for (std::size_t i = 0; i < some * channels; ++i) floats[i] = static_cast<float>(doubles[i]);
      } else {
        read(std::as_writable_bytes(std::span(floats).first(some * channels)));
      }
      for (std::size_t i = 0; i < some; ++i) {
        V value;
        for (std::size_t c = 0; c < channels; ++c) {
          const float x = floats[i * channels + c];
          if (!std::isfinite(x)) fail("a number of vertex " + std::to_string(to.size()) + " is not finite");
          value[static_cast<int>(c)] = x;
        }
        to.push_back(value);
      }
    }
  }

  void read_triangles(std::uint64_t count, std::uint32_t vertices, std::vector<V3u>& to) {
    constexpr std::size_t piece = 1 << 16;
    std::vector<V3u> some(piece);
    while (to.size() < count) {
      const auto part = std::span(some).first(std::min<std::size_t>(piece, count - to.size()));
      read(std::as_writable_bytes(part));
      for (const V3u& t : part) {
        if (std::max({t.x, t.y, t.z}) >= vertices)
          fail("triangle " + std::to_string(to.size()) + " names vertex " +
               std::to_string(std::max({t.x, t.y, t.z})) + ", and there are " + std::to_string(vertices));
        to.push_back(t);
      }
    }
  }

  std::string where_;
  std::uint16_t version_;
  std::span<const std::byte> compressed_;
  Inflater stream_;
  bool is_double_ = false;
};

}  // namespace

SerializedMesh read_serialized(const std::filesystem::path& path, int index) {
  const File file(path);
  check_magic(file, 0);
  const auto version = file.number<std::uint16_t>(2);
  if (version != 3 && version != 4)
    throw Error(file.name(), "version " + std::to_string(version) + " of the format is not supported",
                "supported: 3 and 4");
  const std::size_t offset = offset_of(file, version, static_cast<std::size_t>(index));
  check_magic(file, offset);
  return MeshReader(file, offset, version).run();
}

}  // namespace twopass
