// A TLS connection for tests, which trusts any server.
#pragma once

#include <openssl/err.h>
#include <openssl/ssl.h>

#include <csignal>
#include <memory>
#include <optional>

#include "viewer/client.h"

namespace predictor::testing_client {

class TlsTransport : public Transport {
 public:
  explicit TlsTransport(int descriptor)
      : context_(SSL_CTX_new(TLS_client_method())), ssl_(SSL_new(context_)) {
    std::signal(SIGPIPE, SIG_IGN);  // OpenSSL writes without MSG_NOSIGNAL
    SSL_set_fd(ssl_, descriptor);
    ERR_clear_error();
    connected_ = SSL_connect(ssl_) == 1;
  }
  ~TlsTransport() override {
    SSL_free(ssl_);
    SSL_CTX_free(context_);
  }
  TlsTransport(const TlsTransport&) = delete;
  TlsTransport& operator=(const TlsTransport&) = delete;
  bool connected() const { return connected_; }
  long Write(const char* bytes, std::size_t n) override {
    return SSL_write(ssl_, bytes, static_cast<int>(n));
  }
  long Read(char* bytes, std::size_t n) override {
    return SSL_read(ssl_, bytes, static_cast<int>(n));
  }

 private:
  SSL_CTX* context_;
  SSL* ssl_;
  bool connected_ = false;
};

// Returns no value if the server does not complete the handshake within ten seconds.
inline std::optional<Socket> ConnectTls(std::uint16_t port, const char* source = nullptr) {
  Socket socket(port, 0, source);
  auto transport = std::make_shared<TlsTransport>(socket.descriptor());
  if (!transport->connected()) return {};
  socket.Secure(std::move(transport));
  return socket;
}

}  // namespace predictor::testing_client
