// The only source with Boost's Asio and Beast, which take half a minute to compile.
#include "viewer/server.h"

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read_until.hpp>
#include <utility>

#include "core/error.h"
#include "viewer/link.h"
#include "viewer/server_impl.h"

namespace predictor::viewer {
namespace {

constexpr auto kAcceptPause = std::chrono::milliseconds(50);  // pause when file descriptors run out

std::string WhyNot(const tcp::endpoint& endpoint, Error error) {
  return "The viewer could not open port " + std::to_string(endpoint.port()) + " of " +
         endpoint.address().to_string() + ": " + error.message() +
         (error == asio::error::address_in_use
              ? ". Another program uses it. End that program, or choose another port with --port."
              : ".");
}

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
