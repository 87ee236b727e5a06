#include "render/load/ply_file.h"

#include <bit>
#include <charconv>
#include <cstdio>
#include <cstring>

#include "render/core/error.h"
#include "render/load/ply_attributes.h"
#include "render/load/ply_header.h"
#include "render/load/text_file.h"
#include "render/load/triangulate.h"

namespace twopass {
namespace {

/// Where the data is read, and what to say when it is wrong.
class Cursor {
 public:
  Cursor(std::string_view text, const PlyHeader& header, std::string file)
      : begin_(text.data()),
        at_(text.data() + header.size),
        end_(text.data() + text.size()),
        line_(header.lines + 1),
        file_(std::move(file)) {}

  [[nodiscard]] std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  [[noreturn]] void fail_at_line(const std::string& what, const std::string& hint) const {
    throw Error(file_ + ":" + std::to_string(line_), what, hint);
  }
  [[noreturn]] void fail_at_byte(const std::string& what, const std::string& hint) const {
    throw Error(file_ + ": offset " + std::to_string(at_ - begin_), what, hint);
  }

 protected:
  const char *begin_, *at_, *end_;
  std::size_t line_;
  std::string file_;
};

/// Numbers as text.
class AsciiCursor : public Cursor {
 public:
  using Cursor::Cursor;
  static std::size_t least_size(PlyType) { return 2; }  // a digit, and what separates it
  [[noreturn]] void fail(const std::string& what, const std::string& hint) const { fail_at_line(what, hint); }

  double number(PlyType type) {
    while (at_ < end_ && (*at_ == ' ' || *at_ == '\n' || *at_ == '\r' || *at_ == '\t')) line_ += *at_++ == '\n';
    if (at_ < end_ && *at_ == '+') ++at_;
    double value = 0.0;
    const auto [after, code] = std::from_chars(at_, end_, value);
    if (at_ == end_) fail("the file ends too early", "it is cut off, or its header promises too much");
    const bool is_whole = after == end_ || *after == ' ' || *after == '\n' || *after == '\r' || *after == '\t';
    // 1e-320 is a number, too: out of range means that the result is unchanged.
    if ((code != std::errc() && code != std::errc::result_out_of_range) || !is_whole)
      fail("this is no number: " + in_quotes(word()), "correct it");
    if (is_integer(type) && value != std::trunc(value))
      fail("this is no integer: " + in_quotes(word()), "correct it");
    at_ = after;
    return value;
  }

 private:
  [[nodiscard]] std::string word() const {
    const char* after = at_;
    while (after < end_ && after - at_ < 40 && static_cast<unsigned char>(*after) > ' ') ++after;
    return std::string(at_, after);
  }
};

/// Numbers as bytes.
template <std::endian order>
class BinaryCursor : public Cursor {
 public:
  using Cursor::Cursor;
  static std::size_t least_size(PlyType type) { return size_of(type); }
  [[noreturn]] void fail(const std::string& what, const std::string& hint) const { fail_at_byte(what, hint); }

  double number(PlyType type) {
    if (left() < size_of(type))
      fail("the file ends too early", "it is cut off, or its header promises too much");
    switch (type) {
      case PlyType::int8:
        return take<std::int8_t>();
      case PlyType::uint8:
        return take<std::uint8_t>();
      case PlyType::int16:
        return take<std::int16_t>();
      case PlyType::uint16:
        return take<std::uint16_t>();
      case PlyType::int32:
        return take<std::int32_t>();
      case PlyType::uint32:
        return take<std::uint32_t>();
      case PlyType::float32:
        return double{take<float>()};
      case PlyType::float64:
        break;
    }
    return take<double>();
  }

 private:
  template <class T>
  T take() {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), at_, sizeof(T));
    if constexpr (order != std::endian::native) std::ranges::reverse(bytes);
    at_ += sizeof(T);
    return std::bit_cast<T>(bytes);
  }
};

const std::vector<std::string_view> vertex_names{"x", "y", "z", "nx", "ny",        "nz",
                                                 "u", "v", "s", "t",  "texture_u", "texture_v"};

/// Reads the elements of one file into a mesh.
template <class Numbers>
class PlyReader {
 public:
  PlyReader(Numbers numbers, const PlyHeader& header, Notes& notes, const std::string& file)
      : numbers_(std::move(numbers)), header_(header), notes_(notes), file_(file) {}

  Mesh run() {
    const PlyElement* vertices = first_called("vertex");
    const PlyElement* faces = first_called("face");
    if (!vertices) throw Error(file_, "the file has no vertices", "give a mesh");
    if (!faces) throw Error(file_, "the file has no faces", "a cloud of points cannot be rendered");
    vertices_ = vertices->count;
    if (vertices_ > no_vertex)
      throw Error(file_, std::to_string(vertices_) + " vertices are more than can be numbered",
                  "divide the mesh");
    for (const PlyElement& element : header_.elements) {
      check_size(element);
      if (&element == vertices)
        read_vertices(element);
      else if (&element == faces)
        read_faces(element);
      else
        skip(element);
    }
    if (left_out_ > 0)
      notes_.add(file_ + ": " + std::to_string(left_out_) +
                 " faces with fewer than three corners are left out");
    cut_polygons();
    return std::move(mesh_);
  }

 private:
  static constexpr std::size_t no_vertex = 0xffffffffu;

  [[nodiscard]] const PlyElement* first_called(std::string_view name) const {
    for (const PlyElement& element : header_.elements)
      if (element.name == name) return &element;
    return nullptr;
  }

  /// What the header promises must fit into what is left of the file: so memory is bounded.
  void check_size(const PlyElement& element) const {
    std::size_t row = 0;
    for (const PlyProperty& p : element.properties)
      row += numbers_.least_size(p.is_list ? p.count_type : p.type);
    // The last number of a text needs no separator.
    if (row > 0 && element.count > (numbers_.left() + 1) / row)
      numbers_.fail(std::to_string(element.count) + " elements " + in_quotes(element.name) +
                        " do not fit into the rest of the file",
                    "it is cut off, or its header is wrong");
    if (row == 0 && element.count > 0 && (element.name == "vertex" || element.name == "face"))
      throw Error(file_, "element " + in_quotes(element.name) + " has no properties", "correct the header");
  }

  std::size_t read_count(const PlyProperty& list) {
    const double count = numbers_.number(list.count_type);
    if (count < 0.0 || count * static_cast<double>(numbers_.least_size(list.type)) >
                           static_cast<double>(numbers_.left()) + 1.0)
      numbers_.fail("a list cannot have this length", "the file is cut off or damaged");
    return static_cast<std::size_t>(count);
  }

  void skip(const PlyElement& element) {
    if (element.properties.empty()) return;
    for (std::size_t i = 0; i < element.count; ++i)
      for (const PlyProperty& p : element.properties) {
        const std::size_t count = p.is_list ? read_count(p) : 1;
        for (std::size_t k = 0; k < count; ++k) numbers_.number(p.type);
      }
  }

  /// One row of numbers; the items of lists go to `list`, if it is the one that is wanted, or nowhere.
  void read_row(const PlyElement& element, std::size_t wanted_list) {
    row_.resize(element.properties.size());
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const PlyProperty& p = element.properties[k];
      if (!p.is_list) {
        row_[k] = numbers_.number(p.type);
        if (!std::isfinite(static_cast<float>(row_[k])))
          numbers_.fail("property " + in_quotes(p.name) + " is not finite", "correct the mesh");
        continue;
      }
      const std::size_t count = read_count(p);
      if (k == wanted_list) list_.clear();
      for (std::size_t i = 0; i < count; ++i) {
        const double item = numbers_.number(p.type);
        if (k == wanted_list) list_.push_back(item);
      }
    }
  }

  void read_vertices(const PlyElement& element) {
    const auto all = [&](std::initializer_list<const char*> names) {
      for (const char* name : names)
        if (!element.has(name) || element.properties[element.find(name)].is_list) return false;
      return true;
    };
    if (!all({"x", "y", "z"})) throw Error(file_, "its vertices have no x, y, z", "correct the header");
    const std::size_t x = element.find("x"), y = element.find("y"), z = element.find("z");
    const bool has_normals = all({"nx", "ny", "nz"});
    const std::size_t nx = element.find("nx"), ny = element.find("ny"), nz = element.find("nz");
    std::size_t u = element.properties.size(), v = u;
    for (const auto& [name_u, name_v] : {std::pair{"s", "t"}, {"texture_u", "texture_v"}, {"u", "v"}})
      if (all({name_u, name_v})) u = element.find(name_u), v = element.find(name_v);
    const std::size_t first_attribute = mesh_.attributes.size();
    const auto attributes = begin_attributes(element, "vertex_", vertex_names);

    mesh_.positions.reserve(element.count);
    if (has_normals) mesh_.normals.reserve(element.count);
    if (u < element.properties.size()) mesh_.uvs.reserve(element.count);
    const auto number = [&](std::size_t k) { return static_cast<float>(row_[k]); };
    for (std::size_t i = 0; i < element.count; ++i) {
      read_row(element, element.properties.size());
      mesh_.positions.emplace_back(number(x), number(y), number(z));
      if (has_normals) mesh_.normals.push_back(unit(V3f(number(nx), number(ny), number(nz))));
      if (u < element.properties.size()) mesh_.uvs.emplace_back(number(u), number(v));
      add_attributes(element, attributes, first_attribute);
    }
  }

  void read_faces(const PlyElement& element) {
    std::size_t list = element.find("vertex_indices");
    if (list == element.properties.size()) list = element.find("vertex_index");
    if (list == element.properties.size() || !element.properties[list].is_list)
      throw Error(file_, "its faces have no list vertex_indices (or vertex_index)", "correct the header");
    const std::size_t first_attribute = mesh_.attributes.size();
    const auto attributes = begin_attributes(element, "face_", {});
    mesh_.triangles.reserve(element.count);
    for (std::size_t i = 0; i < element.count; ++i) {
      read_row(element, list);
      for (const double index : list_)
        if (!(index >= 0.0 && index < static_cast<double>(vertices_))) {
          char text[40];  // it may be any double
          std::snprintf(text, sizeof text, "%.10g", index);
          numbers_.fail(
              std::string("a face names vertex ") + text + ", and there are " + std::to_string(vertices_),
              "vertices are numbered from 0");
        }
      const auto corner = [&](std::size_t k) { return static_cast<std::uint32_t>(list_[k]); };
      if (list_.size() == 3) {
        mesh_.triangles.emplace_back(corner(0), corner(1), corner(2));
        add_attributes(element, attributes, first_attribute);
      } else if (list_.size() > 3) {
        polygons_.push_back({mesh_.triangles.size(), {list_.begin(), list_.end()}});
        // Cut when all vertices are known, which may come later.
        for (std::size_t k = 2; k < list_.size(); ++k) {
          mesh_.triangles.emplace_back(0, 0, 0);
          add_attributes(element, attributes, first_attribute);
        }
      } else {
        ++left_out_;
      }
    }
  }

  void cut_polygons() {
    std::vector<V3f> corners;
    for (const PlyPolygon& polygon : polygons_) {
      corners.clear();
      for (const std::uint32_t index : polygon.corners) corners.push_back(mesh_.positions[index]);
      std::size_t next = polygon.first_triangle;
      for (const std::array<std::uint32_t, 3>& t : triangulate(corners))
        mesh_.triangles[next++] = V3u(polygon.corners[t[0]], polygon.corners[t[1]], polygon.corners[t[2]]);
    }
  }

  std::vector<PlyAttribute> begin_attributes(const PlyElement& element, const std::string& prefix,
                                             const std::vector<std::string_view>& reserved) {
    std::vector<PlyAttribute> attributes = ply_attributes(element, prefix, reserved);
    for (const PlyAttribute& attribute : attributes) {
      mesh_.attributes.push_back({attribute.name, {}});
      mesh_.attributes.back().values.reserve(element.count);
    }
    return attributes;
  }

  void add_attributes(const PlyElement& element, const std::vector<PlyAttribute>& attributes,
                      std::size_t first) {
    for (std::size_t a = 0; a < attributes.size(); ++a) {
      C3f value;
      for (int c = 0; c < 3; ++c) {
        const std::size_t k = attributes[a].property[static_cast<std::size_t>(c)];
        value[c] = ply_attribute_value(row_[k], element.properties[k].type);
      }
      mesh_.attributes[first + a].values.push_back(value);
    }
  }

  /// A face of more than three corners.
  struct PlyPolygon {
    std::size_t first_triangle;  // its triangles follow each other
    std::vector<std::uint32_t> corners;
  };

  Numbers numbers_;
  const PlyHeader& header_;
  Notes& notes_;
  const std::string& file_;
  Mesh mesh_;
  std::size_t vertices_ = 0, left_out_ = 0;
  std::vector<double> row_, list_;
  std::vector<PlyPolygon> polygons_;
};

}  // namespace

Mesh read_ply(const std::filesystem::path& path, Notes& notes) {
  const std::string text = read_text_file(path), file = path.string();
  const PlyHeader header = read_ply_header(text, file);
  switch (header.format) {
    case PlyFormat::ascii:
      return PlyReader(AsciiCursor(text, header, file), header, notes, file).run();
    case PlyFormat::big_endian:
      return PlyReader(BinaryCursor<std::endian::big>(text, header, file), header, notes, file).run();
    case PlyFormat::little_endian:
      break;
  }
  return PlyReader(BinaryCursor<std::endian::little>(text, header, file), header, notes, file).run();
}

}  // namespace twopass
