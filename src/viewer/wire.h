// A byte stream over TCP, with or without TLS, for Asio and Beast.
#pragma once

#include <boost/asio/any_completion_handler.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/container/static_vector.hpp>
#include <cstddef>
#include <optional>
#include <utility>

namespace predictor::viewer {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Error = beast::error_code;

// The stream is a single type with type-erased handlers, so that the code for HTTP and WebSocket is
// compiled only once.
class Wire {
 public:
  using executor_type = beast::tcp_stream::executor_type;
  using next_layer_type = beast::tcp_stream;  // closed by Beast after a time-out

  // `tls` is nullptr for a connection without TLS.
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

  // Functions with "some" in their name may transfer only part of the data. Therefore this function
  // passes on only the first few buffers.
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

}  // namespace predictor::viewer
