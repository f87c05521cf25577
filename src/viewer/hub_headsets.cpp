// Reports the state of the headsets from the hub to the run.
#include <algorithm>

#include "viewer/hub.h"

namespace predictor::viewer {

// A page that still sends messages may show a frozen picture, so the time of the drawn state is
// decisive. With real arms, the end of a session is also reported as silence. This report lasts
// for the time that the run needs to detect it. The run then decides whether a motion must be
// stopped.
void Hub::See(std::uint32_t client, const ImmersiveRequest& request) {
  const std::uint64_t now = clock_();
  auto found = std::find_if(headsets_.begin(), headsets_.end(),
                            [client](const Headset& h) { return h.client == client; });
  if (request.active) {
    if (found == headsets_.end()) found = headsets_.insert(headsets_.end(), {client, now, 0});
    found->gone_ns = 0;
    if (request.drawn_ns != 0) found->frame_ns = std::min(now, request.drawn_ns);
  } else if (found != headsets_.end()) {
    if (!setup_.rules.watches_headsets)
      headsets_.erase(found);
    else if (found->gone_ns == 0)
      found->gone_ns = now;
  }
  PublishHeadsets();
}

// The run stops real arms when a headset falls silent. Therefore the headset with the oldest
// picture is decisive, and a headset whose page has disconnected is kept for a while.
void Hub::PublishHeadsets() {
  const std::uint64_t now = clock_();
  std::erase_if(headsets_, [now](const Headset& h) {
    return h.gone_ns != 0 && now - h.gone_ns > kImmersiveLinger;
  });
  std::uint64_t oldest = now;
  for (const Headset& headset : headsets_) oldest = std::min(oldest, headset.frame_ns);
  if (!headsets_.empty()) mailbox_->immersive_frame_ns.store(oldest, std::memory_order_relaxed);
  mailbox_->immersive.store(static_cast<std::uint32_t>(headsets_.size()),
                            std::memory_order_release);
}

}  // namespace predictor::viewer
