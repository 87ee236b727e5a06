// A connection to a viewer that never waits for long: not for a name, not for a viewer that is slow or gone.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

namespace twopass {

struct Address {
  std::string host, port;
};

/// "host:port", "[::1]:14158". Throws Error at `where`.
Address parse_address(const std::string& text, const std::string& where);

/// A TCP connection, closed when destroyed.
class ViewerConnection {
 public:
  ViewerConnection() = default;
  ~ViewerConnection() { close(); }
  ViewerConnection(const ViewerConnection&) = delete;
  ViewerConnection& operator=(const ViewerConnection&) = delete;

  /// Tries every address of the host, a second each, as long as `go_on` says so. The result is open(); looking
  /// up the host's name may take as long as the system likes.
  bool open(const Address& address, const std::function<bool()>& go_on);
  [[nodiscard]] bool is_open() const { return socket_ >= 0; }
  /// Sends all bytes. Closes the connection and returns false when the other side is gone, has taken nothing
  /// for three seconds, or `go_on` says no.
  bool send(std::span<const std::byte> bytes, const std::function<bool()>& go_on);
  void close();

 private:
  int socket_ = -1;
};

}  // namespace twopass
