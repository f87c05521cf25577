// A connection to the server. Only server.cpp includes this file, because Asio and Beast take half
// a minute to compile.
#pragma once

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "viewer/connection.h"
#include "viewer/http_message.h"
#include "viewer/server_impl.h"
#include "viewer/wire.h"

namespace predictor::viewer {

// Shortest interval between pings, which are sent with states.
inline constexpr auto kPingEvery = std::chrono::milliseconds(100);
// If a pong takes longer, no more states are sent.
inline constexpr auto kPongWithin = std::chrono::milliseconds(250);
// Maximum time for closing a connection.
inline constexpr auto kClosing = std::chrono::milliseconds(3000);
// Maximum time for the rest of a refused request.
inline constexpr auto kLinger = std::chrono::milliseconds(1000);
// The pause after which a waiting connection asks again whether it may begin.
inline constexpr auto kHandshakePause = std::chrono::milliseconds(20);

// One connection, which first receives HTTP requests and may then become a WebSocket. The pending
// operations of a connection keep this object alive.
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
    if (waiting_text_ > server_->options.max_waiting_text) return Drop();
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

  // Reads and discards the remaining input. Unread input would cause a TCP reset, and the client
  // would lose the answer.
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

  // Limits the time in which a message that has begun must be complete.
  void WatchMessage() {
    if (std::exchange(watched_, true)) return;
    message_timer_.expires_after(server_->options.message_time);
    message_timer_.async_wait([weak = weak_from_this()](Error error) {
      const auto self = weak.lock();
      if (self && !error && self->watched_)
        self->Close(CloseCode::kRefused, "A message took too long.");
    });
  }

  // This function is called during a read, so it must not send or close anything.
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

  // Pings accompany the states, and a client answers a ping only after it has read all earlier
  // messages. Therefore, the amount of data in transit is limited to the amount that is sent within
  // the time for a pong.
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
  std::map<std::uint32_t, Message> newest_;  // newest message of each slot
  std::uint32_t last_slot_ = 0;
  bool ping_out_ = false;      // the ping's pong has not arrived
  bool writing_ping_ = false;  // the ping has not been written completely
  Clock::time_point pinged_;
  std::uint64_t pings_ = 0;
};

}  // namespace predictor::viewer
