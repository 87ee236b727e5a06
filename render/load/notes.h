// What a loader replaced, repaired or left out: collected while loading, told to the user in a few lines.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

namespace twopass {

/// Notes in the order of their first appearance, each once.
class Notes {
 public:
  static constexpr std::size_t most_lines = 10;

  /// Remembers `note`. The same note again is counted, not repeated.
  void add(std::string note) { add(std::move(note), 1); }
  /// Adds all of the other's, in their order.
  void add(const Notes& other) {
    for (const Entry& entry : other.entries_) add(entry.text, entry.count);
  }
  /// The notes, one line each; repeated ones end in "(N times)". Beyond most_lines the last line is
  /// "and N more".
  [[nodiscard]] std::vector<std::string> lines() const;

 private:
  void add(std::string note, int count);

  struct Entry {
    std::string text;
    int count;
  };
  std::vector<Entry> entries_;
  std::unordered_map<std::string, std::size_t> known_;  // hostile files can be worth a million different notes
};

}  // namespace twopass
