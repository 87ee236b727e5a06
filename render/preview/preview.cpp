#include "render/preview/preview.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "render/image/primaries.h"
#include "render/preview/connection.h"
#include "render/preview/tev_packets.h"

namespace twopass {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr int block_size = 128;  // pixels; smaller packets keep viewers busier than the picture is worth
constexpr auto update_period = 250ms, retry_period = 1000ms, most_at_the_end = 2000ms;

const std::vector<std::string> channels{"R", "G", "B", "A"};

}  // namespace

struct Preview::State {
  struct Block {
    std::mutex mutex;
    bool sampled = false, changed = false;
  };

  State(Address address_, std::string name_, const V2i& size_, std::function<void(const std::string&)> note_,
        const ColorMatrix& to_rec709_)
      : address(std::move(address_)),
        name(std::move(name_)),
        note(std::move(note_)),
        to_rec709(to_rec709_),
        size(size_),
        blocks_x((size.x + block_size - 1) / block_size),
        blocks(static_cast<std::size_t>(blocks_x) *
               static_cast<std::size_t>((size.y + block_size - 1) / block_size)),
        pixels(channels.size() * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)) {}

  [[nodiscard]] std::size_t index(int x, int y) const {
    return channels.size() *
           (static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x));
  }

  // The thread, until it is told to stop and has sent the rest.
  void run() {
    for (bool tried = false;; tried = true) {
      const bool last = is_stopping();
      if (!connection.is_open() && !(tried && last)) start();
      if (connection.is_open()) {
        if (send_changes() && last) break;
        if (last) continue;
        sleep(update_period);
      } else {
        if (last) break;
        if (!told)
          note("preview: nobody listens at " + address.host + ":" + address.port +
               ", tried again every second");
        told = true;
        sleep(retry_period);
      }
    }
    connection.close();
    const std::lock_guard lock(mutex);
    finished = true;
    wake.notify_all();
  }

  void start() {
    if (!connection.open(address, [this] { return go_on(); })) return;
    for (Block& block : blocks) {
      const std::lock_guard lock(block.mutex);
      block.changed = block.sampled;
    }
    send(create_image_packet(name, size, channels, true));
  }

  bool send_changes() {
    std::vector<float> copy;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const int x = static_cast<int>(i % static_cast<std::size_t>(blocks_x)) * block_size,
                y = static_cast<int>(i / static_cast<std::size_t>(blocks_x)) * block_size;
      const V2i part(std::min(block_size, size.x - x), std::min(block_size, size.y - y));
      {
        const std::lock_guard lock(blocks[i].mutex);
        if (!blocks[i].changed) continue;
        blocks[i].changed = false;
        copy.clear();
        for (int row = y; row < y + part.y; ++row)
          copy.insert(copy.end(), pixels.begin() + static_cast<std::ptrdiff_t>(index(x, row)),
                      pixels.begin() + static_cast<std::ptrdiff_t>(
                                           index(x, row) + channels.size() * static_cast<std::size_t>(part.x)));
      }
      if (!send(update_image_packet(name, channels, {x, y}, part, copy))) return false;
    }
    return true;
  }

  bool send(const std::vector<std::byte>& packet) {
    return connection.send(packet, [this] { return go_on(); });
  }

  void sleep(Clock::duration time) {
    std::unique_lock lock(mutex);
    wake.wait_for(lock, time, [this] { return stopping.load(); });
  }
  [[nodiscard]] bool is_stopping() const { return stopping; }
  [[nodiscard]] bool go_on() const { return !stopping || Clock::now() < deadline.load(); }

  const Address address;
  const std::string name;
  const std::function<void(const std::string&)> note;
  const ColorMatrix to_rec709;
  const V2i size;
  const int blocks_x;
  std::vector<Block> blocks;
  std::vector<float> pixels;    // of each block, under its mutex
  ViewerConnection connection;  // the thread's
  std::mutex mutex;
  std::condition_variable wake;
  std::atomic<bool> stopping{false};
  std::atomic<Clock::time_point> deadline{Clock::time_point::max()};
  bool told = false, finished = false;
};

Preview::Preview(const std::string& address, const std::string& name, int width, int height,
                 std::function<void(const std::string&)> note, const ColorMatrix& to_rec709)
    : state_(std::make_shared<State>(parse_address(address, "--preview"), name, V2i(width, height),
                                     std::move(note), to_rec709)) {
  std::thread([state = state_] { state->run(); }).detach();
}

Preview::~Preview() {
  std::unique_lock lock(state_->mutex);
  state_->deadline = Clock::now() + most_at_the_end;
  state_->stopping = true;
  state_->wake.notify_all();
  // A thread that hangs in the look-up of a name is left behind.
  state_->wake.wait_for(lock, most_at_the_end + 500ms, [this] { return state_->finished; });
}

void Preview::update(const Film& film, const V2i& corner, const V2i& size) {
  for (int y = corner.y; y < corner.y + size.y; ++y)
    for (int x = corner.x; x < corner.x + size.x;) {
      const int end = std::min(corner.x + size.x, (x / block_size + 1) * block_size);
      State::Block& block =
          state_->blocks[static_cast<std::size_t>(y / block_size * state_->blocks_x + x / block_size)];
      const std::lock_guard lock(block.mutex);
      block.sampled = block.changed = true;
      for (; x < end; ++x) {
        std::array<float, 4> rgba = film.pixel(x, y).resolved();
        if (state_->to_rec709 != ColorMatrix{}) {
          const C3f color = linear_image(state_->to_rec709, {rgba[0], rgba[1], rgba[2]});
          for (std::size_t c = 0; c < 3; ++c) rgba[c] = color[static_cast<int>(c)];
        }
        std::copy(rgba.begin(), rgba.end(),
                  state_->pixels.begin() + static_cast<std::ptrdiff_t>(state_->index(x, y)));
      }
    }
}

}  // namespace twopass
