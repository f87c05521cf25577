// The interface between the transport (viewer/server.cpp) and the application. Everything runs in
// the server's single thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace predictor::viewer {

// WebSocket close codes.
enum class CloseCode : std::uint16_t {
  kNormal = 1000,
  kGoingAway = 1001,
  kNotUnderstood = 1003,
  kRefused = 1008,
  kTooLarge = 1009,
  kTryLater = 1013,
};

enum class MessageKind : std::uint8_t { kText, kBinary };

// One WebSocket, as seen by the application. No function blocks.
class Connection {
 public:
  virtual ~Connection() = default;
  // Sends texts in order. Texts precede the messages of SendNewest. A client with too much unsent
  // text is disconnected.
  virtual void SendText(std::string text) = 0;
  // Sends a message that replaces an unsent message of the same slot. A client that does not read
  // gets no such messages until it reads again. The waiting messages therefore never cover more
  // than a third of a second.
  virtual void SendNewest(std::uint32_t slot, MessageKind kind,
                          std::shared_ptr<const std::string> message) = 0;
  // Sends the remaining messages, and then closes the connection. After this call, the session
  // receives no further calls.
  virtual void Close(CloseCode code, std::string reason) = 0;
  // The application calls this function when the client has been admitted. From then on, the server
  // does not disconnect this client to make room for others.
  virtual void Admitted() = 0;
  virtual std::string peer() const = 0;  // numeric address of the peer
};

// The application's side of one WebSocket. The session is destroyed when the connection has ended.
class Session {
 public:
  virtual ~Session() = default;
  virtual void OnText(std::string_view text) = 0;
  virtual void OnBinary() = 0;
  virtual void OnControlFrame() = 0;  // a ping or pong was received
};

// The head of a request. A field is empty if the request does not contain it.
struct HttpRequest {
  std::string method, target, host, origin, authorization;
  std::vector<std::string> subprotocols;
  std::size_t host_count = 0;  // number of Host headers; `host` is the first
  std::uint16_t port = 0;      // port on which the request was received
};

struct HttpReply {
  unsigned status = 200;
  std::string type;
  std::string_view body;  // valid for the application's lifetime
};

// The answer to a WebSocket upgrade request.
struct UpgradeReply {
  HttpReply refusal;  // used if `open` is empty
  std::string subprotocol;
  std::size_t longest_message = 1024;  // [bytes]
  std::function<std::unique_ptr<Session>(Connection*)> open;
};

class Application {
 public:
  virtual ~Application() = default;
  virtual HttpReply Get(const HttpRequest& request) = 0;
  virtual UpgradeReply Upgrade(const HttpRequest& request) = 0;
  virtual void Tick() = 0;  // called at a constant rate
};

}  // namespace predictor::viewer
