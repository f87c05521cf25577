// Serves HTTP and WebSocket on one port, with or without TLS. The server handles connections,
// limits and time-outs, but not the content of messages. Hides the Boost library from the users of
// this file.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "viewer/connection.h"

namespace predictor::viewer {

struct ServerOptions {
  std::string address = "127.0.0.1";             // numeric; 127.0.0.1 includes ::1 if available
  std::uint16_t port = 8080;                     // 0: any free port
  std::string certificate_pem, key_pem;          // if both are empty: no TLS
  std::chrono::milliseconds head_time{5000};     // limit for a request's head and the TLS handshake
  std::chrono::milliseconds reply_time{30000};   // time limit for receiving an answer
  std::chrono::milliseconds message_time{1000};  // limit from a message's first byte to its last
  std::chrono::milliseconds idle_time{20000};    // time limit without any data on a WebSocket
  std::size_t longest_head = 8192;               // [bytes]
  // The maximum number of connections before admission. A further connection replaces the oldest
  // one.
  std::size_t max_guests = 256;
  std::size_t max_guests_per_address = 128;  // the same limit for each address
  // The maximum number of TLS handshakes that begin per second. Further handshakes wait for at most
  // head_time. Handshakes take most of the single thread's time, and a stop request must wait for
  // them.
  double handshake_rate = 100;
  double handshake_rate_per_address = 40;
  std::size_t max_waiting_text = 256 * 1024;  // limit for one client [bytes]
  double tick_rate = 60;                      // rate of Application::Tick [Hz]
};

class Server {
 public:
  // Opens the port. Throws InputError if the port is not available, or if the address is not
  // loopback and TLS is off. The application must outlive the server.
  Server(const ServerOptions& options, Application* application);
  ~Server();

  std::uint16_t port() const;

  // Reads lines from a descriptor (a socket or pipe, which the server then owns), each at most
  // `longest` bytes. Calls on_end at the end of the input. Call this before Run.
  void Watch(int descriptor, std::size_t longest, std::function<void(const std::string&)> on_line,
             std::function<void()> on_end);

  // Serves in this thread until Stop.
  void Run();
  // Accepts no new connections, and stops when the last connection has ended, or after the time
  // `patience`. Connections that are being closed still receive the reason for it. Call this in the
  // server's thread.
  void Finish(std::chrono::milliseconds patience);
  // Any thread may call Stop and Post. Post runs `what` in the server's thread.
  void Stop();
  void Post(std::function<void()> what);

  // Returns the number of connections, including those not admitted. Call this in the server's
  // thread.
  std::size_t connections() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor::viewer
