// The picture while it is rendered, in a viewer that speaks tev's protocol.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "render/core/color_matrix.h"
#include "render/image/film.h"

namespace twopass {

/// Sends what has changed four times a second, from a thread of its own. Nobody waits for the viewer: it may be
/// slow, go away, or come later; then the picture is sent anew. What has changed again before it could be sent
/// is sent once.
class Preview {
 public:
  /// `address` HOST:PORT; `name` of the picture in the viewer; `note` is called, from the thread, when the
  /// viewer is not there; `to_rec709`: from the film's colours to those of viewers.
  /// Throws Error when that is no address.
  Preview(const std::string& address, const std::string& name, int width, int height,
          std::function<void(const std::string&)> note, const ColorMatrix& to_rec709 = {});
  /// Sends the rest, for at most two seconds.
  ~Preview();
  Preview(const Preview&) = delete;
  Preview& operator=(const Preview&) = delete;

  /// Takes pixels of the film as they would stand in a file, but in linear Rec.709. Any thread may call it for
  /// pixels that nobody else changes.
  void update(const Film& film, const V2i& corner, const V2i& size);

 private:
  struct State;
  std::shared_ptr<State> state_;  // also the thread's: it may outlive this while the system looks up a name
};

}  // namespace twopass
