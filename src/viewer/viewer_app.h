// What the server of a run serves: page and models by HTTP, pages by WebSocket, Foxglove.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "viewer/admission.h"
#include "viewer/asset_store.h"
#include "viewer/connection.h"
#include "viewer/foxglove.h"
#include "viewer/frame.h"
#include "viewer/hub.h"

namespace predictor {

struct AppSetup {
  std::vector<std::string> hosts;    // names by which this server may be called, without port
  bool tls = false;                  // pages come from https:
  bool code_once = false;            // with real arms
  std::string secret;                // NewAdmissionSecret()
  std::vector<std::string> revoked;  // tokens, as Admission::Revoke told them
  Json replay = Json::object();      // of a recording: {"duration": s, "first_tick": n}
  // Scenarios that a page may choose, [{"name", "title"}, ...], and what is to be told of the last
  // choice, if anything.
  Json scenarios = Json::array();
  std::string notice;
  std::function<void(const std::string&)> tell;  // what the console is told unasked; may be empty
  std::vector<std::string> origins;              // beside the server's own, for Foxglove alone
};

// Whether `header` (a Host, with or without a port) names one of `hosts`.
bool IsOwnHost(std::string_view header, const std::vector<std::string>& hosts);
// Whether an Origin is that of a page which this server gave out under `host`. Browsers always tell
// it with a WebSocket; what tells none is no page.
bool IsOwnOrigin(std::string_view origin, std::string_view host, bool tls);

class ViewerApp : public Application {
 public:
  // `board` and `mailbox` are borrowed.
  ViewerApp(AppSetup setup, const Scenario& scenario, const Vector3& object_start,
            const RunBoard* board, RunMailbox* mailbox, MonotonicClock clock);
  ~ViewerApp() override;

  HttpReply Get(const HttpRequest& request) override;
  UpgradeReply Upgrade(const HttpRequest& request) override;
  // Shows the newest record, if there is a new one.
  void Tick() override;

  // The run has ended for good: everybody gets its last state and the sentence, and is let go.
  void EndRun(const std::string& text);
  bool ended() const { return ended_; }

  Admission& admission() { return admission_; }
  Hub& hub() { return *hub_; }
  Foxglove& foxglove() { return *foxglove_; }

 private:
  HttpReply Refusal(const HttpRequest& request) const;
  UpgradeReply UpgradePage(const HttpRequest& request);
  UpgradeReply UpgradeFoxglove(const HttpRequest& request, std::string_view query);
  Peaks PeaksOf(std::uint64_t first, std::uint64_t end) const;
  void TellOfReset(const TickRecord& record);
  void TellOfWarnings(const TickRecord& record);

  AppSetup setup_;
  Scenario scenario_;
  AssetStore assets_;
  Admission admission_;
  const RunBoard* board_;
  MonotonicClock clock_;
  std::unique_ptr<Hub> hub_;
  std::unique_ptr<Foxglove> foxglove_;
  RunState state_ = RunState::kInit;
  std::array<std::uint8_t, kHands> warnings_ = {};  // as told
  std::uint64_t warned_ = 0;                        // tick
  bool ended_ = false;
  std::uint64_t shown_ = 0;  // records written when one was last shown
};

// The monotonic clock, as in TickRecord::wall_ns [ns].
std::uint64_t MonotonicNow();

}  // namespace predictor
