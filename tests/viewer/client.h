// A client for tests that uses plain sockets, so that it sends exactly the bytes that a test
// specifies.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace predictor::testing_client {

// An optional layer between a socket and its bytes, such as TLS. The functions of this layer
// correspond to send and recv.
class Transport {
 public:
  virtual ~Transport() = default;
  virtual long Write(const char* bytes, std::size_t n) = 0;
  virtual long Read(char* bytes, std::size_t n) = 0;
};

// A TCP connection to a port of the loopback address. Each read fails after ten seconds.
class Socket {
 public:
  // `source` is the local address of the connection, or nullptr for any address.
  explicit Socket(std::uint16_t port, int receive_buffer = 0, const char* source = nullptr);
  ~Socket();
  Socket(Socket&& other) noexcept;
  Socket(const Socket&) = delete;

  bool Send(const std::string& bytes);    // false if the connection is lost
  std::string Receive(std::size_t most);  // "" at the end of the connection or after ten seconds
  std::string ReceiveAll();               // reads to the end of the connection
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
// Sends one request on a separate connection. `head` contains additional header lines, each ending
// in \r\n.
Answer Get(std::uint16_t port, const std::string& target, const std::string& head = "",
           const std::string& method = "GET", const std::string& host = "");
Answer ParseAnswer(const std::string& bytes);

struct Message {
  int opcode = 0;  // 1 text, 2 binary, 8 close, 9 ping, 10 pong
  std::string payload;
  int close_code() const;
};

// A WebSocket. The client answers pings while it reads messages.
class WebSocket {
 public:
  // `head` contains additional header lines. If the server refuses the connection, status() is not
  // 101.
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
  // Returns the next message other than a ping, or no value at the end of the connection.
  std::optional<Message> Next();
  // Returns the next text message that has the "type" `type`. Skips all other messages.
  std::optional<std::string> NextText(const std::string& type);
  // Returns the code of the close frame at the end, or 0 if the connection ends without one.
  int CloseCode();
  // Sends a hello with `code` and waits for the welcome. Returns the welcome, or "" if no welcome
  // arrives.
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
