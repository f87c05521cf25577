// The only file that includes Boost's Asio and Beast, which take half a minute to compile.
#include "viewer/server.h"

#include <algorithm>
#include <boost/asio/any_completion_handler.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/container/static_vector.hpp>
#include <deque>
#include <list>
#include <map>
#include <optional>
#include <utility>

#include "core/error.h"
#include "viewer/rate_limit.h"

namespace predictor::viewer {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Error = beast::error_code;
using Clock = std::chrono::steady_clock;
using Request = http::request<http::empty_body>;

constexpr auto kPingEvery = std::chrono::milliseconds(100);   // shortest interval; sent with states
constexpr auto kPongWithin = std::chrono::milliseconds(250);  // otherwise, no more states are sent
constexpr auto kClosing = std::chrono::milliseconds(3000);  // maximum time for closing a connection
// Maximum time for the rest of a refused request.
constexpr auto kLinger = std::chrono::milliseconds(1000);
constexpr auto kAcceptPause = std::chrono::milliseconds(50);     // if file descriptors run out
constexpr auto kHandshakePause = std::chrono::milliseconds(20);  // before requesting a turn again
constexpr std::size_t kMostAddresses = 1024;  // maximum number that is remembered

// A byte stream over TCP, with or without TLS. It is one type with type-erased handlers, so that
// HTTP and WebSocket are compiled only once.
class Wire {
 public:
  using executor_type = beast::tcp_stream::executor_type;
  using next_layer_type = beast::tcp_stream;  // closed by Beast after a time-out

  // `tls`: nullptr for a connection without TLS.
  Wire(tcp::socket socket, asio::ssl::context* tls) : tcp_(std::move(socket)) {
    if (tls) tls_.emplace(tcp_, *tls);
  }
  executor_type get_executor() { return tcp_.get_executor(); }
  next_layer_type& next_layer() { return tcp_; }
  const next_layer_type& next_layer() const { return tcp_; }

  void Handshake(asio::any_completion_handler<void(Error)> handler) {
    if (tls_) return tls_->async_handshake(asio::ssl::stream_base::server, std::move(handler));
    asio::post(get_executor(), [h = std::move(handler)]() mutable { std::move(h)(Error()); });
  }
  // Ends the WebSocket and the connection.
  void Teardown(beast::role_type role, asio::any_completion_handler<void(Error)> handler) {
    if (tls_) return tls_->async_shutdown(std::move(handler));
    websocket::async_teardown(role, tcp_.socket(), std::move(handler));
  }

  template <class Buffers, class Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    return Start<asio::mutable_buffer>(
        [this](const auto& few, Handler handler) {
          if (tls_) return tls_->async_read_some(few, std::move(handler));
          tcp_.async_read_some(few, std::move(handler));
        },
        buffers, std::forward<Token>(token));
  }
  template <class Buffers, class Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    return Start<asio::const_buffer>(
        [this](const auto& few, Handler handler) {
          if (tls_) return tls_->async_write_some(few, std::move(handler));
          tcp_.async_write_some(few, std::move(handler));
        },
        buffers, std::forward<Token>(token));
  }

 private:
  using Handler = asio::any_completion_handler<void(Error, std::size_t)>;

  // "Some" may be less than all: only the first few buffers.
  template <class Buffer, class Operation, class Buffers, class Token>
  static auto Start(Operation operation, const Buffers& buffers, Token&& token) {
    boost::container::static_vector<Buffer, 8> few;
    for (auto it = asio::buffer_sequence_begin(buffers);
         it != asio::buffer_sequence_end(buffers) && few.size() < few.capacity(); ++it)
      few.push_back(*it);
    return asio::async_initiate<Token, void(Error, std::size_t)>(
        [operation, few]<class H>(H&& handler) {
          operation(few, Handler(std::forward<H>(handler)));
        },
        token);
  }

  beast::tcp_stream tcp_;
  std::optional<asio::ssl::stream<beast::tcp_stream&>> tls_;
};

// Required by Beast for a stream below a WebSocket.
template <class Token>
void async_teardown(beast::role_type role, Wire& wire, Token&& token) {
  wire.Teardown(role, std::forward<Token>(token));
}

std::string Text(beast::string_view text) { return {text.data(), text.size()}; }

// Converts "a, b" to a list.
std::vector<std::string> Words(beast::string_view list) {
  std::vector<std::string> words;
  for (const auto word : http::token_list(list)) words.push_back(Text(word));
  return words;
}

HttpRequest HeadOf(const Request& request, std::uint16_t port) {
  return {Text(request.method_string()),
          Text(request.target()),
          Text(request[http::field::host]),
          Text(request[http::field::origin]),
          Text(request[http::field::authorization]),
          Words(request[http::field::sec_websocket_protocol]),
          request.count(http::field::host),
          port};
}

template <class Message>
void SetHeaders(const HttpReply& reply, Message* message) {
  message->set(http::field::server, "PREDICTOR");
  message->set(http::field::content_type, reply.type.empty() ? "text/plain" : reply.type);
  message->set(http::field::cache_control, "no-store");
  message->set("Content-Security-Policy",
               "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
               "img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; "
               "frame-ancestors 'none'");
  message->set("X-Content-Type-Options", "nosniff");
  message->set("Referrer-Policy", "no-referrer");
  message->set("X-Frame-Options", "DENY");
  message->set("Cross-Origin-Opener-Policy", "same-origin");
  message->set("Cross-Origin-Resource-Policy", "same-origin");
  if (reply.status == 405) message->set(http::field::allow, "GET");
  if (reply.status == 401) message->set(http::field::www_authenticate, "Bearer");
}

std::string WhyNot(const tcp::endpoint& endpoint, Error error) {
  return "The viewer could not open port " + std::to_string(endpoint.port()) + " of " +
         endpoint.address().to_string() + ": " + error.message() +
         (error == asio::error::address_in_use
              ? ". Another program uses it. End that program, or choose another port with --port."
              : ".");
}

// A connection of either kind, as the server uses it.
class Member {
 public:
  virtual ~Member() = default;
  // Disconnects it at once.
  virtual void Drop() = 0;
  virtual const asio::ip::address& address() const = 0;  // of the peer
};

}  // namespace

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

  // Adds a connection that is not admitted yet, in order of arrival.
  void Welcome(Member* member) {
    guests.push_back(member);
    ++connections;
    const auto same = [member](const Member* guest) {
      return guest->address() == member->address();
    };
    if (static_cast<std::size_t>(std::count_if(guests.begin(), guests.end(), same)) >
        options.most_guests_per_address)
      (*std::find_if(guests.begin(), guests.end(), same))->Drop();
    if (guests.size() > options.most_guests) guests.front()->Drop();
  }
  void Forget(Member* member) { guests.remove(member); }

  // Whether a connection from this address may begin its handshake now.
  bool MayShakeHands(const asio::ip::address& from) {
    const auto now = static_cast<std::uint64_t>(Clock::now().time_since_epoch().count());
    if (handshakes_from.size() > kMostAddresses) handshakes_from.clear();
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

namespace {

// One connection: first HTTP requests, then perhaps a WebSocket. Its pending operations keep it
// alive.
class Link final : public Connection, public Member, public std::enable_shared_from_this<Link> {
 public:
  Link(Server::Impl* server, tcp::socket socket)
      : server_(server),
        address_(AddressOf(socket)),
        ws_(std::move(socket), server->tls ? &*server->tls : nullptr),
        message_timer_(server->io),
        close_timer_(server->io) {
    server_->Welcome(this);
  }
  ~Link() override {
    server_->Forget(this);
    if (--server_->connections == 0 && server_->finishing) server_->io.stop();
  }

  void Start() {
    lowest().socket().set_option(tcp::no_delay(true), ignored_);
    AwaitTurn(Clock::now() + server_->options.head_time);
  }

  void SendText(std::string text) override {
    if (!Talks()) return;
    waiting_text_ += text.size();
    if (waiting_text_ > server_->options.most_waiting_text) return Drop();
    texts_.push_back(std::move(text));
    Pump();
  }
  void SendNewest(std::uint32_t slot, MessageKind kind,
                  std::shared_ptr<const std::string> message) override {
    if (!Talks()) return;
    newest_[slot] = {kind, std::move(message)};
    Pump();
  }
  void Close(CloseCode code, std::string reason) override {
    if (!Talks()) return;
    farewell_ = websocket::close_reason(static_cast<websocket::close_code>(code),
                                        beast::string_view(reason).substr(0, 120));
    saying_farewell_ = true;
    close_timer_.expires_after(kClosing);
    close_timer_.async_wait([weak = weak_from_this()](Error error) {
      if (const auto self = weak.lock(); self && !error) self->Drop();
    });
    Pump();
  }
  void Admitted() override { server_->Forget(this); }
  const asio::ip::address& address() const override { return address_; }
  std::string peer() const override { return address_.to_string(); }
  void Drop() override {
    server_->Forget(this);
    open_ = false;
    lowest().socket().close(ignored_);
  }

 private:
  static asio::ip::address AddressOf(const tcp::socket& socket) {
    Error error;
    return socket.remote_endpoint(error).address();
  }
  beast::tcp_stream& lowest() { return beast::get_lowest_layer(ws_); }
  bool Talks() const { return open_ && !saying_farewell_ && !server_->closing; }

  void AwaitTurn(Clock::time_point end) {
    if (!server_->tls || server_->MayShakeHands(address_)) return ShakeHands();
    if (Clock::now() > end) return Drop();
    message_timer_.expires_after(kHandshakePause);
    message_timer_.async_wait([self = shared_from_this(), end](Error error) {
      if (!error && self->lowest().socket().is_open()) self->AwaitTurn(end);
    });
  }
  void ShakeHands() {
    lowest().expires_after(server_->options.head_time);
    ws_.next_layer().Handshake([self = shared_from_this()](Error error) {
      if (!error) self->ReadHead();
    });
  }

  // ---- requests
  // ----------------------------------------------------------------------------------

  void ReadHead() {
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(server_->options.longest_head));
    lowest().expires_after(server_->options.head_time);
    http::async_read_header(
        ws_.next_layer(), buffer_, *parser_,
        [self = shared_from_this()](Error error, std::size_t) { self->OnHead(error); });
  }

  void OnHead(Error error) {
    if (error == http::error::header_limit || error == http::error::buffer_overflow)
      return Respond({431, "", "The request's header is too large.\n"}, false);
    if (error == http::error::body_limit)
      return Respond({413, "", "Requests must not have a body.\n"}, false);
    if (error && error.category() == http::make_error_code(http::error::bad_method).category() &&
        error != http::error::end_of_stream && error != http::error::partial_message)
      return Respond({400, "", "The request is invalid.\n"}, false);
    if (error) return;
    const Request& request = parser_->get();
    if (!parser_->is_done() || parser_->content_length().value_or(0) > 0)
      return Respond({413, "", "Requests must not have a body.\n"}, false);
    if (websocket::is_upgrade(request)) return Upgrade(request);
    Respond(server_->application->Get(HeadOf(request, server_->options.port)),
            request.keep_alive());
  }

  void Respond(const HttpReply& reply, bool keep_alive) {
    response_.emplace(static_cast<http::status>(reply.status), 11);
    SetHeaders(reply, &*response_);
    response_->body() = {reply.body.data(), reply.body.size()};
    response_->keep_alive(keep_alive && reply.status < 400);
    response_->prepare_payload();
    lowest().expires_after(server_->options.reply_time);
    http::async_write(ws_.next_layer(), *response_,
                      [self = shared_from_this()](Error error, std::size_t) {
                        if (error) return;
                        if (self->response_->keep_alive())
                          self->ReadHead();
                        else
                          self->Linger();
                      });
  }

  // Reads the remaining input; otherwise, it would cause a reset that discards the answer.
  void Linger() {
    lowest().socket().shutdown(tcp::socket::shutdown_send, ignored_);
    lowest().expires_after(kLinger);
    ReadRest();
  }
  void ReadRest() {
    buffer_.clear();
    lowest().async_read_some(buffer_.prepare(4096),
                             [self = shared_from_this()](Error error, std::size_t) {
                               if (!error) self->ReadRest();
                             });
  }

  // ---- the WebSocket
  // -----------------------------------------------------------------------------

  void Upgrade(const Request& request) {
    UpgradeReply reply = server_->application->Upgrade(HeadOf(request, server_->options.port));
    if (!reply.open) return Respond(reply.refusal, false);
    lowest().expires_never();
    websocket::stream_base::timeout timeout;
    timeout.handshake_timeout = server_->options.head_time;
    timeout.idle_timeout = server_->options.idle_time;
    timeout.keep_alive_pings = true;
    ws_.set_option(timeout);
    ws_.set_option(websocket::stream_base::decorator(
        [subprotocol = reply.subprotocol](websocket::response_type& response) {
          response.set(http::field::server, "PREDICTOR");
          response.set(http::field::sec_websocket_protocol, subprotocol);
        }));
    ws_.read_message_max(reply.longest_message);
    ws_.auto_fragment(false);
    ws_.control_callback([this](websocket::frame_type kind, beast::string_view payload) {
      OnControl(kind, payload);
    });
    ws_.async_accept(request, [self = shared_from_this(), open = reply.open](Error error) {
      if (error) return;
      self->buffer_.clear();
      self->open_ = true;
      self->session_ = open(self.get());
      self->Read();
    });
  }

  void Read() {
    ws_.async_read_some(buffer_, kChunk, [self = shared_from_this()](Error error, std::size_t) {
      self->OnRead(error);
    });
  }

  void OnRead(Error error) {
    if (error) return End();
    if (saying_farewell_) {
      buffer_.clear();
      return;  // closing reads the remaining input
    }
    if (!ws_.is_message_done()) {
      WatchMessage();
      return Read();
    }
    message_timer_.cancel();
    watched_ = false;
    Deliver();
    buffer_.clear();
    if (!saying_farewell_) Read();
  }

  void Deliver() {
    if (!ws_.got_text()) return session_->OnBinary();
    const auto data = buffer_.cdata();
    session_->OnText({static_cast<const char*>(data.data()), data.size()});
  }

  // Limits the time for a message that has begun.
  void WatchMessage() {
    if (std::exchange(watched_, true)) return;
    message_timer_.expires_after(server_->options.message_time);
    message_timer_.async_wait([weak = weak_from_this()](Error error) {
      const auto self = weak.lock();
      if (self && !error && self->watched_)
        self->Close(CloseCode::kRefused, "A message took too long.");
    });
  }

  // Called during a read: this function must not send or close anything.
  void OnControl(websocket::frame_type kind, beast::string_view payload) {
    if (kind == websocket::frame_type::close) return;
    const bool awaited =
        kind == websocket::frame_type::pong && ping_out_ && Text(payload) == PingText();
    if (awaited) ping_out_ = false;
    asio::post(server_->io, [weak = weak_from_this(), awaited] {
      const auto self = weak.lock();
      if (!self || !self->Talks()) return;
      if (awaited)
        self->Pump();
      else
        self->session_->OnControlFrame();
    });
  }

  void End() {
    open_ = false;
    message_timer_.cancel();
    close_timer_.cancel();
    lowest().socket().close(ignored_);
    session_.reset();
  }

  // ---- sending
  // -----------------------------------------------------------------------------------

  void Pump() {
    if (writing_ || !open_) return;
    if (!texts_.empty()) {
      auto text = std::make_shared<const std::string>(std::move(texts_.front()));
      texts_.pop_front();
      waiting_text_ -= text->size();
      Write(text, MessageKind::kText);
    } else if (!newest_.empty() && MaySendNewest()) {
      auto next = newest_.upper_bound(last_slot_);  // the slots take turns
      if (next == newest_.end()) next = newest_.begin();
      last_slot_ = next->first;
      const Message message = std::move(next->second);
      newest_.erase(next);
      Write(message.bytes, message.kind);
    } else if (saying_farewell_) {
      SayFarewell();
    }
  }

  void Write(const std::shared_ptr<const std::string>& message, MessageKind kind) {
    writing_ = true;
    ws_.text(kind == MessageKind::kText);
    const auto bytes = asio::buffer(*message);
    ws_.async_write(bytes, [self = shared_from_this(), message](Error error, std::size_t) {
      self->writing_ = false;
      if (!error) self->Pump();
    });
  }

  // Pings accompany the states, and a client answers a ping only after it has read everything
  // before it. Therefore, the data in transit is limited to what is sent within the time for a
  // pong.
  bool MaySendNewest() {
    const auto now = Clock::now();
    if (ping_out_) return now - pinged_ < kPongWithin;
    if (now - pinged_ >= kPingEvery && !writing_ping_) Ping(now);
    return true;
  }

  void Ping(Clock::time_point now) {
    pinged_ = now;
    ping_out_ = writing_ping_ = true;
    ++pings_;
    ws_.async_ping(websocket::ping_data(PingText()),
                   [self = shared_from_this()](Error) { self->writing_ping_ = false; });
  }
  std::string PingText() const { return "p" + std::to_string(pings_); }

  void SayFarewell() {
    if (std::exchange(said_farewell_, true)) return;
    ws_.async_close(farewell_, [self = shared_from_this()](Error) { self->End(); });
  }

  static constexpr std::size_t kChunk = 4096;  // size of one read [bytes]

  Server::Impl* server_;
  asio::ip::address address_;
  Error ignored_;
  websocket::stream<Wire, false> ws_;  // without compression
  beast::flat_buffer buffer_{64 * 1024};
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::optional<http::response<http::span_body<const char>>> response_;
  std::unique_ptr<Session> session_;
  asio::steady_timer message_timer_, close_timer_;
  bool open_ = false;     // as a WebSocket
  bool watched_ = false;  // a message has begun
  bool saying_farewell_ = false, said_farewell_ = false;
  websocket::close_reason farewell_;
  bool writing_ = false;
  std::deque<std::string> texts_;
  std::size_t waiting_text_ = 0;  // [bytes]
  struct Message {
    MessageKind kind = MessageKind::kBinary;
    std::shared_ptr<const std::string> bytes;
  };
  std::map<std::uint32_t, Message> newest_;  // by slot
  std::uint32_t last_slot_ = 0;
  bool ping_out_ = false;      // its pong has not arrived
  bool writing_ping_ = false;  // it has not been written completely
  Clock::time_point pinged_;
  std::uint64_t pings_ = 0;
};

}  // namespace

void Server::Impl::Listen() {
  Error error;
  const auto address = asio::ip::make_address(options.address, error);
  if (error)
    throw InputError("The viewer's address \"" + options.address +
                     "\" is not numeric. Give an address such as 127.0.0.1 or 0.0.0.0.");
  const bool secure = !options.certificate_pem.empty();
  if (!address.is_loopback() && !secure)
    throw InputError("Access to the viewer from other machines (" + options.address +
                     ") requires TLS.");
  if (secure) {
    tls.emplace(asio::ssl::context::tls_server);
    tls->set_options(asio::ssl::context::default_workarounds | asio::ssl::context::no_tlsv1 |
                     asio::ssl::context::no_tlsv1_1);
    tls->use_certificate_chain(asio::buffer(options.certificate_pem));
    tls->use_private_key(asio::buffer(options.key_pem), asio::ssl::context::pem);
  }
  const tcp::endpoint endpoint(address, options.port);
  error = Open(endpoint);
  if (error) throw InputError(WhyNot(endpoint, error));
  options.port = acceptors.front().local_endpoint().port();
  if (address != asio::ip::address_v4::loopback()) return;
  // Browsers try ::1 first for "localhost", so no other program may listen there.
  const tcp::endpoint other(asio::ip::address_v6::loopback(), options.port);
  if (Open(other) == asio::error::address_in_use && endpoint.port() != 0)
    throw InputError(WhyNot(other, asio::error::address_in_use));
}

Error Server::Impl::Open(const tcp::endpoint& endpoint) {
  Error error;
  tcp::acceptor acceptor(io);
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error && endpoint.address().is_v6())
    acceptor.set_option(asio::ip::v6_only(endpoint.address().is_loopback()), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (!error) acceptors.push_back(std::move(acceptor));
  return error;
}

void Server::Impl::Accept(tcp::acceptor* acceptor) {
  acceptor->async_accept([this, acceptor](Error error, tcp::socket socket) {
    if (!error) Receive(std::move(socket));
    if (error == asio::error::operation_aborted) return;
    if (error != asio::error::no_descriptors) return Accept(acceptor);
    accept_pause.expires_after(kAcceptPause);
    accept_pause.async_wait([this, acceptor](Error aborted) {
      if (!aborted) Accept(acceptor);
    });
  });
}

void Server::Impl::Receive(tcp::socket socket) {
  std::make_shared<Link>(this, std::move(socket))->Start();
}

void Server::Impl::Tick() {
  const auto period = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(1 / options.tick_rate));
  tick.expires_at(std::max(tick.expiry() + period, Clock::now()));
  tick.async_wait([this](Error error) {
    if (error) return;
    application->Tick();
    Tick();
  });
}

void Server::Impl::ReadLine(std::size_t which) {
  Source& source = *sources[which];
  asio::async_read_until(source.descriptor, asio::dynamic_buffer(source.text, source.longest), '\n',
                         [this, which, &source](Error error, std::size_t bytes) {
                           if (error) return source.on_end();
                           const std::string line = source.text.substr(0, bytes - 1);
                           source.text.erase(0, bytes);
                           source.on_line(line);
                           ReadLine(which);
                         });
}

Server::Server(const ServerOptions& options, Application* application)
    : impl_(std::make_unique<Impl>(options, application)) {
  impl_->Listen();
}

Server::~Server() = default;

std::uint16_t Server::port() const { return impl_->options.port; }

std::size_t Server::connections() const { return impl_->connections; }

void Server::Watch(int descriptor, std::size_t longest,
                   std::function<void(const std::string&)> on_line, std::function<void()> on_end) {
  impl_->sources.push_back(std::make_unique<Impl::Source>(
      Impl::Source{asio::posix::stream_descriptor(impl_->io, descriptor),
                   {},
                   longest,
                   std::move(on_line),
                   std::move(on_end)}));
  impl_->ReadLine(impl_->sources.size() - 1);
}

void Server::Run() {
  for (tcp::acceptor& acceptor : impl_->acceptors) impl_->Accept(&acceptor);
  impl_->tick.expires_at(Clock::now());
  impl_->Tick();
  impl_->io.run();
}

void Server::Stop() { impl_->io.stop(); }

void Server::Finish(std::chrono::milliseconds patience) {
  impl_->finishing = true;
  for (tcp::acceptor& acceptor : impl_->acceptors) {
    Error ignored;
    acceptor.close(ignored);
  }
  if (impl_->connections == 0) return Stop();
  impl_->linger.expires_after(patience);
  impl_->linger.async_wait([this](Error error) {
    if (!error) Stop();
  });
}

void Server::Post(std::function<void()> what) { asio::post(impl_->io, std::move(what)); }

}  // namespace predictor::viewer
