#include "render/load/mtl_file.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/core/error.h"
#include "render/core/names.h"
#include "render/load/number.h"
#include "render/load/text_file.h"
#include "render/load/text_lines.h"

namespace twopass {
namespace {

// Keywords in lower case: exporters disagree about it (map_kd, map_Kd, Map_Kd).
constexpr Named<std::optional<C3f> MtlRecord::*> colors[] = {{"kd", &MtlRecord::kd},
                                                             {"ks", &MtlRecord::ks},
                                                             {"ke", &MtlRecord::ke},
                                                             {"tf", &MtlRecord::tf},
                                                             {"kt", &MtlRecord::tf}};
constexpr Named<std::optional<float> MtlRecord::*> scalars[] = {
    {"ns", &MtlRecord::ns}, {"ni", &MtlRecord::ni}, {"pr", &MtlRecord::pr},   {"pm", &MtlRecord::pm},
    {"ps", &MtlRecord::ps}, {"pc", &MtlRecord::pc}, {"pcr", &MtlRecord::pcr}, {"aniso", &MtlRecord::aniso}};
constexpr Named<std::optional<MtlMap> MtlRecord::*> maps[] = {
    {"map_kd", &MtlRecord::map_kd}, {"map_ks", &MtlRecord::map_ks}, {"map_ke", &MtlRecord::map_ke},
    {"map_d", &MtlRecord::map_d},   {"map_ns", &MtlRecord::map_ns}, {"map_bump", &MtlRecord::map_bump},
    {"bump", &MtlRecord::map_bump}, {"norm", &MtlRecord::norm},     {"map_norm", &MtlRecord::norm},
    {"map_kn", &MtlRecord::norm},   {"map_pr", &MtlRecord::map_pr}, {"map_pm", &MtlRecord::map_pm},
    {"map_ps", &MtlRecord::map_ps},
};
// Ambient light is what a path tracer finds out by itself; the rest are hints to other programs.
constexpr std::string_view quiet[] = {"ka", "map_ka", "sharpness", "map_aat"};

template <class T, std::size_t n>
const T* find(const Named<T> (&table)[n], std::string_view name) {
  const auto* found = std::ranges::find(table, name, &Named<T>::name);
  return found == std::end(table) ? nullptr : &found->value;
}

class Parser {
 public:
  Parser(const std::string& file, const std::set<std::string>& wanted) : file_(file), wanted_(wanted) {}

  void statement(std::string_view line, std::uint32_t number) {
    line_ = number;
    Words words(line);
    const std::string key = lower_case(words.next());
    if (key.empty() || key[0] == '#') return;
    if (key == "newmtl") {
      begin(trim(words.rest()));
      return;
    }
    if (!material_) return;  // of a material that nobody wants, or before any
    Words arguments(before_comment(words.rest()));
    if (const auto* color = find(colors, key))
      (material_->**color) = read_color(key, arguments);
    else if (const auto* scalar = find(scalars, key))
      (material_->**scalar) = read_scalar(key, arguments);
    else if (const auto* map = find(maps, key))
      (material_->**map) = read_map(key, words);
    else if (key == "d" || key == "tr")
      opacity(key, arguments);
    else if (key == "illum")
      material_->illum = static_cast<int>(std::min(read_scalar(key, arguments), 1e6f));
    else if (std::ranges::find(quiet, key) == std::end(quiet))
      ++left_out_[key.substr(0, 20)];
  }

  std::map<std::string, MtlRecord> finish(Notes& notes) {
    std::string list;
    for (const auto& [keyword, count] : left_out_)
      list += (list.empty() ? "" : ", ") + std::to_string(count) + " '" + keyword + "'";
    if (!list.empty())
      notes.add(file_ + ": statements that our materials cannot express are left out: " + list);
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const std::string& what, std::string_view remedy) const {
    throw Error(file_ + ":" + std::to_string(line_), what, remedy);
  }

  void begin(std::string_view name) {
    material_ = nullptr;
    if (name.empty()) ++left_out_["newmtl without a name"];
    if (!wanted_.contains(std::string(name))) return;
    const auto [entry, is_new] = result_.try_emplace(std::string(name));
    if (!is_new) return;
    material_ = &entry->second;
    material_->name = name;
    material_->line = line_;
    has_d_ = false;
  }

  float number(std::string_view key, std::string_view word) const {
    const std::optional<double> value = parse_number(word);
    if (!value || *value < 0.0 || *value > 1e30)
      fail(in_quotes(key) + " cannot be " + in_quotes(word), "give a number from 0 to 1e30");
    return static_cast<float>(*value);
  }

  C3f read_color(std::string_view key, Words& words) const {
    if (words.peek() == "spectral" || words.peek() == "xyz")
      fail(in_quotes(key) + " with " + in_quotes(words.peek()) + " is not supported",
           "give red, green and blue");
    C3f color;
    int count = 0;
    for (; count < 3 && !words.at_end(); ++count) color[count] = number(key, words.next());
    if (count == 1) return C3f(color[0]);
    if (count < 3) fail(in_quotes(key) + " needs one or three numbers", "give red, green and blue");
    return color;
  }

  float read_scalar(std::string_view key, Words& words) const {
    if (words.at_end()) fail(in_quotes(key) + " without a number", "give one");
    return number(key, words.next());
  }

  /// d wins over Tr wherever it stands: exporters that write both mean d.
  void opacity(const std::string& key, Words& words) {
    if (words.peek() == "-halo") words.next();
    const float value = std::min(read_scalar(key, words), 1.0f);
    if (key == "d")
      material_->d = value;
    else if (!has_d_)
      material_->d = 1.0f - value;
    has_d_ |= key == "d";
  }

  const std::string& file_;
  const std::set<std::string>& wanted_;
  std::map<std::string, MtlRecord> result_;
  MtlRecord* material_ = nullptr;
  bool has_d_ = false;
  std::uint32_t line_ = 0;
  std::map<std::string, std::size_t> left_out_;

  // Texture statements.
  MtlMap read_map(std::string_view key, Words words);
  void read_option(MtlMap& map, std::string_view name, Words& words);
  std::vector<float> numbers(std::string_view option, Words& words, std::size_t least, std::size_t most) const;
  bool on_or_off(std::string_view option, Words& words) const;
};

MtlMap Parser::read_map(std::string_view key, Words words) {
  MtlMap map;
  map.line = line_;
  while (words.peek().starts_with('-') && words.peek().size() > 1) read_option(map, words.next(), words);
  // A name may contain blanks and '#'; what follows a blank and '#' is a comment.
  std::string_view name = words.rest();
  for (const std::string_view comment : {" #", "\t#"}) name = name.substr(0, name.find(comment));
  name = name.starts_with('#') ? "" : trim(name);
  if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
  if (name.empty()) fail(in_quotes(key) + " without a file name", "name an image");
  map.file = name;
  return map;
}

void Parser::read_option(MtlMap& map, std::string_view name, Words& words) {
  if (name == "-o" || name == "-s" || name == "-t") {
    const std::vector<float> values = numbers(name, words, 1, 3);
    const V2f uv(values[0], values.size() > 1 ? values[1] : name == "-s" ? 1.0f : 0.0f);
    if (name == "-o")
      map.offset = uv;
    else if (name == "-s")
      map.scale = uv;
    else
      ++left_out_["-t"];
  } else if (name == "-mm") {
    const std::vector<float> values = numbers(name, words, 1, 2);
    map.base = values[0];
    if (values.size() > 1) map.gain = values[1];
  } else if (name == "-bm") {
    map.bump = numbers(name, words, 1, 1)[0];
  } else if (name == "-clamp") {
    map.clamp = on_or_off(name, words);
  } else if (name == "-blendu" || name == "-blendv") {
    map.nearest = !on_or_off(name, words);
  } else if (name == "-imfchan") {
    const std::string channel = lower_case(words.next());
    if (channel.size() != 1 || std::string_view("rgbmlz").find(channel[0]) == std::string_view::npos)
      fail(in_quotes(name) + " cannot be " + in_quotes(channel), "give r, g, b, m, l or z");
    map.channel = channel[0];
  } else if (name == "-texres" || name == "-boost") {
    numbers(name, words, 1, 1);  // the size at which another program should read the image, and its sharpness
  } else if (name == "-cc") {
    on_or_off(name, words);
  } else if (name == "-type") {
    words.next();
    ++left_out_["-type"];
  } else {
    fail("the texture option " + in_quotes(name) + " is unknown",
         "known: -blendu -blendv -bm -boost -cc -clamp -imfchan -mm -o -s -t -texres -type");
  }
}

std::vector<float> Parser::numbers(std::string_view option, Words& words, std::size_t least,
                                   std::size_t most) const {
  std::vector<float> values;
  while (values.size() < most && !words.at_end()) {
    const std::string_view word = words.peek();
    const std::optional<double> value = parse_number(word);
    // The last word is the file's name, even where it looks like a number.
    if (!value || (values.size() >= least && trim(words.rest()) == word)) break;
    if (!(std::abs(*value) <= 1e6))
      fail(in_quotes(option) + " cannot be " + in_quotes(word), "give a smaller number");
    values.push_back(static_cast<float>(*value));
    words.next();
  }
  if (values.size() < least)
    fail(in_quotes(option) + " cannot be " + in_quotes(words.peek()),
         "give " + std::to_string(least) + (most > least ? " or more numbers" : " number"));
  return values;
}

bool Parser::on_or_off(std::string_view option, Words& words) const {
  const std::string word = lower_case(words.next());
  if (word != "on" && word != "off")
    fail(in_quotes(option) + " cannot be " + in_quotes(word), "give on or off");
  return word == "on";
}

}  // namespace

std::map<std::string, MtlRecord> parse_mtl(std::string_view text, const std::string& file,
                                           const std::set<std::string>& wanted, Notes& notes) {
  Parser parser(file, wanted);
  LineReader lines(text, file);
  std::string_view line;
  while (lines.next(line)) parser.statement(line, lines.number());
  return parser.finish(notes);
}

}  // namespace twopass
