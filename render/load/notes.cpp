#include "render/load/notes.h"

namespace twopass {

void Notes::add(std::string note, int count) {
  const auto [entry, is_new] = known_.try_emplace(note, entries_.size());
  if (is_new)
    entries_.push_back({std::move(note), count});
  else
    entries_[entry->second].count += count;
}

std::vector<std::string> Notes::lines() const {
  std::vector<std::string> lines;
  // One line too many is worth printing: "and 1 more" would take as much room.
  const std::size_t shown = entries_.size() <= most_lines + 1 ? entries_.size() : most_lines;
  for (std::size_t i = 0; i < shown; ++i) {
    const Entry& entry = entries_[i];
    lines.push_back(entry.count == 1 ? entry.text
                                     : entry.text + " (" + std::to_string(entry.count) + " times)");
  }
  if (shown < entries_.size()) lines.push_back("and " + std::to_string(entries_.size() - shown) + " more");
  return lines;
}

}  // namespace twopass
