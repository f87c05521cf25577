// What the transport (viewer/server.cpp) and what is said over it know of one another. Everything
// happens in the server's one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace predictor {

// Close codes of a WebSocket.
enum class CloseCode : std::uint16_t {
  kNormal = 1000,
  kGoingAway = 1001,
  kNotUnderstood = 1003,
  kRefused = 1008,
  kTooLarge = 1009,
  kTryLater = 1013,
};

enum class MessageKind : std::uint8_t { kText, kBinary };

// One WebSocket, as whoever talks over it sees it. Nothing waits.
class Connection {
 public:
  virtual ~Connection() = default;
  // Sent in order, before anything newest. Whoever lets too much of it pile up is cut off.
  virtual void SendText(std::string text) = 0;
  // A message that takes the place of one of the same slot that was not sent yet. A client
  // that does not read gets none until it does: it never finds more than a third of a second of
  // them waiting.
  virtual void SendNewest(std::uint32_t slot, MessageKind kind,
                          std::shared_ptr<const std::string> message) = 0;
  // Sends what is left, then closes. The session hears nothing more.
  virtual void Close(CloseCode code, std::string reason) = 0;
  // The client was let in: it is no longer cut off to make room for others.
  virtual void Admitted() = 0;
};

// What is said over one WebSocket. Destroyed when the connection has ended.
class Session {
 public:
  virtual ~Session() = default;
  virtual void OnText(std::string_view text) = 0;
  virtual void OnBinary() = 0;
  virtual void OnControlFrame() = 0;  // a ping or pong came
};

// A request's head. Empty: was not there.
struct HttpRequest {
  std::string method, target, host, origin, authorization;
  std::vector<std::string> subprotocols;
};

struct HttpReply {
  unsigned status = 200;
  std::string type;
  std::string_view body;  // lives as long as the application
};

// An answer to the wish to become a WebSocket.
struct UpgradeReply {
  HttpReply refusal;  // counts if `open` is empty
  std::string subprotocol;
  std::size_t longest_message = 1024;  // [bytes]
  std::function<std::unique_ptr<Session>(Connection*)> open;
};

class Application {
 public:
  virtual ~Application() = default;
  virtual HttpReply Get(const HttpRequest& request) = 0;
  virtual UpgradeReply Upgrade(const HttpRequest& request) = 0;
  virtual void Tick() = 0;  // at a steady rate
};

}  // namespace predictor
