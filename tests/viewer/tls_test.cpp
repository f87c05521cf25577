// Tests the server with TLS through OpenSSL's own client.
#include <gtest/gtest.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <filesystem>
#include <memory>

#include "support/temporary_folder.h"
#include "viewer/certificate.h"
#include "viewer/test_server.h"
#include "viewer/tls_client.h"

namespace predictor::viewer {
namespace {

template <auto Free>
struct Freer {
  template <class T>
  void operator()(T* it) const {
    Free(it);
  }
};
using ContextPtr = std::unique_ptr<SSL_CTX, Freer<SSL_CTX_free>>;
using SslPtr = std::unique_ptr<SSL, Freer<SSL_free>>;

class TlsTest : public testing::Test {
 protected:
  TlsTest() {
    certificate_ = SelfSignedCertificate(folder_, {"localhost", "127.0.0.1", "rig.local"});
    TestServer::Setup setup;
    setup.app.tls = true;
    setup.server.certificate_pem = certificate_.certificate_pem;
    setup.server.key_pem = certificate_.key_pem;
    setup.server.head_time = std::chrono::milliseconds(2000);
    server_ = std::make_unique<TestServer>(setup);
  }

  // Trusts only this certificate and requests `name`. Sends `request`. After the beginning of the
  // answer has arrived, sends `then`. Returns the answer, or "" if the handshake fails.
  std::string Ask(const std::string& name, const std::string& request, int newest = 0,
                  std::string then = "") {
    const ContextPtr context(SSL_CTX_new(TLS_client_method()));
    SSL_CTX_load_verify_locations(context.get(), (folder_ / "viewer.pem").c_str(), nullptr);
    SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
    if (newest != 0) SSL_CTX_set_max_proto_version(context.get(), newest);
    const SslPtr ssl(SSL_new(context.get()));
    if (X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(ssl.get()), name.c_str()) != 1)
      SSL_set1_host(ssl.get(), name.c_str());
    ERR_clear_error();
    const testing_client::Socket socket(server_->port());
    SSL_set_fd(ssl.get(), socket.descriptor());
    if (SSL_connect(ssl.get()) != 1) return "";
    SSL_write(ssl.get(), request.data(), static_cast<int>(request.size()));
    std::string answer;
    char part[4096];
    for (int n; (n = SSL_read(ssl.get(), part, sizeof part)) > 0; then.clear()) {
      answer.append(part, static_cast<std::size_t>(n));
      if (!then.empty()) SSL_write(ssl.get(), then.data(), static_cast<int>(then.size()));
    }
    return answer;
  }

  const test::TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.path();
  Certificate certificate_;
  std::unique_ptr<TestServer> server_;
};

TEST_F(TlsTest, ServesUnderEveryNameOfItsCertificate) {
  for (const char* name : {"localhost", "127.0.0.1"})
    EXPECT_NE(Ask(name, "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
                  .find("HTTP/1.1 200"),
              std::string::npos)
        << name;
  EXPECT_EQ(Ask("other.local", "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"), "");
}

TEST_F(TlsTest, OriginsMustBeHttps) {
  const std::string head = "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nOrigin: ";
  EXPECT_NE(Ask("localhost", head + "https://localhost\r\n\r\n").find("HTTP/1.1 200"),
            std::string::npos);
  EXPECT_NE(Ask("localhost", head + "http://localhost\r\n\r\n").find("HTTP/1.1 403"),
            std::string::npos);
}

TEST_F(TlsTest, OpensWebSockets) {
  const std::string answer =
      Ask("localhost",
          "GET /ws HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
          "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
          "Sec-WebSocket-Protocol: predictor.v1\r\n\r\n",
          0, std::string("\x88\x80\x01\x02\x03\x04", 6));  // and closes it
  EXPECT_NE(answer.find("HTTP/1.1 101"), std::string::npos);
  EXPECT_TRUE(answer.ends_with("\x88\x02\x03\xe8"));  // the server answers the close frame
}

TEST_F(TlsTest, RefusesOldVersions) {
  EXPECT_EQ(Ask("localhost", "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n", TLS1_1_VERSION), "");
}

// Handshakes are expensive. A client that requests many handshakes must wait, but other clients
// must not have to wait.
TEST_F(TlsTest, HandshakesOfOneAddressDoNotKeepOthersOut) {
  TestServer::Setup setup;
  setup.app.tls = true;
  setup.server.certificate_pem = certificate_.certificate_pem;
  setup.server.key_pem = certificate_.key_pem;
  setup.server.head_time = std::chrono::milliseconds(500);
  // permits only one within the duration of the test
  setup.server.handshake_rate_per_address = 1e-6;
  const TestServer server(setup);
  using testing_client::ConnectTls;
  EXPECT_TRUE(ConnectTls(server.port(), "127.0.0.2"));
  EXPECT_FALSE(ConnectTls(server.port(), "127.0.0.2"));
  EXPECT_TRUE(ConnectTls(server.port(), "127.0.0.3"));
}

TEST_F(TlsTest, AClientWithoutAHandshakeIsDisconnected) {
  testing_client::Socket silent(server_->port());
  EXPECT_TRUE(silent.Ended());
  EXPECT_EQ(testing_client::Get(server_->port(), "/").status, 0);  // refused without encryption
  EXPECT_NE(Ask("localhost", "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"), "");
}

}  // namespace
}  // namespace predictor::viewer
