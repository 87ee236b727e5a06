// A viewer for tests: listens like tev, decodes every packet by the protocol's description, and keeps the
// pictures.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstring>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace twopass::test {

struct ViewedPicture {
  int width = 0, height = 0;
  std::vector<std::string> channels;
  std::vector<std::vector<float>> planes;  // by channel
  int updates = 0, creations = 0;
};

// Reads little-endian numbers and texts; throws where a packet ends too early.
class PacketReader {
 public:
  explicit PacketReader(std::vector<char> bytes) : bytes_(std::move(bytes)) {}
  template <class T>
  T number() {
    T value;
    need(sizeof value);
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::string text() {
    std::string result;
    for (char c; (c = number<char>()) != 0;) result += c;
    return result;
  }
  [[nodiscard]] std::size_t rest() const { return bytes_.size() - at_; }

 private:
  void need(std::size_t count) const {
    if (count > rest()) throw std::runtime_error("a packet that ends too early");
  }
  std::vector<char> bytes_;
  std::size_t at_ = 0;
};

// Applies a packet (without its length) to the pictures. Throws what is wrong with it.
inline void apply_packet(std::vector<char> bytes, std::map<std::string, ViewedPicture>& pictures) {
  PacketReader in(std::move(bytes));
  const auto wrong = [](const std::string& what) { throw std::runtime_error(what); };
  const int kind = in.number<std::uint8_t>();
  if (kind == 2) {
    pictures.erase(in.text());
  } else if (kind == 4) {
    in.number<std::uint8_t>();
    ViewedPicture& picture = pictures[in.text()];
    picture.width = in.number<std::int32_t>();
    picture.height = in.number<std::int32_t>();
    picture.channels.resize(static_cast<std::size_t>(in.number<std::int32_t>()));
    for (std::string& name : picture.channels) name = in.text();
    if (picture.width < 1 || picture.height < 1 || picture.channels.empty()) wrong("an empty picture");
    picture.planes.assign(picture.channels.size(),
                          std::vector<float>(static_cast<std::size_t>(picture.width * picture.height), 0.0f));
    ++picture.creations;
  } else if (kind == 6) {
    in.number<std::uint8_t>();
    const std::string name = in.text();
    if (!pictures.contains(name)) wrong("an update of an unknown picture");
    ViewedPicture& picture = pictures[name];
    std::vector<std::size_t> to(static_cast<std::size_t>(in.number<std::int32_t>()));
    for (std::size_t& channel : to) {
      const std::string wanted = in.text();
      channel = 0;
      while (channel < picture.channels.size() && picture.channels[channel] != wanted) ++channel;
      if (channel == picture.channels.size()) wrong("an unknown channel " + wanted);
    }
    const int x = in.number<std::int32_t>(), y = in.number<std::int32_t>();
    const int w = in.number<std::int32_t>(), h = in.number<std::int32_t>();
    if (x < 0 || y < 0 || w < 1 || h < 1 || x + w > picture.width || y + h > picture.height)
      wrong("a part that is not inside");
    std::vector<std::int64_t> offsets(to.size()), strides(to.size());
    for (auto& offset : offsets) offset = in.number<std::int64_t>();
    for (auto& stride : strides) stride = in.number<std::int64_t>();
    std::int64_t count = 0;
    for (std::size_t c = 0; c < to.size(); ++c)
      count = std::max(count, offsets[c] + (std::int64_t{w} * h - 1) * strides[c] + 1);
    if (in.rest() != static_cast<std::size_t>(count) * sizeof(float)) wrong("a packet of another size");
    std::vector<float> values(static_cast<std::size_t>(count));
    for (float& value : values) value = in.number<float>();
    for (std::size_t c = 0; c < to.size(); ++c)
      for (int i = 0; i < w * h; ++i)
        picture.planes[to[c]][static_cast<std::size_t>((y + i / w) * picture.width + x + i % w)] =
            values[static_cast<std::size_t>(offsets[c] + i * strides[c])];
    ++picture.updates;
  } else {
    wrong("an unexpected kind of packet");
  }
  if (in.rest() != 0 && kind != 6) wrong("a packet that is too long");
}

class Viewer {
 public:
  // Listens on a free port of this machine, or on the given one. `reads`: false: accepts and then does not
  // care.
  explicit Viewer(int port = 0, bool reads = true) : reads_(reads) {
    listener_ = ::socket(AF_INET, SOCK_STREAM, 0);
    const int yes = 1;
    ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    const int small = 4096;
    if (!reads) ::setsockopt(listener_, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    socklen_t size = sizeof address;
    if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(listener_, 4) != 0)
      throw std::runtime_error("no port to listen on");
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { run(); });
  }
  ~Viewer() { stop(); }
  // Closes everything, as when the viewer is quit.
  void stop() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
    if (listener_ >= 0) ::close(listener_);
    listener_ = -1;
  }
  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  // Waits until `enough` of the pictures so far, at most a minute; false if it never is.
  template <class Enough>
  bool wait(const Enough& enough) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(60), [&] { return enough(pictures_); });
  }
  std::map<std::string, ViewedPicture> pictures() {
    const std::lock_guard lock(mutex_);
    return pictures_;
  }
  std::string error() {
    const std::lock_guard lock(mutex_);
    return error_;
  }

 private:
  void run() {
    int client = -1;
    while (!stopping_) {
      pollfd wait_for{client >= 0 ? client : listener_, POLLIN, 0};
      if (client >= 0 && !reads_) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        continue;
      }
      if (::poll(&wait_for, 1, 20) <= 0) continue;
      if (client < 0) {
        client = ::accept(listener_, nullptr, nullptr);
      } else if (!receive(client)) {
        ::close(client);
        client = -1;
      }
    }
    if (client >= 0) ::close(client);
  }
  static bool read_all(int client, char* bytes, std::size_t count) {
    while (count > 0) {
      const ssize_t got = ::recv(client, bytes, count, 0);
      if (got <= 0) return false;
      bytes += got;
      count -= static_cast<std::size_t>(got);
    }
    return true;
  }
  bool receive(int client) {
    std::uint32_t length = 0;
    if (!read_all(client, reinterpret_cast<char*>(&length), sizeof length)) return false;
    std::vector<char> bytes(length > sizeof length ? length - sizeof length : 0);
    if (!read_all(client, bytes.data(), bytes.size())) return false;
    const std::lock_guard lock(mutex_);
    try {
      apply_packet(std::move(bytes), pictures_);
    } catch (const std::exception& e) {
      error_ = e.what();
    }
    changed_.notify_all();
    return true;
  }

  bool reads_;
  int listener_ = -1, port_ = 0;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, ViewedPicture> pictures_;
  std::string error_;
};

}  // namespace twopass::test
