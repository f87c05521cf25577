// The data and functions that the server and its connections share.
#pragma once

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/rate_limit.h"
#include "viewer/server.h"
#include "viewer/wire.h"

namespace predictor::viewer {

using Clock = std::chrono::steady_clock;

inline constexpr std::size_t kMaxAddresses = 1024;  // maximum number that is remembered

// The server's interface to a connection of either kind.
class Member {
 public:
  virtual ~Member() = default;
  // Disconnects it at once.
  virtual void Drop() = 0;
  virtual const asio::ip::address& address() const = 0;  // address of the peer
};

struct Server::Impl {
  Impl(const ServerOptions& o, Application* a)
      : options(o), application(a), handshakes(o.handshake_rate) {}
  ~Impl() { closing = true; }

  void Listen();
  Error Open(const tcp::endpoint& endpoint);
  void Accept(tcp::acceptor* acceptor);
  void Receive(tcp::socket socket);
  void Tick();
  void ReadLine(std::size_t which);

  // Adds a connection that is not admitted yet to the end of the list, which is in order of
  // arrival.
  void Welcome(Member* member) {
    guests.push_back(member);
    ++connections;
    const auto same = [member](const Member* guest) {
      return guest->address() == member->address();
    };
    if (static_cast<std::size_t>(std::count_if(guests.begin(), guests.end(), same)) >
        options.max_guests_per_address)
      (*std::find_if(guests.begin(), guests.end(), same))->Drop();
    if (guests.size() > options.max_guests) guests.front()->Drop();
  }
  void Forget(Member* member) { guests.remove(member); }

  // Returns whether a connection from this address may begin its handshake now.
  bool MayShakeHands(const asio::ip::address& from) {
    const auto now = static_cast<std::uint64_t>(Clock::now().time_since_epoch().count());
    if (handshakes_from.size() > kMaxAddresses) handshakes_from.clear();
    RateLimit& theirs =
        handshakes_from.try_emplace(from, options.handshake_rate_per_address).first->second;
    return theirs.Take(now) && handshakes.Take(now);
  }

  struct Source {
    asio::posix::stream_descriptor descriptor;
    std::string text;
    std::size_t longest;
    std::function<void(const std::string&)> on_line;
    std::function<void()> on_end;
  };

  ServerOptions options;
  Application* application;
  bool closing = false;
  bool finishing = false;  // the server ends when no connection is left
  std::size_t connections = 0;
  std::list<Member*> guests;
  RateLimit handshakes;
  std::map<asio::ip::address, RateLimit> handshakes_from;
  std::optional<asio::ssl::context> tls;
  asio::io_context io{1};
  std::list<tcp::acceptor> acceptors;
  std::vector<std::unique_ptr<Source>> sources;
  asio::steady_timer tick{io}, accept_pause{io}, linger{io};
};

}  // namespace predictor::viewer
