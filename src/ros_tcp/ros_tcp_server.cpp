#include "ros_tcp/ros_tcp_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <iterator>
#include <list>
#include <utility>

#include "core/error.h"
#include "ros_tcp/ros_session.h"

namespace predictor::ros_tcp {
namespace {

using Clock = std::chrono::steady_clock;

std::uint64_t NanosecondsOf(std::chrono::nanoseconds time) {
  return static_cast<std::uint64_t>(time.count());
}
std::uint64_t UnixNow() {
  return NanosecondsOf(std::chrono::system_clock::now().time_since_epoch());
}

constexpr std::size_t kMaxBacklog = 256 * 1024;  // queued answers to one client [bytes]

struct Network {
  std::uint32_t address, mask;  // in host byte order
  bool Has(std::uint32_t other) const { return (other & mask) == (address & mask); }
};

// Shortest prefix [bits]. No private network is larger than 10.0.0.0/8.
constexpr int kWidestNetwork = 8;

std::string Everybody(const std::string& text) {
  return "\"" + text +
         "\" would admit unknown machines. Clients need no access code, and each client can stop "
         "the run. Give the network of the machine that runs Unity, for example 192.168.1.0/24, or "
         "the address of this machine.";
}

// Parses "192.0.2.0/24". A text without a slash is a single address.
Network ParseNetwork(const std::string& text) {
  const std::size_t slash = text.find('/');
  in_addr address{};
  int bits = 32;
  bool good = inet_pton(AF_INET, text.substr(0, slash).c_str(), &address) == 1;
  if (slash != std::string::npos) {
    const std::string number = text.substr(slash + 1);
    good = good && !number.empty() && number.size() <= 2 &&
           number.find_first_not_of("0123456789") == std::string::npos;
    if (good) bits = std::stoi(number);
  }
  if (text == "::" || text.starts_with("::/")) throw InputError("--ros-tcp-allow", Everybody(text));
  if (!good || bits > 32)
    throw InputError(
        "--ros-tcp-allow",
        "\"" + text +
            "\" is not an IPv4 network. Write the network as 192.0.2.0/24 or as a single address.");
  if (bits < kWidestNetwork || address.s_addr == INADDR_ANY)
    throw InputError("--ros-tcp-allow", Everybody(text));
  const std::uint32_t mask = ~std::uint32_t{0} << (32 - bits);
  return {ntohl(address.s_addr), mask};
}

class Socket {
 public:
  explicit Socket(int fd = -1) : fd_(fd) {}
  Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Socket& operator=(Socket&&) = delete;
  ~Socket() {
    if (fd_ >= 0) close(fd_);
  }
  int fd() const { return fd_; }

 private:
  int fd_;
};

struct Client {
  Client(Socket s, std::uint32_t a, RosSession r)
      : socket(std::move(s)), address(a), session(std::move(r)) {}
  Socket socket;
  std::uint32_t address;
  RosSession session;
  FrameReader reader;
  std::string unsent;
  Clock::time_point heard = Clock::now();
};

}  // namespace

struct RosTcpServer::Impl {
  Impl(const RosTcpOptions& o, const RosTopics* t, const RunBoard* b, StopMailbox* m)
      : options(o),
        topics(t),
        board(b),
        mailbox(m),
        listener(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)),
        wake(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    networks.push_back(ParseNetwork("127.0.0.0/8"));
    for (const std::string& text : o.allow) networks.push_back(ParseNetwork(text));
    Open();
  }

  void Open();
  void Accept();
  bool MakeRoom(std::uint32_t address);
  bool Receive(Client* client);              // returns false if the client disconnected
  bool Flush(Client* client);                // returns false if the client disconnected
  bool Serve(Client* client, short events);  // likewise; `events` as from poll
  void Publish();
  void Run(int lifeline);

  RosTcpOptions options;
  const RosTopics* topics;
  const RunBoard* board;
  StopMailbox* mailbox;
  std::vector<Network> networks;
  Socket listener, wake;
  std::uint16_t port = 0;
  std::list<Client> clients;
  // The offset from the records' monotonic clock to Unix time [ns].
  std::uint64_t to_unix_ns = UnixNow() - NanosecondsOf(Clock::now().time_since_epoch());
  std::uint64_t shown = 0;
  std::atomic<bool> stop{false};
};

void RosTcpServer::Impl::Open() {
  const int yes = 1;
  setsockopt(listener.fd(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(options.port);
  address.sin_addr.s_addr = htonl(networks.size() > 1 ? INADDR_ANY : INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (bind(listener.fd(), reinterpret_cast<sockaddr*>(&address), size) != 0 ||
      listen(listener.fd(), 16) != 0 ||
      getsockname(listener.fd(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
    throw InputError("--ros-tcp", "port " + std::to_string(options.port) +
                                      " cannot be opened: " + std::strerror(errno) +
                                      ". Choose another port with --ros-tcp-port.");
  port = ntohs(address.sin_port);
}

// Returns whether the server has a seat for a new client. The new client may take the seat of an
// idle client.
bool RosTcpServer::Impl::MakeRoom(std::uint32_t address) {
  std::vector<Seat> taken;
  for (const Client& client : clients) taken.push_back({client.address, client.session.idle()});
  const Seating seating = SeatFor(address, taken, options.seats);
  if (seating.kind == Seating::Kind::kReplace)
    clients.erase(std::next(clients.begin(), static_cast<std::ptrdiff_t>(seating.victim)));
  return seating.kind != Seating::Kind::kRefuse;
}

void RosTcpServer::Impl::Accept() {
  sockaddr_in from{};
  socklen_t size = sizeof from;
  Socket accepted(accept4(listener.fd(), reinterpret_cast<sockaddr*>(&from), &size,
                          SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (accepted.fd() < 0) return;
  const std::uint32_t address = ntohl(from.sin_addr.s_addr);
  const bool allowed = std::any_of(networks.begin(), networks.end(),
                                   [address](const Network& n) { return n.Has(address); });
  if (!allowed || !MakeRoom(address)) return;
  const int yes = 1;  // send each frame at once: the connector pauses for 10 ms between reads
  setsockopt(accepted.fd(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  // The server must not wait for acknowledgements from a machine that has disappeared.
  setsockopt(accepted.fd(), SOL_SOCKET, SO_KEEPALIVE, &yes, sizeof yes);
  const auto patience = static_cast<unsigned>(options.silence.count());
  setsockopt(accepted.fd(), IPPROTO_TCP, TCP_USER_TIMEOUT, &patience, sizeof patience);
  const auto stop_run = [this] { mailbox->stops.fetch_add(1, std::memory_order_release); };
  clients.emplace_back(std::move(accepted), address, RosSession(topics, options.dialect, stop_run));
  clients.back().unsent = clients.back().session.Greeting();
}

bool RosTcpServer::Impl::Receive(Client* client) {
  char bytes[16 * 1024];
  const ssize_t n = recv(client->socket.fd(), bytes, sizeof bytes, 0);
  if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) return false;
  if (n > 0) {
    client->heard = Clock::now();
    client->reader.Feed({bytes, static_cast<std::size_t>(n)});
  }
  while (const std::optional<RosFrame> frame = client->reader.Next())
    client->unsent += client->session.OnFrame(*frame);
  return !client->reader.broken() && client->unsent.size() <= kMaxBacklog;
}

bool RosTcpServer::Impl::Flush(Client* client) {
  if (client->unsent.empty()) return true;
  const ssize_t n =
      send(client->socket.fd(), client->unsent.data(), client->unsent.size(), MSG_NOSIGNAL);
  if (n < 0) return errno == EAGAIN || errno == EINTR;
  client->unsent.erase(0, static_cast<std::size_t>(n));
  return true;
}

bool RosTcpServer::Impl::Serve(Client* client, short events) {
  try {
    const bool speaks = (events & (POLLIN | POLLHUP | POLLERR)) != 0;
    return (!speaks || Receive(client)) && Flush(client) &&
           Clock::now() - client->heard < options.silence;
  } catch (const std::exception&) {  // an error with one client must not affect the others
    return false;
  }
}

// Sends the newest record to each client that has received the previous one.
void RosTcpServer::Impl::Publish() {
  const std::uint64_t written = board->records.written();
  TickRecord record;
  if (clients.empty() || written == shown || written == 0 ||
      !board->records.Get(written - 1, &record))
    return;
  shown = written;
  const std::uint64_t ns = record.wall_ns != 0 ? record.wall_ns + to_unix_ns : UnixNow();
  const std::vector<RosPublication> publications =
      topics->Publish(record, options.dialect, static_cast<std::uint32_t>(ns / 1'000'000'000),
                      static_cast<std::uint32_t>(ns % 1'000'000'000));
  for (Client& client : clients)
    if (client.unsent.empty()) client.unsent = client.session.Select(publications);
}

void RosTcpServer::Impl::Run(int lifeline) {
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / options.rate));
  Clock::time_point due = Clock::now();
  while (!stop.load()) {
    std::vector<pollfd> ready = {
        {listener.fd(), POLLIN, 0}, {wake.fd(), POLLIN, 0}, {lifeline, POLLIN, 0}};
    for (const Client& client : clients)
      ready.push_back({client.socket.fd(),
                       static_cast<short>(POLLIN | (client.unsent.empty() ? 0 : POLLOUT)), 0});
    const auto wait = std::chrono::ceil<std::chrono::milliseconds>(due - Clock::now()).count();
    poll(ready.data(), ready.size(), static_cast<int>(std::max<std::int64_t>(0, wait)));
    char ignored[256];
    if (ready[2].revents != 0 && recv(lifeline, ignored, sizeof ignored, MSG_DONTWAIT) == 0) return;
    std::size_t k = 3;
    for (auto client = clients.begin(); client != clients.end(); ++k)
      client = Serve(&*client, ready[k].revents) ? std::next(client) : clients.erase(client);
    if ((ready[0].revents & POLLIN) != 0) Accept();
    if (Clock::now() < due) continue;
    due = std::max(due + period, Clock::now());
    Publish();
  }
}

RosTcpServer::RosTcpServer(const RosTcpOptions& options, const RosTopics* topics,
                           const RunBoard* board, StopMailbox* mailbox)
    : impl_(std::make_unique<Impl>(options, topics, board, mailbox)) {}
RosTcpServer::~RosTcpServer() = default;
std::uint16_t RosTcpServer::port() const { return impl_->port; }
void RosTcpServer::Run(int lifeline) { impl_->Run(lifeline); }
void RosTcpServer::Stop() {
  impl_->stop.store(true);
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t n = write(impl_->wake.fd(), &one, sizeof one);
}

}  // namespace predictor::ros_tcp
