// The application of a run's server. The application serves the page and the models by HTTP, and
// the data for pages and for Foxglove by WebSocket.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "core/words.h"
#include "viewer/admission.h"
#include "viewer/asset_store.h"
#include "viewer/connection.h"
#include "viewer/event_plan.h"
#include "viewer/foxglove.h"
#include "viewer/frame.h"
#include "viewer/hub.h"

namespace predictor::viewer {

struct AppSetup {
  std::vector<std::string> hosts;  // host names of this server, without port
  bool tls = false;                // pages are loaded by https:
  bool code_once = false;          // true for real arms
  std::string secret;              // NewAdmissionSecret()
  Generations generations;         // generations of the secret's tokens
  std::uint32_t last_client = 0;   // last client number of earlier processes
  Json replay = Json::object();    // for a recording: {"duration": s, "first_tick": n}
  // The scenarios that a page may choose, as [{"name", "title"}, ...], and a message about the last
  // choice, if there was one.
  Json scenarios = Json::array();
  std::string notice;
  Json results;        // results of a finished run (ViewerOptions::results); null during a run
  std::string report;  // report of that run, an HTML page; empty: no report
  std::function<void(const std::string&)> notify;  // shows messages at the console; may be empty
  std::vector<std::string> origins;                // additional origins, for Foxglove only
  const EvaluationBoard* states =
      nullptr;                 // states of the person; borrowed; null: the person is not judged
  std::string why_not_judged;  // shown if there are no states; a sentence
};

// Checks a request's Host header according to RFC 9112, section 3.2. The status is 400 if there is
// not exactly one Host, if the Host is not a name with or without a port, or if the port is not
// that of this server. The status is 421 if the Host names none of `hosts`, and 200 if it is valid.
HttpReply CheckHost(const HttpRequest& request, const std::vector<std::string>& hosts);
// Returns whether an Origin belongs to a page that this server delivered under `host`. Browsers
// always send an Origin with a WebSocket request. A client without an Origin is not a page.
bool IsOwnOrigin(std::string_view origin, std::string_view host, bool tls);

class ViewerApp : public Application {
 public:
  // `board` and `mailbox` must outlive this object.
  ViewerApp(AppSetup setup, const Scenario& scenario, const Vector3& object_start,
            const RunBoard* board, RunMailbox* mailbox, MonotonicClock clock);
  ~ViewerApp() override;

  HttpReply Get(const HttpRequest& request) override;
  UpgradeReply Upgrade(const HttpRequest& request) override;
  // Shows the newest record if it was not shown before.
  void Tick() override;

  // Sends the last state of the run and the text to all clients, and disconnects them.
  void EndRun(const std::string& text, bool results_follow);
  bool ended() const { return ended_; }

  Admission& admission() { return admission_; }
  Hub& hub() { return *hub_; }
  Foxglove& foxglove() { return *foxglove_; }

 private:
  UpgradeReply UpgradePage(const HttpRequest& request);
  UpgradeReply UpgradeFoxglove(const HttpRequest& request, std::string_view query);
  void ShowPerson();
  Peaks SeeRecords(std::uint64_t first, std::uint64_t end);
  void ShowEvents(const TickRecord& record);
  void ReportRefusal(const TickRecord& record);
  void ReportReset(const TickRecord& record);
  void ReportWarnings(const TickRecord& record);

  AppSetup setup_;
  Scenario scenario_;
  RefusalWords refusals_{scenario_.rate};
  EventPlan plan_{scenario_};
  bool plans_ = false;             // the run can still have events to come
  std::uint16_t events_ = 0;       // bits: events that acted when a record was last shown
  std::uint8_t latest_event_ = 0;  // as in that record
  AssetStore assets_;
  Admission admission_;
  const RunBoard* board_;
  MonotonicClock clock_;
  std::unique_ptr<Hub> hub_;
  std::unique_ptr<Foxglove> foxglove_;
  RunState state_ = RunState::kInit;
  std::array<std::uint8_t, kHands> warnings_ = {};  // warnings as last shown
  std::uint64_t warned_ = 0;                        // tick of the last warning
  bool ended_ = false;
  std::uint64_t shown_ = 0;         // number of records when one was last shown
  std::uint64_t shown_person_ = 0;  // number of the person's states when one was last shown
};

// Returns the monotonic clock, as in TickRecord::wall_ns [ns].
std::uint64_t MonotonicNow();

}  // namespace predictor::viewer
