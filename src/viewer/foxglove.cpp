#include "viewer/foxglove.h"

#include <algorithm>
#include <chrono>
#include <map>

#include "viewer/rate_limit.h"

namespace predictor::viewer {
namespace {

constexpr double kClientRate = 100;  // messages per client and second
constexpr std::uint8_t kMessageData = 1;

// The format is 01 | u32 subscription | u64 log time | payload.
std::string DataMessage(std::uint32_t subscription, std::uint64_t time_ns,
                        const std::string& payload) {
  std::string message(1, static_cast<char>(kMessageData));
  for (int shift = 0; shift < 32; shift += 8) message += static_cast<char>(subscription >> shift);
  for (int shift = 0; shift < 64; shift += 8) message += static_cast<char>(time_ns >> shift);
  return message + payload;
}

std::uint64_t UnixNow() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                        std::chrono::system_clock::now().time_since_epoch())
                                        .count());
}

// Returns a 32-bit number, or no value if the JSON value is not a 32-bit number.
std::optional<std::uint32_t> Id(const Json& value) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > UINT32_MAX) return {};
  return value.get<std::uint32_t>();
}

}  // namespace

class Foxglove::Client : public Session {
 public:
  Client(Foxglove* foxglove, Connection* connection)
      : foxglove_(foxglove), connection_(connection) {
    foxglove_->clients_.push_back(this);
    connection_->Admitted();
    connection_->SendText(Json{{"op", "serverInfo"},
                               {"name", "PREDICTOR"},
                               {"capabilities", Json::array()},
                               {"metadata", Json::object()},
                               {"sessionId", std::to_string(foxglove_->to_unix_ns_)}}
                              .dump());
    connection_->SendText(Advertisement());
  }
  ~Client() override { std::erase(foxglove_->clients_, this); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void OnText(std::string_view text) override {
    if (!messages_.Take(foxglove_->clock_()))
      return connection_->Close(CloseCode::kRefused, "Too many messages.");
    const Json message = Json::parse(text, nullptr, false);
    const auto op = message.is_object() ? message.find("op") : message.end();
    if (!message.is_object() || op == message.end() || !op->is_string())
      return connection_->Close(CloseCode::kNotUnderstood, "This message is not supported.");
    if (*op == "subscribe")
      Subscribe(message);
    else if (*op == "unsubscribe")
      Unsubscribe(message);
    else
      Warn("This server supports only subscribe and unsubscribe.");
  }
  void OnBinary() override { Warn("This server does not accept data."); }
  void OnControlFrame() override {
    if (!messages_.Take(foxglove_->clock_()))
      connection_->Close(CloseCode::kRefused, "Too many messages.");
  }

  void ThrowOut() {
    connection_->Close(CloseCode::kRefused, "The connection was ended from the console.");
  }
  void SayGoodbye(const std::string& text) {
    Warn(text.c_str());
    connection_->Close(CloseCode::kGoingAway, "The run has ended.");
  }

  bool Wants(std::uint32_t channel) const {
    return std::any_of(subscriptions_.begin(), subscriptions_.end(),
                       [channel](const auto& s) { return s.second == channel; });
  }
  void Send(std::uint32_t channel, std::uint64_t time_ns, const std::string& payload) {
    for (const auto& [subscription, wanted] : subscriptions_)
      if (wanted == channel)
        connection_->SendNewest(
            subscription, MessageKind::kBinary,
            std::make_shared<const std::string>(DataMessage(subscription, time_ns, payload)));
  }

 private:
  std::string Advertisement() const {
    Json channels = Json::array();
    for (const FoxgloveChannel& channel : foxglove_->channels_)
      channels.push_back({{"id", channels.size() + 1},
                          {"topic", channel.topic},
                          {"encoding", "json"},
                          {"schemaName", channel.schema_name},
                          {"schemaEncoding", "jsonschema"},
                          {"schema", channel.schema.dump()}});
    return Json{{"op", "advertise"}, {"channels", channels}}.dump();
  }
  void Warn(const char* text) {
    connection_->SendText(Json{{"op", "status"}, {"level", 1}, {"message", text}}.dump());
  }

  void Subscribe(const Json& message) {
    const auto list = message.find("subscriptions");
    if (list == message.end() || !list->is_array()) return Warn("subscribe needs subscriptions.");
    for (const Json& entry : *list) {
      const auto id = entry.is_object() ? Id(entry.value("id", Json())) : std::nullopt;
      const auto channel = entry.is_object() ? Id(entry.value("channelId", Json())) : std::nullopt;
      if (!id || !channel || *channel == 0 || *channel > foxglove_->channels_.size())
        Warn("This channel does not exist.");
      else if (subscriptions_.size() >= kMaxSubscriptions)
        Warn("Too many subscriptions.");
      else if (!subscriptions_.emplace(*id, *channel).second)
        Warn("This subscription ID is already in use.");
    }
  }
  void Unsubscribe(const Json& message) {
    const auto list = message.find("subscriptionIds");
    if (list == message.end() || !list->is_array())
      return Warn("unsubscribe needs subscriptionIds.");
    for (const Json& entry : *list)
      if (const auto id = Id(entry)) subscriptions_.erase(*id);
  }

  Foxglove* foxglove_;
  Connection* connection_;
  std::map<std::uint32_t, std::uint32_t> subscriptions_;  // id -> channel
  RateLimit messages_{kClientRate};
};

Foxglove::Foxglove(const Scenario& scenario, const Vector3& object_start, MonotonicClock clock)
    : channels_(FoxgloveChannels(scenario, object_start)),
      clock_(std::move(clock)),
      to_unix_ns_(UnixNow() - clock_()) {}

Foxglove::~Foxglove() = default;

std::string Foxglove::Choose(const std::vector<std::string>& offered) {
  for (const std::string& name : offered)
    if (name == "foxglove.sdk.v1" || name == "foxglove.websocket.v1") return name;
  return {};
}

std::unique_ptr<Session> Foxglove::Open(Connection* connection) {
  return std::make_unique<Client>(this, connection);
}

std::size_t Foxglove::Kick() {
  for (Client* client : clients_) client->ThrowOut();
  return clients_.size();
}

void Foxglove::EndRun(const std::string& text) {
  for (Client* client : clients_) client->SayGoodbye(text);
}

void Foxglove::Publish(const TickRecord& record) {
  const std::uint64_t now = clock_();
  if (clients_.empty() || now - last_ns_ < kPeriod) return;
  last_ns_ = now;
  const std::uint64_t time = (record.wall_ns != 0 ? record.wall_ns : now) + to_unix_ns_;
  for (std::uint32_t id = 1; id <= channels_.size(); ++id) {
    const auto wants = [id](const Client* client) { return client->Wants(id); };
    if (std::none_of(clients_.begin(), clients_.end(), wants)) continue;
    const std::string payload = channels_[id - 1].message(record, time).dump();
    for (Client* client : clients_) client->Send(id, time, payload);
  }
}

}  // namespace predictor::viewer
