// HTTP and WebSocket on one port, with or without TLS: connections, limits and time-outs, and
// nothing of what is said. Boost stays behind this interface.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "viewer/connection.h"

namespace predictor {

struct ServerOptions {
  std::string address = "127.0.0.1";     // numeric; with 127.0.0.1 comes ::1, where there is one
  std::uint16_t port = 8080;             // 0: one that is free
  std::string certificate_pem, key_pem;  // both empty: no TLS
  std::chrono::milliseconds head_time{5000};     // for a request's head, and for the TLS handshake
  std::chrono::milliseconds reply_time{30000};   // for taking an answer
  std::chrono::milliseconds message_time{1000};  // from a message's first byte to its last
  std::chrono::milliseconds idle_time{20000};    // without a sign of life on a WebSocket
  std::size_t longest_head = 8192;               // [bytes]
  std::size_t most_guests = 256;  // connections not admitted; one more cuts off the oldest
  std::size_t most_guests_per_address = 128;  // likewise
  // TLS handshakes begun in a second; what comes beyond waits its turn, within head_time. They are
  // what costs the one thread most, and a stop waits for it.
  double handshake_rate = 100;
  double handshake_rate_per_address = 40;
  std::size_t most_waiting_text = 256 * 1024;  // for one client [bytes]
  double tick_rate = 60;                       // of Application::Tick [Hz]
};

class Server {
 public:
  // Opens the port. Throws InputError if it cannot be had, or if the address is not loopback and
  // there is no TLS. The application is borrowed and must outlive the server.
  Server(const ServerOptions& options, Application* application);
  ~Server();

  std::uint16_t port() const;

  // Lines that come in by a descriptor (a socket or pipe, which the server then owns), each at most
  // `longest` bytes; on_end when there will be no more. Before Run.
  void Watch(int descriptor, std::size_t longest, std::function<void(const std::string&)> on_line,
             std::function<void()> on_end);

  // Serves in this thread until Stop.
  void Run();
  // Takes no new connections, and stops when the last has ended or patience has: whoever is being
  // closed hears the reason. In the server's thread.
  void Finish(std::chrono::milliseconds patience);
  // From any thread, as is Post, which has `what` done in the server's.
  void Stop();
  void Post(std::function<void()> what);

  // Connections that exist, admitted or not. In the server's thread.
  std::size_t connections() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
