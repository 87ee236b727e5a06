#include "render/load/ies_file.h"

#include "render/core/error.h"
#include "render/load/number.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

constexpr std::string_view blanks = " ,\t\r";
// More than any goniophotometer measures; a file that claims more is broken.
constexpr std::size_t most_angles = 20000, most_values = 4000000;

/// The lines of a file up to TILT=, then its numbers one by one.
class IesReader {
 public:
  IesReader(std::string_view text, std::string_view name) : rest_(without_byte_order_mark(text)), name_(name) {}

  /// What stands after TILT=.
  std::string read_tilt() {
    std::string_view line;
    while (next_line(line)) {
      const auto pieces = split(line, blanks);
      if (pieces.empty() || !lower_case(pieces[0]).starts_with("tilt=")) continue;
      return lower_case(pieces[0].substr(5));
    }
    throw Error(name_, "no line TILT=", "this is not an IES file of IESNA LM-63");
  }

  double number(std::string_view what) {
    while (next_ == tokens_.size()) {
      std::string_view line;
      if (!next_line(line))
        throw Error(where(), "the file ends before " + std::string(what), "it is incomplete: get it again");
      tokens_ = split(line, blanks);
      next_ = 0;
    }
    const auto value = parse_number(tokens_[next_]);
    if (!value)
      throw Error(where(), std::string(what) + ": " + in_quotes(tokens_[next_]) + " is not a finite number",
                  "correct it");
    ++next_;
    return *value;
  }

  std::size_t count(std::string_view what) {
    const double value = number(what);
    if (!(value >= 1.0 && value <= static_cast<double>(most_angles) && value == std::floor(value)))
      throw Error(where(), std::string(what) + " is not a whole number from 1 to 20000", "correct it");
    return static_cast<std::size_t>(value);
  }

  std::vector<float> angles(std::size_t count, std::string_view what, double last) {
    std::vector<float> list;
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = number(what);
      if (!(angle >= 0.0 && angle <= last))
        throw Error(where(), "an angle outside of 0 to " + std::to_string(static_cast<int>(last)) + " degrees",
                    "photometric type C has none: correct it");
      if (!list.empty() && !(static_cast<float>(angle) > list.back()))
        throw Error(where(), std::string(what) + " do not ascend", "sort them, with their candela");
      list.push_back(static_cast<float>(angle));
    }
    return list;
  }

  [[nodiscard]] std::string where() const { return std::string(name_) + ":" + std::to_string(line_); }

 private:
  bool next_line(std::string_view& line) {
    if (rest_.empty()) return false;
    ++line_;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    return true;
  }

  std::string_view rest_, name_;
  std::vector<std::string_view> tokens_;
  std::size_t next_ = 0;
  int line_ = 0;
};

/// Lamps that burn differently in tilted luminaires. We do not know which way is down while a profile is used.
void read_tilt_factors(IesReader& reader) {
  reader.number("the lamp's position in the luminaire");
  const std::size_t count = reader.count("the number of tilt angles");
  for (std::size_t i = 0; i < count; ++i) reader.number("the tilt angles");
  for (std::size_t i = 0; i < count; ++i)
    if (reader.number("the tilt factors") != 1.0)
      throw Error(reader.where(), "the lamp's light depends on the luminaire's tilt, which is not supported",
                  "write TILT=NONE for the luminaire as it was measured");
}

void check_symmetry(const std::vector<float>& horizontal, const std::string& where) {
  const float first = horizontal.front(), last = horizontal.back();
  const bool is_known = horizontal.size() == 1 || (first == 90.0f && last == 270.0f) ||
                        (first == 0.0f && (last == 90.0f || last == 180.0f || last == 360.0f));
  if (!is_known)
    throw Error(where,
                "the horizontal angles do not run from 0 to 0, 90, 180 or 360, or from 90 to 270 degrees",
                "complete them");
}

}  // namespace

IesProfile parse_ies(std::string_view text, std::string_view name) {
  IesReader reader(text, name);
  const std::string tilt = reader.read_tilt();
  if (tilt == "include")
    read_tilt_factors(reader);
  else if (tilt != "none")
    throw Error(reader.where(), "TILT=" + tilt + " is not supported", "write TILT=NONE");
  reader.number("the number of lamps");
  reader.number("the lumens of a lamp");
  double scale = reader.number("the candela multiplier");
  const std::size_t vertical_count = reader.count("the number of vertical angles");
  const std::size_t horizontal_count = reader.count("the number of horizontal angles");
  const double type = reader.number("the photometric type");
  if (type != 1.0)
    throw Error(reader.where(), "only photometric type C (1) is supported",
                type == 2.0 || type == 3.0 ? "convert the file from type B or A to C" : "correct the type");
  for (const char* what : {"the units", "the width", "the length", "the height"}) reader.number(what);
  scale *= reader.number("the ballast factor");
  scale *= reader.number("the ballast-lamp factor");
  reader.number("the input watts");
  if (!(scale >= 0.0 && scale <= 1e30))
    throw Error(reader.where(), "multiplier and ballast factors are negative or huge", "correct them");
  if (vertical_count * horizontal_count > std::min(most_values, text.size()))
    throw Error(reader.where(), "more candela values are announced than the file can hold", "it is incomplete");

  std::vector<float> vertical = reader.angles(vertical_count, "the vertical angles", 180.0);
  std::vector<float> horizontal = reader.angles(horizontal_count, "the horizontal angles", 360.0);
  check_symmetry(horizontal, reader.where());
  std::vector<float> candela;
  for (std::size_t i = 0; i < vertical_count * horizontal_count; ++i) {
    const double value = reader.number("the candela values") * scale;
    // Goniophotometers subtract stray light: a little less than nothing is nothing.
    if (!(value <= 1e30)) throw Error(reader.where(), "a candela value is huge", "correct it");
    candela.push_back(static_cast<float>(std::max(value, 0.0)));
  }
  return {std::move(vertical), std::move(horizontal), std::move(candela)};
}

IesProfile read_ies(const std::filesystem::path& path) {
  return parse_ies(read_text_file(path), path.string());
}

}  // namespace twopass
