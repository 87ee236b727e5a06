#include "radiosity/display_mesh.h"

#include "radiosity/smoothing.h"
#include "render/core/interrupt.h"

namespace twopass {

namespace {

constexpr double percentile = 0.99, percentile_color = 0.8;
constexpr float specular_grey = 0.18f;
// Of each edge of a piece, on analytic surfaces without elements.
constexpr std::uint16_t analytic_divisions = 8;

bool emits(const Shape& shape, Side side) { return !is_black(shape.radiance[side]); }

// Whether a side without elements is to be seen.
bool is_shown(const Scene& scene, const ElementMesh& mesh, std::uint32_t shape, Side side) {
  const Shape& s = scene.shapes()[shape];
  if (emits(s, side) || scene.description().materials[s.material].side[side].scatters_without_diffusing())
    return true;
  return side == front && !mesh.has_elements(shape, back) && !emits(s, back);
}

// The elements' mesh with whole triangles on the other sides that are shown.
class CompleteMesh {
 public:
  CompleteMesh(const Scene& scene, const ElementMesh& elements) {
    const ElementMesh::Saved saved = elements.save();
    ElementMesh::Saved all;
    std::size_t next_root = 0, next_surface = 0, next_cluster = 0, next_element = 0;
    const std::size_t cells = elements.count() - elements.cluster_count();
    for (std::uint32_t surface = 0; surface < 2 * scene.shapes().size(); ++surface) {
      const auto shape = surface >> 1;
      const Side side = surface & 1u ? back : front;
      const bool has_elements = next_surface < saved.surface.size() && saved.surface[next_surface] == surface;
      if (!has_elements && !is_shown(scene, elements, shape, side)) continue;
      all.surface.push_back(surface);
      const Geometry& geometry = scene.shapes()[shape].geometry;
      const std::size_t primitives = piece_count(geometry);
      if (!has_elements) {
        const std::uint16_t divisions = is_analytic(geometry) ? analytic_divisions : 1;
        all.divisions.insert(all.divisions.end(), primitives, divisions);
        original_root_.insert(original_root_.end(), primitives, no_index);
        const std::size_t added = primitives * divisions * divisions;
        all.area.insert(all.area.end(), added, 0.0f);
        if (!saved.level.empty()) all.level.insert(all.level.end(), added, 0);
        continue;
      }
      ++next_surface;
      for (std::size_t k = 0; k < primitives; ++k, ++next_root) {
        all.divisions.push_back(saved.divisions[next_root]);
        original_root_.push_back(static_cast<std::uint32_t>(next_root));
        if (saved.divisions[next_root] == 0) all.cluster.push_back(saved.cluster[next_cluster++]);
        const ElementRoot* root = &elements.roots()[next_root];
        for (; next_element < cells && &elements.root(static_cast<std::uint32_t>(next_element)) == root;
             ++next_element) {
          all.area.push_back(0.0f);
          if (!saved.level.empty()) all.level.push_back(saved.level[next_element]);
        }
      }
    }
    all.area.insert(all.area.end(), elements.cluster_count(), 0.0f);
    mesh_ = ElementMesh::restore(scene.shapes(), scene.description().materials, all).value();
  }
  [[nodiscard]] const ElementMesh& mesh() const { return mesh_; }
  /// The root of the elements' mesh; no_index: it has none.
  [[nodiscard]] std::uint32_t original_root(std::uint32_t root) const { return original_root_[root]; }

 private:
  ElementMesh mesh_;
  std::vector<std::uint32_t> original_root_;  // by root
};

double exposure_of(const Scene& scene, const Solution& solution) {
  const ElementMesh& mesh = solution.mesh();
  std::vector<std::pair<double, double>> by_radiance;  // and area
  double area = 0.0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    const C3f reflected = mesh.reflectance(i) * solution.irradiances()[i].total();
    by_radiance.emplace_back(static_cast<double>(max_component(reflected)) / pi, mesh.area(i));
    area += mesh.area(i);
  }
  std::sort(by_radiance.begin(), by_radiance.end());
  double white = 0.0, below = 0.0;
  for (const auto& [radiance, part] : by_radiance) {
    white = radiance;
    if ((below += part) >= percentile * area) break;
  }
  if (!(white > 0.0))  // only lamps are to be seen
    for (const Shape& shape : scene.shapes())
      for (const C3f& radiance : shape.radiance)
        white = std::max(white, static_cast<double>(max_component(radiance)));
  const double exposure = percentile_color / white;
  return std::isfinite(exposure) ? exposure : 1.0;
}

// Writes the faces of one side after the other.
class DisplayMeshBuilder {
 public:
  DisplayMeshBuilder(const Scene& scene, const Solution& solution, const ColorMatrix& to_rec709)
      : scene_(scene),
        solution_(solution),
        to_rec709_(to_rec709),
        complete_(scene, solution.mesh()),
        vertices_(complete_.mesh()),
        element_vertices_(solution.mesh()),
        irradiance_(vertex_irradiance(element_vertices_, solution.mesh(), solution.irradiances())),
        index_(vertices_.count(), no_index) {
    result_.exposure = exposure_of(scene, solution);
  }

  DisplayMesh build() && {
    const ElementMesh& mesh = complete_.mesh();
    const auto cells = static_cast<std::uint32_t>(vertices_.faces().cells);
    for (std::uint32_t r = 0; r < mesh.roots().size(); ++r) {
      const ElementRoot& root = mesh.roots()[r];
      if (result_.sides.empty() || result_.sides.back().shape != root.shape ||
          result_.sides.back().side != root.side)
        begin_side(root);
      const std::uint32_t original = complete_.original_root(r);
      if (root.divisions == 0) {
        add_face(r, vertices_.faces().of_root[r], element_vertices_.faces().of_root[original]);
        continue;
      }
      std::uint32_t original_face = original == no_index ? 0 : solution_.mesh().roots()[original].first_element;
      for (std::uint32_t face = root.first_element; face < cells && &mesh.root(face) == &root; ++face)
        add_face(r, face, original == no_index ? no_index : original_face++);
    }
    const WorldFrame& frame = scene_.description().frame;
    for (DisplaySide& side : result_.sides)
      for (V3f& p : side.position) p = frame.to_world(p);
    return std::move(result_);
  }

 private:
  void begin_side(const ElementRoot& root) {
    throw_if_interrupted();
    for (const std::uint32_t vertex : used_) index_[vertex] = no_index;
    used_.clear();
    result_.sides.push_back({root.shape, root.side, {}, {}, {}});
    const Shape& shape = scene_.shapes()[root.shape];
    const MaterialSide& material = scene_.description().materials[shape.material].side[root.side];
    reflectance_ = material.traits().mean_diffuse_reflectance;
    emitted_ = C3d(shape.radiance[root.side]);
    if (material.scatters_without_diffusing() && is_black(shape.radiance[root.side]))
      emitted_ = C3d(specular_grey) / result_.exposure;
  }

  [[nodiscard]] C3f color(const C3d& irradiance) const {
    C3d color = in_rec709(C3d(reflectance_) * irradiance / pi + emitted_) * result_.exposure;
    const double brightest = std::max({color.x, color.y, color.z});
    if (brightest > 1.0) color /= brightest;
    C3f rounded;
    for (int k = 0; k < 3; ++k) rounded[k] = std::clamp(static_cast<float>(color[k]), 0.0f, 1.0f);
    return rounded;
  }

  // Viewers know no other primaries.
  [[nodiscard]] C3d in_rec709(const C3d& radiance) const {
    return to_rec709_ == ColorMatrix{} ? radiance : C3d(to_rec709_(C3f(radiance)));
  }

  // `original` is the face of the elements' own mesh.
  void add_face(std::uint32_t root, std::uint32_t face, std::uint32_t original) {
    const std::array<std::uint32_t, 3>& corner = vertices_.faces().corner[face];
    std::array<C3d, 3> value{C3d(0.0), C3d(0.0), C3d(0.0)};
    for (int k = 0; k < 3 && original != no_index; ++k)
      value[k] = C3d(irradiance_[element_vertices_.faces().corner[original][k]].total());
    const std::span<const VertexMesh::EdgeVertex> between = vertices_.edge_vertices(face);
    outline_.clear();
    auto next = between.begin();
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t to = (k + 1) % 3;
      const V3d from_position(vertices_.position(corner[k])), to_position(vertices_.position(corner[to]));
      outline_.push_back(index_of(corner[k], value[k]));
      for (; next != between.end() && next->edge == k; ++next) {
        const double t = (V3d(vertices_.position(next->vertex)) - from_position).length() /
                         (to_position - from_position).length();
        outline_.push_back(index_of(next->vertex, value[k] + (value[to] - value[k]) * t));
      }
    }
    if (result_.sides.back().side == back) std::reverse(outline_.begin(), outline_.end());
    if (outline_.size() == 3)
      add_triangle(outline_[0], outline_[1], outline_[2]);
    else
      add_star(root, face, (value[0] + value[1] + value[2]) / 3.0);
  }

  // Around the middle, which is a star's only place that makes no triangle flat.
  void add_star(std::uint32_t root, std::uint32_t face, const C3d& irradiance) {
    DisplaySide& side = result_.sides.back();
    const auto middle = static_cast<std::uint32_t>(side.position.size());
    side.position.emplace_back(middle_of(root, face));
    side.color.push_back(color(irradiance));
    for (std::size_t k = 0; k < outline_.size(); ++k)
      add_triangle(middle, outline_[k], outline_[(k + 1) % outline_.size()]);
  }

  [[nodiscard]] V3d middle_of(std::uint32_t root, std::uint32_t face) const {
    if (complete_.mesh().roots()[root].divisions > 0) return complete_.mesh().patch(face).centroid().position;
    V3d sum(0.0);
    for (const std::uint32_t vertex : vertices_.faces().corner[face]) sum += V3d(vertices_.position(vertex));
    return sum / 3.0;
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    result_.sides.back().triangle.emplace_back(a, b, c);
  }

  // Faces of one side share vertices; their colours agree.
  std::uint32_t index_of(std::uint32_t vertex, const C3d& irradiance) {
    if (index_[vertex] != no_index) return index_[vertex];
    DisplaySide& side = result_.sides.back();
    index_[vertex] = static_cast<std::uint32_t>(side.position.size());
    used_.push_back(vertex);
    side.position.push_back(vertices_.position(vertex));
    side.color.push_back(color(irradiance));
    return index_[vertex];
  }

  const Scene& scene_;
  const Solution& solution_;
  const ColorMatrix to_rec709_;
  CompleteMesh complete_;
  VertexMesh vertices_, element_vertices_;
  std::vector<Irradiance> irradiance_;  // by vertex of the elements' own mesh
  std::vector<std::uint32_t> index_;    // by vertex: in the present side
  std::vector<std::uint32_t> used_;     // by the present side
  std::vector<std::uint32_t> outline_;  // scratch
  C3f reflectance_{0.0f};
  C3d emitted_{0.0};
  DisplayMesh result_;
};

}  // namespace

DisplayMesh display_mesh(const Scene& scene, const Solution& solution, const ColorMatrix& to_rec709) {
  return DisplayMeshBuilder(scene, solution, to_rec709).build();
}

}  // namespace twopass
