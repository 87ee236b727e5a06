#include "radiosity/solution_file.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "radiosity/mesh_files.h"
#include "radiosity/scene_fingerprint.h"
#include "render/core/deflate.h"
#include "render/core/error.h"
#include "render/core/sampler.h"
#include "render/image/atomic_file.h"
#include "render/image/regular_file.h"

// The format: a header of fixed size, a list of the bytes of its display, the solution, and a CRC-32 of all
// that stands before it. Numbers are little-endian; lists are their length (64 bits) and their entries.
namespace twopass {

namespace {

constexpr char magic[8] = {'\x89', '2', 'p', 'a', 's', 's', '\r', '\n'};  // spoilt by whoever takes it for text
constexpr std::uint32_t format_version = 3;
constexpr std::size_t checksum_size = 4;

static_assert(std::endian::native == std::endian::little, "numbers are stored as they lie in memory");

class Writer {
 public:
  template <class T>
  void operator()(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* begin = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), begin, begin + sizeof value);
  }
  template <class T>
  void operator()(const std::vector<T>& list) {
    (*this)(std::uint64_t{list.size()});
    const auto* begin = reinterpret_cast<const std::byte*>(list.data());
    bytes_.insert(bytes_.end(), begin, begin + list.size() * sizeof(T));
  }
  void operator()(const std::string& text) { (*this)(std::vector<char>(text.begin(), text.end())); }
  void operator()(const std::vector<std::string>& texts) {
    (*this)(std::uint64_t{texts.size()});
    for (const std::string& text : texts) (*this)(text);
  }
  [[nodiscard]] std::vector<std::byte>& bytes() { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

// Reads no more than there is and never takes more memory than the file has bytes. After a failure everything
// is empty.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <class T>
  void operator()(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::span<const std::byte> bytes = take(1, sizeof value);
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), sizeof value);
  }
  void operator()(bool& value) {
    std::uint8_t byte = 0;
    (*this)(byte);
    value = byte != 0;
  }
  template <class T>
  void operator()(std::vector<T>& list) {
    const std::span<const std::byte> bytes = take(length(), sizeof(T));
    list.resize(bytes.size() / sizeof(T));
    if (!bytes.empty()) std::memcpy(list.data(), bytes.data(), bytes.size());
  }
  void operator()(std::string& text) {
    std::vector<char> characters;
    (*this)(characters);
    text.assign(characters.begin(), characters.end());
  }
  void operator()(std::vector<std::string>& texts) {
    const std::uint64_t count = length();
    for (std::uint64_t k = 0; k < count && !failed_; ++k) (*this)(texts.emplace_back());
  }
  /// The next list of bytes, where it lies.
  std::span<const std::byte> bytes() { return take(length(), 1); }
  /// Nothing was missing and nothing is left over.
  [[nodiscard]] bool complete() const { return !failed_ && rest_.empty(); }

 private:
  std::uint64_t length() {
    std::uint64_t count = 0;
    (*this)(count);
    return count;
  }
  std::span<const std::byte> take(std::uint64_t count, std::size_t size) {
    if (failed_ || count > rest_.size() / size) {
      failed_ = true;
      return {};
    }
    const std::span<const std::byte> taken = rest_.first(static_cast<std::size_t>(count) * size);
    rest_ = rest_.subspan(taken.size());
    return taken;
  }

  std::span<const std::byte> rest_;
  bool failed_ = false;
};

// One list for writing and reading. Sizes are 64 bits on every machine that the program runs on.
template <class Stats, class Visit>
void visit_stats(Stats& stats, Visit& visit) {
  visit(stats.solver);
  visit(stats.form_factors);
  visit(stats.elements);
  visit(stats.links);
  visit(stats.iterations);
  visit(stats.rays);
  visit(stats.residual);
  visit(stats.error_bound);
  visit(stats.closure_error);
  visit(stats.closed);
  visit(stats.max_reflections);
  visit(stats.memory_bytes);
  visit(stats.notes);
}
template <class Mesh, class Visit>
void visit_mesh(Mesh& mesh, Visit& visit) {
  visit(mesh.surface);
  visit(mesh.divisions);
  visit(mesh.cluster);
  visit(mesh.level);
  visit(mesh.area);
}

struct Header {
  char magic[8];
  std::uint32_t byte_order;  // 0x01020304 as the writer's machine stores it
  std::uint32_t version;     // of the format
  char program[16];          // version of the program, for whoever looks into the file
  std::uint64_t size;        // of the whole file
  std::uint64_t fingerprint;
};
static_assert(sizeof(Header) == 48);
constexpr std::uint32_t byte_order_mark = 0x01020304;

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
  throw Error(path.string(), what, "make it again with twopass solve");
}

// The content between header and checksum, once it is certain that it is what was written.
std::span<const std::byte> checked_content(const std::filesystem::path& path, std::span<const std::byte> bytes,
                                           Header& header) {
  if (bytes.size() < sizeof magic || std::memcmp(bytes.data(), magic, sizeof magic) != 0)
    throw Error(path.string(), "not a radiosity solution", "give a .radiosity file made with twopass solve");
  if (bytes.size() < sizeof header + checksum_size) refuse(path, "the file is incomplete");
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.byte_order != byte_order_mark)
    refuse(path, "the file is damaged or of a machine of other byte order");
  if (header.version > format_version)
    throw Error(path.string(), "written by a newer version of the program",
                "use that version, or make it again with twopass solve");
  if (header.version < format_version)
    refuse(path, "the file is damaged, or of an older version of the program");
  if (header.size > bytes.size()) refuse(path, "the file is incomplete");
  std::uint32_t checksum;
  std::memcpy(&checksum, bytes.data() + bytes.size() - checksum_size, checksum_size);
  if (header.size != bytes.size() || crc32_of(bytes.first(bytes.size() - checksum_size)) != checksum)
    refuse(path, "the file is damaged");
  return bytes.subspan(sizeof header, bytes.size() - sizeof header - checksum_size);
}

// Six numbers an element.
std::vector<float> as_numbers(std::span<const Irradiance> irradiance) {
  std::vector<float> numbers;
  numbers.reserve(6 * irradiance.size());
  for (const Irradiance& i : irradiance)
    for (const C3f& part : {i.direct, i.indirect}) numbers.insert(numbers.end(), {part.x, part.y, part.z});
  return numbers;
}
std::vector<Irradiance> from_numbers(const std::vector<float>& numbers) {
  std::vector<Irradiance> irradiance(numbers.size() / 6);
  for (std::size_t i = 0; i < irradiance.size(); ++i) {
    const float* n = &numbers[6 * i];
    irradiance[i] = {C3f(n[0], n[1], n[2]), C3f(n[3], n[4], n[5])};
  }
  return irradiance;
}

bool all_finite(const std::vector<float>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::isfinite(x); });
}

}  // namespace

std::uint64_t solution_fingerprint(const Solution& solution) {
  Writer write;
  const ElementMesh::Saved mesh = solution.mesh().save();
  visit_mesh(mesh, write);
  write(as_numbers(solution.irradiances()));
  std::uint64_t state = write.bytes().size();
  for (std::size_t i = 0; i < write.bytes().size(); i += sizeof state) {
    std::uint64_t word = 0;
    std::memcpy(&word, write.bytes().data() + i, std::min(sizeof word, write.bytes().size() - i));
    state = hash_word(state ^ word) + i;
  }
  return state;
}

std::vector<std::byte> solution_to_bytes(const Scene& scene, const Solution& solution,
                                         const std::vector<std::byte>& display,
                                         const GroupedIrradiance& groups) {
  Writer write;
  Header header{};
  std::memcpy(header.magic, magic, sizeof magic);
  header.byte_order = byte_order_mark;
  header.version = format_version;
  std::strncpy(header.program, TWOPASS_VERSION, sizeof header.program - 1);
  header.fingerprint = scene_fingerprint(scene);
  write(header);
  write(display);
  const ElementMesh::Saved mesh = solution.mesh().save();
  visit_mesh(mesh, write);
  write(as_numbers(solution.irradiances()));
  visit_stats(solution.stats(), write);
  write(groups.names);
  for (const std::vector<Irradiance>& irradiance : groups.by_group) write(as_numbers(irradiance));
  std::vector<std::byte>& bytes = write.bytes();
  header.size = bytes.size() + checksum_size;
  std::memcpy(bytes.data(), &header, sizeof header);
  write(crc32_of(bytes));
  return std::move(bytes);
}

Solution solution_from_bytes(std::span<const std::byte> bytes, const Scene& scene,
                             const std::filesystem::path& where, GroupedIrradiance* groups) {
  Header header;
  Reader read(checked_content(where, bytes, header));
  if (header.fingerprint != scene_fingerprint(scene))
    throw Error(
        where.string(), "this solution belongs to another scene",
        "give the scene that it was made of, with the same -D, --sky and --working-space, or make it again "
        "with twopass solve");
  read.bytes();
  ElementMesh::Saved saved;
  std::vector<float> irradiance;
  RadiosityStats stats;
  visit_mesh(saved, read);
  read(irradiance);
  visit_stats(stats, read);
  std::vector<std::string> names;
  read(names);
  std::vector<std::vector<float>> by_group(names.size());
  for (std::vector<float>& numbers : by_group) read(numbers);
  // A file with the right checksum that nobody but a forger can have written: still no reason to crash.
  if (!read.complete()) refuse(where, "the file is damaged");
  std::optional<ElementMesh> mesh = ElementMesh::restore(scene.shapes(), scene.description().materials, saved);
  const auto fits = [&](const std::vector<float>& numbers) {
    return 6 * mesh->count() == numbers.size() && all_finite(numbers);
  };
  if (!mesh || !fits(irradiance) || !std::ranges::all_of(by_group, fits)) refuse(where, "the file is damaged");
  if (groups != nullptr) {
    *groups = {std::move(names), {}};
    for (const std::vector<float>& numbers : by_group) groups->by_group.push_back(from_numbers(numbers));
  }
  return Solution(std::move(*mesh), from_numbers(irradiance), std::move(stats));
}

void save_solution(const std::filesystem::path& path, const Scene& scene, const Solution& solution,
                   const ColorMatrix& to_rec709, const GroupedIrradiance& groups) {
  const std::vector<std::byte> display = glb_of(display_mesh(scene, solution, to_rec709), scene, path.string());
  write_atomically(path, solution_to_bytes(scene, solution, display, groups));
}

Solution load_solution(const std::filesystem::path& path, const Scene& scene, GroupedIrradiance* groups) {
  const std::string bytes = read_regular_file(path);
  return solution_from_bytes(std::as_bytes(std::span(bytes)), scene, path, groups);
}

std::vector<std::byte> display_of_solution(const std::filesystem::path& path) {
  const std::string bytes = read_regular_file(path);
  Header header;
  Reader read(checked_content(path, std::as_bytes(std::span(bytes)), header));
  const std::span<const std::byte> display = read.bytes();
  if (display.empty()) refuse(path, "the file is damaged");
  return {display.begin(), display.end()};
}

}  // namespace twopass
