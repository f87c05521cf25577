// Manages the connected pages, which includes their admission and leases, their inputs to the run,
// and the data that all pages receive. The hub uses no sockets, and the caller passes the time.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "core/status.h"
#include "scenario/operating_rules.h"
#include "viewer/connection.h"
#include "viewer/protocol.h"

namespace predictor::viewer {

using MonotonicClock = std::function<std::uint64_t()>;  // [ns]

struct HubSetup {
  Json scene;
  OperatingRules rules;           // rules of the run; a replay uses the defaults
  bool browser_operator = false;  // pages may act as operator
  Hands present = {true, true};
  std::array<ParameterRange, kParameters> ranges;
  std::vector<std::string> scenarios;  // names of the available scenarios
  bool replay = false;                 // this is a recording: only its playback can be controlled
  std::uint32_t last_client = 0;       // new clients get numbers above this one
};

// The data of a client that the console may show.
struct ClientStatus {
  std::uint32_t id = 0;
  Role role = Role::kLook;
  std::array<bool, kLeases> holds = {};
  bool headset = false;
  bool experimenter = false;  // receives the events to come
  LatencyRequest latency;     // delays that the client reported
};

class Hub {
 public:
  static constexpr std::size_t kMaxClients = 64;
  static constexpr std::size_t kMaxClientsPerToken = 8;
  static constexpr std::size_t kKeptSeats = 8;  // reserved for roles that may do more than look
  static constexpr std::uint64_t kSilent = 1'500'000'000;     // heartbeats come every second [ns]
  static constexpr std::uint64_t kHelloTime = 5'000'000'000;  // [ns]
  // Time after the page has disconnected [ns]
  static constexpr std::uint64_t kImmersiveLinger = 1'000'000'000;

  // Borrows `admission` and `mailbox`.
  Hub(HubSetup setup, Admission* admission, RunMailbox* mailbox, MonotonicClock clock);
  ~Hub();

  std::unique_ptr<Session> Open(Connection* connection);

  // Sends the newest state to all clients.
  void Publish(std::shared_ptr<const std::string> frame, RunState state);
  // Sends the newest state of the person, as text, to all clients.
  void PublishPerson(std::shared_ptr<const std::string> text);
  // Sends the message `events` to the experimenter's pages if it has changed. Until the first call,
  // no page may be an experimenter's page.
  void PublishEvents(const std::string& text);
  // Sends a changed entry of the scene to all clients. From now on, the scene contains this value.
  // Does nothing if the scene already contains it.
  void ChangeScene(const char* key, const Json& value);
  // Ends expired leases and waiting times. Call this at least ten times per second.
  void Tick();
  // The operator at the console uses this function to end a lease.
  void Revoke(LeaseKind kind);
  // Disconnects a client and all clients with the same token. Returns false if there is no such
  // client. Kick and KickAll begin the new generations (Admission::Renew) and give the remaining
  // clients new tokens.
  bool Kick(std::uint32_t client, const Generations& generations);
  // Disconnects all clients.
  void KickAll(const Generations& generations);
  // Sends a message to all clients.
  void Notify(const std::string& text);
  // Ends the run for the pages. All present and later clients get the newest state and a sentence
  // about how the run ended, and are disconnected. For `results_follow`, see EndedText.
  void EndRun(const std::string& text, bool results_follow);

  std::size_t clients() const;  // number of admitted clients
  std::vector<ClientStatus> Status() const;

 private:
  class Client;
  struct Headset {
    std::uint32_t client = 0;
    std::uint64_t frame_ns = 0;  // the older of the page's and the picture's last sign of life
    std::uint64_t gone_ns = 0;   // time at which the page or session ended; 0: not ended
  };

  const char* NoSeatFor(const Admission::Grant& grant) const;
  void SendToAll(const std::string& text);
  bool ended() const { return !how_ended_.empty(); }
  void SendLeases();
  void ExpireLeases();
  void ThrowOut(Client* client);
  void See(std::uint32_t client, const ImmersiveRequest& request);
  void ShowHead(std::uint32_t client, const ImmersiveRequest& request);
  void PublishHeadsets();
  void MeasureHead(std::uint32_t client, const ImmersiveRequest& request);

  HubSetup setup_;
  Admission* admission_;
  RunMailbox* mailbox_;
  MonotonicClock clock_;
  std::string server_id_;
  Leases leases_;
  std::vector<Client*> sessions_;  // including clients that are not admitted
  std::vector<Headset> headsets_;
  std::uint32_t last_client_ = 0;
  std::shared_ptr<const std::string> frame_, person_;
  RunState state_ = RunState::kInit;
  std::string events_;     // the last message `events`; only for the experimenter's pages
  std::string how_ended_;  // a sentence; empty: the run has not ended
  bool results_follow_ = false;
};

}  // namespace predictor::viewer
