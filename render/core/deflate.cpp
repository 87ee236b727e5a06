#include "render/core/deflate.h"

#include <algorithm>
#include <limits>

#include <zlib.h>

namespace twopass {

// zlib counts in unsigned int: longer spans go in pieces.
constexpr std::size_t largest_piece = std::numeric_limits<uInt>::max() / 2;

struct Inflater::Impl {
  z_stream stream{};
  std::span<const std::byte> rest;  // not yet given to the stream
  bool is_good = false;
};

Inflater::Inflater(std::span<const std::byte> compressed) : impl_(std::make_unique<Impl>()) {
  impl_->rest = compressed;
  impl_->is_good = inflateInit(&impl_->stream) == Z_OK;
}

Inflater::~Inflater() { inflateEnd(&impl_->stream); }

bool Inflater::read(std::span<std::byte> to) {
  z_stream& stream = impl_->stream;
  while (!to.empty() && impl_->is_good) {
    if (stream.avail_in == 0) {
      const auto piece = impl_->rest.first(std::min(impl_->rest.size(), largest_piece));
      // zlib does not write through this pointer.
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(piece.data()));
      stream.avail_in = static_cast<uInt>(piece.size());
      impl_->rest = impl_->rest.subspan(piece.size());
    }
    const std::size_t wanted = std::min(to.size(), largest_piece);
    stream.next_out = reinterpret_cast<Bytef*>(to.data());
    stream.avail_out = static_cast<uInt>(wanted);
    const int code = inflate(&stream, Z_NO_FLUSH);
    to = to.subspan(wanted - stream.avail_out);
    // At the end of the stream, or of the data (Z_BUF_ERROR), there is no more.
    impl_->is_good = code == Z_OK;
  }
  return to.empty();
}

std::uint32_t crc32_of(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(crc32_z(0, nullptr, 0), reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace twopass
