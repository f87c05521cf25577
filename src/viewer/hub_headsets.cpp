// Reports the state of the headsets from the hub to the run.
#include <algorithm>

#include "core/types.h"
#include "viewer/hub.h"

namespace predictor::viewer {
namespace {

// The pose may be slightly newer than the present, because the page estimates the server's clock.
constexpr std::uint64_t kAhead = 50'000'000;  // [ns]

// Returns the rotation of the head with x forward, y left and z up. `q` is the rotation of the
// headset's view, with x right, y up and z backward (WebXR).
std::array<double, 4> HeadRotation(const std::array<double, 4>& q) {
  const Quaternion R_WV(q[0], q[1], q[2], q[3]), R_VHead(0.5, -0.5, 0.5, 0.5);
  const Quaternion R_WHead = (R_WV * R_VHead).normalized();
  return {R_WHead.w(), R_WHead.x(), R_WHead.y(), R_WHead.z()};
}

}  // namespace

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

// Without a registration, the pose in W says nothing about the person at the real handles. With
// several headsets, it is not known who of them holds the handles.
void Hub::MeasureHead(std::uint32_t client, const ImmersiveRequest& request) {
  const auto worn = std::ranges::count(headsets_, 0U, &Headset::gone_ns);
  if (!request.active || !request.has_head || !request.registration || worn != 1) return;
  const std::uint64_t now = clock_();
  if (request.posed_ns == 0 || request.posed_ns > now + kAhead) return;
  const std::uint64_t posed = std::min(now, request.posed_ns);
  const HeadRecord head{.wall_ns = posed,
                        .delay = 1e-9 * static_cast<double>(now - posed),
                        .client = client,
                        .p = request.p,
                        .q = HeadRotation(request.q),
                        .registration = *request.registration};
  if (IsPlausible(head)) mailbox_->heads.Publish(head);
}

}  // namespace predictor::viewer
