// Where along an unbiased path a radiosity solution turns out to be wrong (I20): what it says that an element
// reflects, against what the path finds there.
#pragma once

#include <cstdint>
#include <vector>

namespace twopass {

/// At one vertex where a two-pass picture depends on an element, in what a sample sees, mean of the channels.
struct ReadError {
  std::uint32_t element;
  double carried;  ///< what the solution says that comes from there
  double error;    ///< of that, what is too much: an estimate without bias
};

/// The errors of one path, in its order. The integrator `Unbiased` opens one at each vertex whose element the
/// picture would read, or that lies behind such a vertex; a vertex is closed at the next, where what the
/// solution says stands for the rest of the path: so the errors add up to what the picture would have too much.
class ReadErrors {
 public:
  void begin() { of_vertex_.clear(); }
  [[nodiscard]] bool has_begun() const { return !of_vertex_.empty(); }
  /// The path, which has found `seen` so far, comes to a vertex of an element, from where `carried` should
  /// come.
  void arrive(std::uint32_t element, double seen, double carried) {
    close(seen + carried);
    of_vertex_.push_back({element, carried, carried});
    seen_ = seen;
  }
  /// The path has ended.
  void end(double seen) { close(seen); }
  [[nodiscard]] const std::vector<ReadError>& of_vertex() const { return of_vertex_; }

 private:
  void close(double seen) {
    if (has_begun()) of_vertex_.back().error -= seen - seen_;
  }
  std::vector<ReadError> of_vertex_;
  double seen_ = 0.0;  // at the last vertex
};

}  // namespace twopass
