#include "render/preview/tev_packets.h"

#include <bit>
#include <cstring>
#include <type_traits>

namespace twopass {
namespace {

static_assert(std::endian::native == std::endian::little, "packets are little-endian");

enum class Operation : std::uint8_t { close_image = 2, create_image = 4, update_image = 6 };

// A packet: its length, these four bytes included; its kind; then numbers and texts without any padding.
class Packet {
 public:
  explicit Packet(Operation operation) {
    add(std::uint32_t{0});
    add(static_cast<std::uint8_t>(operation));
  }
  template <class Number>
  void add(Number number) {
    static_assert(std::is_arithmetic_v<Number>);
    add_bytes(&number, sizeof number);
  }
  void add(const std::string& text) { add_bytes(text.c_str(), text.size() + 1); }
  void add(std::span<const float> numbers) { add_bytes(numbers.data(), numbers.size_bytes()); }
  void add(std::span<const std::string> texts) {
    add(static_cast<std::int32_t>(texts.size()));
    for (const std::string& text : texts) add(text);
  }
  std::vector<std::byte> finish() {
    const auto length = static_cast<std::uint32_t>(bytes_.size());
    std::memcpy(bytes_.data(), &length, sizeof length);
    return std::move(bytes_);
  }

 private:
  void add_bytes(const void* first, std::size_t count) {
    const auto* begin = static_cast<const std::byte*>(first);
    bytes_.insert(bytes_.end(), begin, begin + count);
  }
  std::vector<std::byte> bytes_;
};

}  // namespace

std::vector<std::byte> create_image_packet(const std::string& name, const V2i& size,
                                           std::span<const std::string> channels, bool grab_focus) {
  Packet packet(Operation::create_image);
  packet.add(std::uint8_t{grab_focus});
  packet.add(name);
  packet.add(std::int32_t{size.x});
  packet.add(std::int32_t{size.y});
  packet.add(channels);
  return packet.finish();
}

std::vector<std::byte> update_image_packet(const std::string& name, std::span<const std::string> channels,
                                           const V2i& corner, const V2i& size, std::span<const float> pixels) {
  Packet packet(Operation::update_image);
  packet.add(std::uint8_t{0});  // the viewer may look at something else meanwhile
  packet.add(name);
  packet.add(channels);
  for (const int number : {corner.x, corner.y, size.x, size.y}) packet.add(std::int32_t{number});
  for (std::size_t c = 0; c < channels.size(); ++c) packet.add(static_cast<std::int64_t>(c));
  for (std::size_t c = 0; c < channels.size(); ++c) packet.add(static_cast<std::int64_t>(channels.size()));
  packet.add(pixels);
  return packet.finish();
}

std::vector<std::byte> close_image_packet(const std::string& name) {
  Packet packet(Operation::close_image);
  packet.add(name);
  return packet.finish();
}

}  // namespace twopass
