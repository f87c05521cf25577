#include "viewer/hub.h"

#include <algorithm>
#include <utility>

#include "core/choice.h"
#include "viewer/rate_limit.h"

namespace predictor::viewer {
namespace {

constexpr double kMessageRate = 200;  // messages per second and client
constexpr double kFloodRate = 2000;   // more than a well-behaved page sends
constexpr double kHandRate = 90;      // messages per second and hand
constexpr double kPingRate = 10;
constexpr double kDenialRate = 5;
constexpr double kLatencyRate = 2;
constexpr double kMarkRate = 2;
constexpr double kHeadRate = 12;  // rate at which a headset's pose is forwarded to the other pages
constexpr double kMeasuredHeadRate = 60;  // rate at which a head is recorded and evaluated
// Slots of the states of the run and of the person. The slot of a head's message is the number of
// its client.
constexpr std::uint32_t kStates = 0, kPerson = ~0U;

}  // namespace

class Hub::Client : public Session {
 public:
  Client(Hub* hub, Connection* connection)
      : hub_(hub), connection_(connection), since_ns_(hub->clock_()) {
    hub_->sessions_.push_back(this);
  }
  ~Client() override {
    std::erase(hub_->sessions_, this);
    if (!admitted()) return;
    hub_->leases_.Leave(id_, token_);
    for (Headset& headset : hub_->headsets_)
      if (headset.client == id_ && headset.gone_ns == 0) headset.gone_ns = hub_->clock_();
    hub_->SendLeases();
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  bool admitted() const { return id_ != 0; }
  bool silent() const { return hub_->clock_() - heard_ns_ > kSilent; }
  void RenewToken() {
    if (ended_) return;
    token_ = hub_->admission_->IssueToken(role_);
    connection_->SendText(TokenText(token_));
  }
  std::uint32_t id() const { return id_; }
  const std::string& token() const { return token_; }
  ClientStatus Status() const;
  Connection* connection() { return connection_; }

  void OnText(std::string_view text) override;
  void SendEvents() {
    if (experimenter_) connection_->SendText(hub_->events_);
  }
  void SayGoodbye() {
    connection_->SendText(EndedText(hub_->how_ended_, hub_->results_follow_));
    End(CloseCode::kGoingAway, "The run has ended.");
  }
  void ThrowOut() { Refuse(CloseCode::kRefused, "The connection was ended from the console."); }
  void OnBinary() override { End(CloseCode::kNotUnderstood, "Binary messages are not supported."); }
  void OnControlFrame() override {
    if (!flood_.Take(hub_->clock_())) End(CloseCode::kRefused, "Too many messages.");
  }
  void ExpireHello(std::uint64_t now_ns) {
    if (!admitted() && now_ns - since_ns_ > kHelloTime)
      End(CloseCode::kRefused, "No hello message arrived within five seconds.");
  }

 private:
  void End(CloseCode code, const char* reason) {
    if (std::exchange(ended_, true)) return;
    connection_->Close(code, reason);
  }
  void Refuse(CloseCode code, const char* reason) {
    connection_->SendText(RefusedText(reason));
    End(code, reason);
  }
  void Deny(const char* what, const std::string& reason) {
    if (denials_.Take(hub_->clock_())) connection_->SendText(DeniedText(what, reason));
  }
  std::string Welcome() const;
  void Admit(const HelloRequest& hello);
  void Put(const char* what, RunInput input) {
    input.client = id_;
    if (!hub_->mailbox_->inputs.Push(input)) Deny(what, "The run does not accept inputs now.");
  }
  // Returns whether this client has control. A client without control gets a hint.
  bool Commands(const char* what);

  void On(const HelloRequest&) {
    End(CloseCode::kNotUnderstood, "A second hello message arrived.");
  }
  void On(const HeartbeatRequest&) { hub_->leases_.Heartbeat(id_, hub_->clock_()); }
  void On(const LeaseRequest& request);
  // A stop request never waits, because it has its own counter in addition to the queue of inputs.
  void On(const StopRequest&) {
    hub_->mailbox_->stop_client.store(id_, std::memory_order_relaxed);
    hub_->mailbox_->stops.fetch_add(1, std::memory_order_release);
  }
  void On(const ExperimenterRequest&);
  void On(const CommandRequest& request);
  void On(const ParameterRequest& request);
  void On(const ScenarioRequest& request);
  void On(const MarkRequest&) {
    if (!marks_.Take(hub_->clock_())) return;
    RunInput input;
    input.kind = InputKind::kMarker;
    Put("mark", input);
  }
  void On(const ReplayRequest& request);
  void On(const HandRequest& request);
  void On(const PingRequest& request) {
    const std::uint64_t now = hub_->clock_();
    if (pings_.Take(now)) connection_->SendText(PongText(request.page_ms, now));
  }
  void On(const LatencyRequest& request);
  void On(const ImmersiveRequest& request) {
    experimenter_ = experimenter_ && !request.active;  // the wearer is the subject
    hub_->See(id_, request);
    if (role_ == Role::kLook) return;
    const std::uint64_t now = hub_->clock_();
    if (request.active ? request.has_head && heads_.Take(now) : goodbyes_.Take(now))
      hub_->ShowHead(id_, request);
    if (measured_.Take(now)) hub_->MeasureHead(id_, request);
  }

  Hub* hub_;
  Connection* connection_;
  std::uint64_t since_ns_;
  std::uint64_t heard_ns_ = 0;
  std::uint32_t id_ = 0;  // 0: not admitted
  Role role_ = Role::kLook;
  std::string token_;
  bool ended_ = false;
  bool experimenter_ = false;
  LatencyRequest latency_;
  RateLimit messages_{kMessageRate}, flood_{kFloodRate}, pings_{kPingRate}, denials_{kDenialRate},
      latencies_{kLatencyRate}, heads_{kHeadRate}, goodbyes_{kHeadRate},
      measured_{kMeasuredHeadRate}, marks_{kMarkRate};
  std::array<RateLimit, kHands> hands_ = {RateLimit(kHandRate), RateLimit(kHandRate)};
};

void Hub::Client::OnText(std::string_view text) {
  if (ended_) return;
  const std::uint64_t now = hub_->clock_();
  heard_ns_ = now;
  hub_->ExpireLeases();
  const std::optional<PageRequest> request = ParsePageRequest(text);
  if (!request) return End(CloseCode::kNotUnderstood, "This message is not supported.");
  if (!admitted()) {
    if (const auto* hello = std::get_if<HelloRequest>(&*request)) return Admit(*hello);
    return End(CloseCode::kRefused, "The first message must be hello.");
  }
  // A stop takes effect before any limit, even if the client is about to be disconnected.
  if (const auto* stop = std::get_if<StopRequest>(&*request)) On(*stop);
  if (!flood_.Take(now)) return End(CloseCode::kRefused, "Too many messages.");
  if (std::holds_alternative<StopRequest>(*request) || !messages_.Take(now)) return;
  std::visit([this](const auto& it) { On(it); }, *request);
}

void Hub::Client::Admit(const HelloRequest& hello) {
  // This disconnection is not a refusal of the client, because the client's token stays valid.
  if (hub_->clients() >= kMaxClients)
    return End(CloseCode::kTryLater, "64 clients are connected already.");
  Admission& admission = *hub_->admission_;
  std::optional<Admission::Grant> grant;
  switch (hello.kind) {
    case HelloRequest::Kind::kCode:
      grant = admission.ByCode(hello.secret);
      break;
    case HelloRequest::Kind::kPin:
      grant = admission.ByPin(hello.secret, connection_->peer(), hub_->clock_());
      break;
    case HelloRequest::Kind::kToken:
      grant = admission.ByToken(hello.secret);
      break;
  }
  if (!grant)
    return Refuse(CloseCode::kRefused,
                  "This code is wrong, already used or expired. Request a new one.");
  if (const char* why = hub_->NoSeatFor(*grant)) return End(CloseCode::kTryLater, why);
  id_ = ++hub_->last_client_;
  role_ = grant->role;
  token_ = grant->token;
  connection_->Admitted();
  // A client that lost its connection may reconnect before the server detects the loss.
  for (const Client* other : hub_->sessions_)
    if (other != this && other->token() == token_ && other->silent())
      hub_->leases_.Leave(other->id(), token_);
  hub_->leases_.Return(id_, token_, hub_->clock_());
  connection_->SendText(Welcome());
  hub_->SendLeases();
  if (hub_->frame_) connection_->SendNewest(kStates, MessageKind::kBinary, hub_->frame_);
  if (hub_->person_) connection_->SendNewest(kPerson, MessageKind::kText, hub_->person_);
  if (hub_->ended()) SayGoodbye();
}

std::string Hub::Client::Welcome() const {
  return Json{{"type", "welcome"},
              {"client", id_},
              {"role", Name(role_)},
              {"token", token_},
              {"server", hub_->server_id_},
              {"server_ns", hub_->clock_()},
              {"leases", LeasesJson(hub_->leases_, hub_->clients())},
              {"features", {"headset", "person"}},
              {"scene", hub_->setup_.scene},
              {"frame", FrameJson()}}
      .dump();
}

bool Hub::Client::Commands(const char* what) {
  if (hub_->setup_.replay != (std::string_view(what) == "replay")) {
    Deny(what, hub_->setup_.replay ? "This is a recording, which can only be viewed."
                                   : "This is a run; only a recording can be played.");
    return false;
  }
  if (hub_->leases_.Holds(LeaseKind::kControl, id_)) return true;
  Deny(what, "Take control first.");
  return false;
}

void Hub::Client::On(const LeaseRequest& request) {
  Leases& leases = hub_->leases_;
  if (!request.take) {
    if (leases.Release(request.what, id_)) hub_->SendLeases();
    return;
  }
  if (!Leases::MayHold(role_, request.what))
    return Deny("lease", std::string("The role ") + Name(role_) + " does not allow this.");
  if (experimenter_ && request.what == LeaseKind::kOperator)
    return Deny("lease",
                "This page shows the events to come. To move the hands, open the page without "
                "/experimenter.");
  const std::uint32_t before = leases.Holder(request.what);
  if (!leases.Take(request.what, id_, hub_->clock_()))
    return Deny("lease", "Client " + std::to_string(before) + " holds this lease.");
  if (before != id_) hub_->SendLeases();
}

// Only this request lets a page receive events that have not begun. A subject must not see future
// events.
void Hub::Client::On(const ExperimenterRequest&) {
  if (hub_->events_.empty())
    return Deny("experimenter", "There are no events to come: this run has ended.");
  if (role_ != Role::kControl)
    return Deny("experimenter", std::string("The role ") + Name(role_) +
                                    " may not see the events to come. Get a pin with the role "
                                    "control from the console.");
  if (hub_->leases_.Holds(LeaseKind::kOperator, id_) || Status().headset)
    return Deny("experimenter",
                "A client that moves the hands or wears a headset may not see the events to come.");
  experimenter_ = true;
  SendEvents();
}

void Hub::Client::On(const CommandRequest& request) {
  if (!Commands("command")) return;
  if (!hub_->setup_.rules.remote_start)
    return Deny("command",
                "With real arms, do this at the console while holding the enabling key or device.");
  RunInput input;
  input.kind = request.command;
  if (input.kind == InputKind::kStop) input.value = kEndAsPlanned;
  Put("command", input);
}

void Hub::Client::On(const ParameterRequest& request) {
  if (!Commands("parameter")) return;
  const ParameterRange& range = hub_->setup_.ranges[static_cast<std::size_t>(request.parameter)];
  if (!(request.value >= range.min && request.value <= range.max))
    return Deny("parameter", "This value is outside the range that is allowed during a run.");
  RunInput input;
  input.kind = InputKind::kParameter;
  input.parameter = request.parameter;
  input.value = request.value;
  Put("parameter", input);
}

void Hub::Client::On(const ScenarioRequest& request) {
  if (!Commands("scenario")) return;
  if (!hub_->setup_.rules.may_switch_scenario)
    return Deny("scenario",
                "With real arms, another scenario needs a new run. End this run first.");
  if (!MayChooseScenario(hub_->state_))
    return Deny("scenario", "End or stop this run first, then choose a scenario.");
  const auto& names = hub_->setup_.scenarios;
  const auto found = std::find(names.begin(), names.end(), request.name);
  if (found == names.end()) return Deny("scenario", "This scenario does not exist.");
  RunInput input;
  input.kind = InputKind::kScenario;
  input.value = static_cast<double>(found - names.begin());
  Put("scenario", input);
}

void Hub::Client::On(const ReplayRequest& request) {
  if (!Commands("replay")) return;
  RunInput input;
  input.kind = request.what;
  input.value = request.value;
  Put("replay", input);
}

void Hub::Client::On(const HandRequest& request) {
  const std::uint64_t now = hub_->clock_();
  if (!hub_->setup_.browser_operator)
    return Deny("hand",
                "In this scenario, a page cannot be the operator. Set operator.type: browser.");
  if (!hub_->leases_.Holds(LeaseKind::kOperator, id_))
    return Deny("hand", "Take the operator's hands first.");
  if (!hub_->setup_.present.Has(request.hand)) return Deny("hand", "This handle does not exist.");
  if (!hands_[request.hand].Take(now)) return;
  RunInput input;
  input.kind = InputKind::kHand;
  input.hand = request.hand;
  input.grip = request.grip;
  input.p = request.p;
  input.q = request.q;
  Put("hand", input);
}

// If the run takes no inputs, the hub drops the request, because nothing depends on it.
void Hub::Client::On(const LatencyRequest& request) {
  latency_ = request;
  if (!latencies_.Take(hub_->clock_())) return;
  RunInput input;
  input.kind = InputKind::kLatency;
  input.client = id_;
  input.p = {request.offset_ms, request.received_ms, request.rendered_ms};
  hub_->mailbox_->inputs.Push(input);
}

ClientStatus Hub::Client::Status() const {
  ClientStatus status{id_, role_, {}, false, experimenter_, latency_};
  for (const LeaseKind kind : {LeaseKind::kControl, LeaseKind::kOperator})
    status.holds[static_cast<std::size_t>(kind)] = hub_->leases_.Holds(kind, id_);
  for (const Headset& headset : hub_->headsets_)
    status.headset |= headset.client == id_ && headset.gone_ns == 0;
  return status;
}

// ---- the hub ------------------------------------------------------------------------------------

Hub::Hub(HubSetup setup, Admission* admission, RunMailbox* mailbox, MonotonicClock clock)
    : setup_(std::move(setup)),
      admission_(admission),
      mailbox_(mailbox),
      clock_(std::move(clock)),
      server_id_(RandomText(16)),
      last_client_(setup_.last_client) {
  mailbox_->clients.store(0, std::memory_order_relaxed);  // clears the count of an earlier hub
}

Hub::~Hub() = default;

std::unique_ptr<Session> Hub::Open(Connection* connection) {
  return std::make_unique<Client>(this, connection);
}

std::size_t Hub::clients() const {
  return static_cast<std::size_t>(std::count_if(sessions_.begin(), sessions_.end(),
                                                [](const Client* c) { return c->admitted(); }));
}

std::vector<ClientStatus> Hub::Status() const {
  std::vector<ClientStatus> list;
  for (const Client* client : sessions_)
    if (client->admitted()) list.push_back(client->Status());
  return list;
}

void Hub::Publish(std::shared_ptr<const std::string> frame, RunState state) {
  frame_ = std::move(frame);
  state_ = state;
  for (Client* client : sessions_)
    if (client->admitted()) client->connection()->SendNewest(kStates, MessageKind::kBinary, frame_);
}

void Hub::PublishPerson(std::shared_ptr<const std::string> text) {
  person_ = std::move(text);
  for (Client* client : sessions_)
    if (client->admitted()) client->connection()->SendNewest(kPerson, MessageKind::kText, person_);
}

void Hub::PublishEvents(const std::string& text) {
  if (events_ == text) return;
  events_ = text;
  for (Client* client : sessions_)
    if (client->admitted()) client->SendEvents();
}

void Hub::ChangeScene(const char* key, const Json& value) {
  Json& present = setup_.scene[key];
  if (present == value) return;
  present = value;
  SendToAll(SceneText(key, value));
}

void Hub::Tick() {
  const std::uint64_t now = clock_();
  for (Client* client : sessions_) client->ExpireHello(now);
  ExpireLeases();
  PublishHeadsets();
}

// Returns why no seat is available, or null. A single client cannot occupy all seats, and the
// clients that only look cannot occupy all seats together.
const char* Hub::NoSeatFor(const Admission::Grant& grant) const {
  const auto same = [&](const Client* c) { return c->admitted() && c->token() == grant.token; };
  if (static_cast<std::size_t>(std::count_if(sessions_.begin(), sessions_.end(), same)) >=
      kMaxClientsPerToken)
    return "Eight pages are already connected with this token.";
  if (grant.role == Role::kLook && clients() >= kMaxClients - kKeptSeats)
    return "The remaining connections are reserved for clients that can do more than look.";
  return nullptr;
}

void Hub::Revoke(LeaseKind kind) {
  leases_.Revoke(kind);
  SendLeases();
}

void Hub::ThrowOut(Client* client) {
  for (const LeaseKind kind : {LeaseKind::kControl, LeaseKind::kOperator})
    if (leases_.Holds(kind, client->id())) leases_.Revoke(kind);
  client->ThrowOut();
}

bool Hub::Kick(std::uint32_t client, const Generations& generations) {
  const auto found = std::find_if(sessions_.begin(), sessions_.end(), [client](const Client* c) {
    return c->admitted() && c->id() == client;
  });
  if (found != sessions_.end()) {
    const std::string token = (*found)->token();
    for (Client* each : sessions_)
      if (each->admitted() && each->token() == token) ThrowOut(each);
  }
  SendLeases();
  admission_->Renew(generations);
  for (Client* each : sessions_)
    if (each->admitted()) each->RenewToken();
  return found != sessions_.end();
}

void Hub::KickAll(const Generations& generations) {
  admission_->Renew(generations);
  for (Client* each : sessions_)
    if (each->admitted()) ThrowOut(each);
  SendLeases();
}

void Hub::Notify(const std::string& text) { SendToAll(NoticeText(text)); }

void Hub::EndRun(const std::string& text, bool results_follow) {
  how_ended_ = text;
  results_follow_ = results_follow;
  for (Client* client : sessions_)
    if (client->admitted()) client->SayGoodbye();
}

void Hub::SendToAll(const std::string& text) {
  for (Client* client : sessions_)
    if (client->admitted()) client->connection()->SendText(text);
}

void Hub::SendLeases() {
  mailbox_->clients.store(static_cast<std::uint32_t>(clients()), std::memory_order_relaxed);
  SendToAll(LeasesText(leases_, clients()));
}

// This function must be called before any query of the leases. Notifies a client that lost a lease
// because it was silent, and the clients that may now take this lease.
void Hub::ExpireLeases() {
  if (leases_.Expire(clock_())) SendLeases();
}

// Lets an experimenter's page show the view of the headset's wearer.
void Hub::ShowHead(std::uint32_t client, const ImmersiveRequest& request) {
  const auto text = std::make_shared<const std::string>(HeadsetText(client, request));
  for (Client* other : sessions_)
    if (other->admitted() && other->id() != client)
      other->connection()->SendNewest(client, MessageKind::kText, text);
}

}  // namespace predictor::viewer
