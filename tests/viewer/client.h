// A client for tests: plain sockets, so that what is sent is exactly what the test says.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace predictor::testing_client {

// What may lie between a socket and its bytes, such as TLS. Like send and recv.
class Transport {
 public:
  virtual ~Transport() = default;
  virtual long Write(const char* bytes, std::size_t n) = 0;
  virtual long Read(char* bytes, std::size_t n) = 0;
};

// A TCP connection to a port of the loopback address. Every read gives up after ten seconds.
class Socket {
 public:
  // source: the address that it comes from; nullptr: any.
  explicit Socket(std::uint16_t port, int receive_buffer = 0, const char* source = nullptr);
  ~Socket();
  Socket(Socket&& other) noexcept;
  Socket(const Socket&) = delete;

  bool Send(const std::string& bytes);    // false if the connection is gone
  std::string Receive(std::size_t most);  // "" at the end, or after ten seconds
  std::string ReceiveAll();               // until the end
  bool Ended();                           // waits for the end
  int descriptor() const { return descriptor_; }
  void Secure(std::shared_ptr<Transport> transport) { transport_ = std::move(transport); }

 private:
  int descriptor_ = -1;
  std::shared_ptr<Transport> transport_;
};

struct Answer {
  int status = 0;
  std::string head, body;
};
// One request on a connection of its own; `head` holds more header lines, each with \r\n.
Answer Get(std::uint16_t port, const std::string& target, const std::string& head = "",
           const std::string& method = "GET", const std::string& host = "");
Answer ParseAnswer(const std::string& bytes);

struct Message {
  int opcode = 0;  // 1 text, 2 binary, 8 close, 9 ping, 10 pong
  std::string payload;
  int close_code() const;
};

// A WebSocket. Pings are answered while messages are read.
class WebSocket {
 public:
  // head: more header lines. After a refusal, status() is not 101.
  WebSocket(std::uint16_t port, const std::string& target = "/ws",
            const std::string& subprotocol = "predictor.v1", const std::string& head = "",
            int receive_buffer = 0);
  WebSocket(Socket socket, std::uint16_t port, const std::string& target = "/ws",
            const std::string& subprotocol = "predictor.v1", const std::string& head = "");

  int status() const { return answer_.status; }
  const Answer& answer() const { return answer_; }
  bool SendText(const std::string& text) { return SendFrame(1, text); }
  bool SendFrame(int opcode, const std::string& payload, bool final = true);
  bool SendRaw(const std::string& bytes) { return socket_.Send(bytes); }
  // The next message that is no ping; nothing at the end.
  std::optional<Message> Next();
  // The next text message whose "type" is `type` (as text), passing over all else.
  std::optional<std::string> NextText(const std::string& type);
  // The code of the close frame that comes in the end; 0 if the connection just ends.
  int CloseCode();
  // Says hello with `code` and awaits the welcome; "" if there is none.
  std::string Hello(const std::string& code);
  Socket& socket() { return socket_; }

 private:
  std::optional<Message> ReadFrame();
  bool Fill(std::size_t bytes);

  Socket socket_;
  Answer answer_;
  std::string buffer_;
};

}  // namespace predictor::testing_client
