#include "render/preview/connection.h"

#include <cerrno>
#include <memory>

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "render/core/error.h"

namespace twopass {
namespace {

constexpr int slice_ms = 50;  // how long a wait lasts before `go_on` is asked again

// Whether the socket can be written within `most_ms`.
bool wait_for_room(int socket, int most_ms, const std::function<bool()>& go_on) {
  for (int waited = 0; waited < most_ms && go_on(); waited += slice_ms) {
    pollfd poll_for{socket, POLLOUT, 0};
    if (::poll(&poll_for, 1, slice_ms) > 0) return true;
  }
  return false;
}

bool is_connected(int socket) {
  int error = 0;
  socklen_t size = sizeof error;
  return ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0;
}

}  // namespace

Address parse_address(const std::string& text, const std::string& where) {
  const std::size_t colon = text.rfind(':');
  Address address;
  if (colon != std::string::npos) address = {text.substr(0, colon), text.substr(colon + 1)};
  if (address.host.size() > 2 && address.host.front() == '[' && address.host.back() == ']')
    address.host = address.host.substr(1, address.host.size() - 2);
  const bool digits = !address.port.empty() && address.port.size() <= 5 &&
                      address.port.find_first_not_of("0123456789") == std::string::npos;
  if (address.host.empty() || !digits || std::stoi(address.port) < 1 || std::stoi(address.port) > 65535)
    throw Error(where, "'" + text + "' is no address", "write HOST:PORT, for example 127.0.0.1:14158");
  return address;
}

bool ViewerConnection::open(const Address& address, const std::function<bool()>& go_on) {
  close();
  addrinfo hints{}, *found = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  if (::getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &found) != 0) return false;
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> list(found, ::freeaddrinfo);
  for (const addrinfo* at = found; at != nullptr && go_on(); at = at->ai_next) {
    socket_ = ::socket(at->ai_family, at->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, at->ai_protocol);
    if (socket_ < 0) continue;
    const bool started = ::connect(socket_, at->ai_addr, at->ai_addrlen) == 0 || errno == EINPROGRESS;
    if (started && wait_for_room(socket_, 1000, go_on) && is_connected(socket_)) return true;
    close();
  }
  return false;
}

bool ViewerConnection::send(std::span<const std::byte> bytes, const std::function<bool()>& go_on) {
  while (is_open() && !bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    } else if (errno == EINTR) {
      continue;
    } else if ((errno != EAGAIN && errno != EWOULDBLOCK) || !wait_for_room(socket_, 3000, go_on)) {
      close();
    }
  }
  return is_open();
}

void ViewerConnection::close() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
}

}  // namespace twopass
