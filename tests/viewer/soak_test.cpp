// Measures how much the viewer slows the run. The test measures each tick of `predictor run` at its
// full rate through the shared memory. It measures the run first without clients, and then with the
// maximum number of clients and with further connections that are not permitted.
#include "support/soak.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/histogram.h"
#include "core/shared_run.h"
#include "viewer/client.h"
#include "viewer/frame_offset.h"

namespace predictor::viewer {
namespace {

using std::chrono::milliseconds;
using testing_client::Socket;
using testing_client::WebSocket;
using Clock = std::chrono::steady_clock;

// PREDICTOR_SOAK_SECONDS shortens the windows of each soak test for a trial.
std::chrono::seconds Window(long sample, long full) {
  const char* text = std::getenv("PREDICTOR_SOAK_SECONDS");
  return std::chrono::seconds(text ? std::atol(text) : Count(sample, full));
}

// Runs `predictor run` at a separate terminal, so that it runs until it is ended.
class Program {
 public:
  explicit Program(const std::string& duration) {
    pid_ = forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (pid_ == 0) {
      const std::string scenario = std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml";
      execl(PREDICTOR_BINARY, "predictor", "run", scenario.c_str(), "--port", "0", "--duration",
            duration.c_str(), "--quiet", "--no-record", nullptr);
      _exit(127);
    }
    reads_ = std::thread([this] { Read(); });
    const std::string url = After("Viewer: http://localhost:");
    port_ = static_cast<std::uint16_t>(std::atoi(url.c_str()));
    code_ = url.substr(std::min(url.size(), url.find("#code=") + 6));
  }
  ~Program() {
    if (pid_ > 0) End();
    reads_.join();  // ends with the program, which is the leader of the terminal's session
    close(terminal_);
  }

  std::uint16_t port() const { return port_; }
  const std::string& code() const { return code_; }
  // Returns the records in the form in which other processes of the run read them, or null if the
  // records do not exist.
  std::unique_ptr<Shared<RunBoard>> Board() const {
    for (const auto& entry :
         std::filesystem::directory_iterator("/proc/" + std::to_string(pid_) + "/fd")) {
      struct stat status {};
      const int fd = open(entry.path().c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
      if (fd < 0) continue;
      if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode) &&
          status.st_size == static_cast<off_t>(sizeof(RunBoard)))
        return std::make_unique<Shared<RunBoard>>(fd, false);
      close(fd);
    }
    return nullptr;
  }

 private:
  // Ends the program as Ctrl-C does, or kills it after ten seconds.
  void End() {
    kill(pid_, SIGINT);
    for (int i = 0; i < 1000; ++i, std::this_thread::sleep_for(milliseconds(10)))
      if (waitpid(pid_, nullptr, WNOHANG) != 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  void Read() {
    char text[1024];
    for (ssize_t n; (n = read(terminal_, text, sizeof text)) > 0;) {
      const std::lock_guard lock(mutex_);
      text_.append(text, static_cast<std::size_t>(n));
    }
  }
  // Returns the rest of the line after `what` once it appears, or an empty text after a minute.
  std::string After(const std::string& what) {
    for (int i = 0; i < 6000; ++i, std::this_thread::sleep_for(milliseconds(10))) {
      const std::lock_guard lock(mutex_);
      const std::size_t at = text_.find(what);
      if (at == std::string::npos) continue;
      const std::size_t end = text_.find_first_of("\r\n", at);
      if (end != std::string::npos) return text_.substr(at + what.size(), end - at - what.size());
    }
    return "";
  }

  pid_t pid_ = -1;
  int terminal_ = -1;
  std::uint16_t port_ = 0;
  std::string code_;
  std::mutex mutex_;
  std::string text_;
  std::thread reads_;
};

// The ticks of one window.
struct Ticks {
  Histogram tick_us;   // a tick's own duration
  Histogram woken_us;  // from the start of one tick to the next; a late wake-up increases it
  std::uint64_t lost = 0;
};

Ticks Measure(const RunBoard& board, std::chrono::seconds window) {
  Ticks ticks;
  RingReader<TickRecord, kRecordRing> reader(board.records);
  std::uint64_t last_ns = 0;
  TickRecord record;
  const auto end = Clock::now() + window;
  while (Clock::now() < end) {
    while (reader.Next(&record)) {
      ticks.tick_us.Add(static_cast<double>(record.stage_us[static_cast<int>(Stage::kTick)]));
      if (last_ns != 0) ticks.woken_us.Add(static_cast<double>(record.wall_ns - last_ns) * 1e-3);
      last_ns = record.wall_ns;
    }
    std::this_thread::sleep_for(milliseconds(50));
  }
  ticks.lost = reader.lost();
  return ticks;
}

// A page that reads all messages in a separate thread.
class Viewer {
 public:
  Viewer(std::uint16_t port, const std::string& code)
      : page_(port), welcomed_(!page_.Hello(code).empty()), thread_([this] { Read(); }) {}
  ~Viewer() {
    shutdown(page_.socket().descriptor(), SHUT_RDWR);
    thread_.join();
  }
  bool welcomed() const { return welcomed_; }
  long states() const { return states_; }

 private:
  void Read() {
    while (const auto message = page_.Next()) {
      if (message->opcode == 8) return;
      states_ += message->opcode == 2;
    }
  }
  WebSocket page_;
  bool welcomed_;
  std::atomic<long> states_{0};
  std::thread thread_;
};

// Clients that connect repeatedly. After each connection, a client disconnects, sends invalid data,
// guesses codes, sends slowly, or announces huge messages.
class Attackers {
 public:
  explicit Attackers(std::uint16_t port) : port_(port), thread_([this] { Attack(); }) {}
  ~Attackers() {
    done_ = true;
    thread_.join();
  }
  long attempts() const { return attempts_; }
  long admitted() const { return admitted_; }

 private:
  void Attack() {
    std::deque<Socket> slow;
    for (long k = 0; !done_; ++k, std::this_thread::sleep_for(milliseconds(4))) {
      ++attempts_;
      switch (k % 5) {
        case 0:
          Socket{port_};
          break;
        case 1:
          Socket(port_).Send("GET /\r\n\r\n");
          break;
        case 2:
          Guess();
          break;
        case 3:
          slow.emplace_back(port_);
          if (slow.size() > 50) slow.pop_front();
          for (Socket& socket : slow) socket.Send("x");
          break;
        default:
          Boast();
      }
    }
  }
  void Guess() {
    WebSocket page(port_);
    page.SendText(R"({"type":"hello","code":"guess"})");
    admitted_ += page.NextText("welcome").has_value();
  }
  // Sends a message that announces a huge size, and a huge header.
  void Boast() {
    WebSocket(port_).SendRaw(std::string("\x81\xff\x00\x00\x00\xff\xff\xff\xff\xff", 10));
    Socket(port_).Send("GET / HTTP/1.1\r\nX: " + std::string(65536, 'x'));
  }

  std::uint16_t port_;
  std::atomic<bool> done_{false};
  std::atomic<long> attempts_{0}, admitted_{0};
  std::thread thread_;
};

double Quantile(std::vector<double> values, double p) {
  std::sort(values.begin(), values.end());
  const double at = p * static_cast<double>(values.size() - 1);
  const auto k = static_cast<std::size_t>(at);
  const double next = values[std::min(k + 1, values.size() - 1)];
  return values[k] + (at - static_cast<double>(k)) * (next - values[k]);
}

// Compares loaded and idle windows of the same run. Returns the larger of two ratios: the ratio of
// the medians and the ratio of the 95th percentiles. The larger ratio must be at most kLoadCosts.
constexpr double kLoadCosts = 1.3;  // as stated in docs/getting-started/viewer.md
double Ratio(const char* what, const std::vector<double>& idle, const std::vector<double>& loaded) {
  double most = 0;
  for (const double p : {0.5, 0.95}) {
    const double ratio = Quantile(loaded, p) / Quantile(idle, p);
    std::printf("p99.9 of the %s, %.0f %% of windows: %.1f us idle, %.1f us loaded: %.2f times.\n",
                what, 100 * p, Quantile(idle, p), Quantile(loaded, p), ratio);
    most = std::max(most, ratio);
  }
  return most;
}

TEST(ViewerLoadRatio, ComparesLikeWithLike) {
  std::vector<double> idle(20, 383);
  idle.back() = idle[18] = 645;  // one more than a twentieth of the windows
  std::vector<double> loaded = idle;
  for (double& us : loaded) us *= 1.2;
  EXPECT_NEAR(Ratio("", idle, loaded), 1.2, 1e-9);
  // A higher median must be detected even if it stays below the 95th percentile of the idle
  // windows.
  for (double& us : loaded) us = 600;
  EXPECT_GT(Ratio("", idle, loaded), 1.5);
  // A higher 95th percentile must be detected even if the median is unchanged.
  loaded = idle;
  loaded.back() = loaded[18] = 1500;
  EXPECT_GT(Ratio("", idle, loaded), 2);
}

// The clients represent other machines, so they should compete with the run for the processors as
// little as possible. The program has already started, so it keeps its priority.
void BeNice() { setpriority(PRIO_PROCESS, 0, 15); }

class ViewerLoad : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_NE(program_.port(), 0);
    board_ = program_.Board();
    ASSERT_TRUE(board_);
    ASSERT_TRUE(Runs());
  }
  // Only a privileged user may undo BeNice. For other users, the next test's program stays slow.
  void TearDown() override { setpriority(PRIO_PROCESS, 0, nice_); }
  const RunBoard& board() const { return **board_; }
  // Waits at most a minute until the run has begun.
  bool Runs() const {
    TickRecord record;
    for (int i = 0; i < 6000; ++i, std::this_thread::sleep_for(milliseconds(10))) {
      const std::uint64_t written = board().records.written();
      if (written > 0 && board().records.Get(written - 1, &record) && record.run_time > 0)
        return true;
    }
    return false;
  }

  int nice_ = getpriority(PRIO_PROCESS, 0);
  Program program_{"86400"};
  std::unique_ptr<Shared<RunBoard>> board_;
};

TEST_F(ViewerLoad, TheTickDoesNotFeelTheViewersSoak) {
  BeNice();
  constexpr int kViewers = 64;
  const long pairs = Count(1, 20);
  const std::chrono::seconds window = Window(2, 60);
  std::vector<double> idle_tick, loaded_tick, idle_woken, loaded_woken;
  for (long k = 0; k < pairs; ++k) {
    const Ticks idle = Measure(board(), window);
    std::vector<std::unique_ptr<Viewer>> viewers;
    for (int i = 0; i < kViewers; ++i) {
      viewers.push_back(std::make_unique<Viewer>(program_.port(), program_.code()));
      ASSERT_TRUE(viewers.back()->welcomed());
    }
    const Attackers attackers(program_.port());
    const Ticks loaded = Measure(board(), window);
    EXPECT_GT(idle.tick_us.count(), 0u);
    EXPECT_GT(loaded.tick_us.count(), 0u);
    // If the viewers received fewer states, there was no load, or the slowest ticks were not
    // measured.
    const long least = InFull() ? window.count() : 1;
    long states = 0;
    for (const auto& viewer : viewers) {
      EXPECT_GE(viewer->states(), least);
      states += viewer->states();
    }
    EXPECT_GE(states, 10 * kViewers * (least - 1));
    EXPECT_GE(attackers.attempts(), 20 * (least - 1) + 1);
    EXPECT_EQ(attackers.admitted(), 0);
    if (InFull()) {
      EXPECT_EQ(idle.lost + loaded.lost, 0u);
    }
    idle_tick.push_back(idle.tick_us.Quantile(0.999));
    loaded_tick.push_back(loaded.tick_us.Quantile(0.999));
    idle_woken.push_back(idle.woken_us.Quantile(0.999));
    loaded_woken.push_back(loaded.woken_us.Quantile(0.999));
    std::printf(
        "Pair %ld: tick p99.9 %.1f idle, %.1f us loaded; from start to start %.1f, %.1f us; "
        "%ld states, %ld attempts.\n",
        k + 1, idle_tick.back(), loaded_tick.back(), idle_woken.back(), loaded_woken.back(), states,
        attackers.attempts());
    std::fflush(stdout);
  }
  const double tick = Ratio("ticks' time", idle_tick, loaded_tick);
  const double woken = Ratio("time from tick to tick", idle_woken, loaded_woken);
  if (!InFull()) return;  // the short tests check nothing that depends on speed
  EXPECT_LE(tick, kLoadCosts);
  EXPECT_LE(woken, kLoadCosts);
}

// Even if many clients connect and disconnect, the run must continue, and the server must admit the
// next page.
TEST_F(ViewerLoad, TenThousandConnectionAttemptsSoak) {
  BeNice();
  const long attempts = Count(500, 10'000);
  long connected = 0;
  for (long k = 0; k < attempts; ++k) {
    if (k % 50 == 0) {
      WebSocket guess(program_.port());
      connected += guess.status() == 101;
      EXPECT_EQ(guess.Hello("guess" + std::to_string(k)), "");
      continue;
    }
    Socket socket(program_.port());
    connected += socket.descriptor() >= 0;
    if (k % 3 == 1) socket.Send("GET /ws HTTP/1.1\r\n");
    if (k % 3 == 2) socket.Send(std::string(100, static_cast<char>(k)));
  }
  EXPECT_EQ(connected, attempts);
  WebSocket page(program_.port());
  ASSERT_NE(page.Hello(program_.code()), "");
  const auto leases = page.NextText("leases");
  ASSERT_TRUE(leases);
  EXPECT_NE(leases->find("\"clients\":1}"), std::string::npos) << *leases;  // the only client
  const std::uint64_t written = board().records.written();
  const Viewer viewer(program_.port(), program_.code());
  EXPECT_TRUE(viewer.welcomed());
  for (int i = 0; i < 2000 && (viewer.states() < 10 || board().records.written() <= written); ++i)
    std::this_thread::sleep_for(milliseconds(10));
  EXPECT_GE(viewer.states(), 10);
  EXPECT_GT(board().records.written(), written);
}

// Two delays [ms] from the start of a tick: until the server sends the tick, and until a client
// receives it.
struct Delays {
  std::vector<double> sent, received;
  std::size_t bytes = 0;
};

Delays Receive(WebSocket* page, std::chrono::seconds window) {
  Delays delays;
  const auto end = Clock::now() + window;
  std::uint64_t last = 0;
  while (Clock::now() < end) {
    const auto message = page->Next();
    if (!message) break;
    delays.bytes += message->payload.size() + (message->payload.size() < 126 ? 2 : 4);
    if (message->opcode != 2) continue;
    const auto now = static_cast<std::uint64_t>(Clock::now().time_since_epoch().count());
    std::uint64_t tick = 0, wall_ns = 0, sent_ns = 0;
    std::memcpy(&tick, message->payload.data() + FrameOffset("tick"), 8);
    std::memcpy(&wall_ns, message->payload.data() + FrameOffset("wall_ns"), 8);
    std::memcpy(&sent_ns, message->payload.data() + FrameOffset("sent_ns"), 8);
    EXPECT_GT(tick, last);
    last = tick;
    EXPECT_LE(wall_ns, sent_ns);
    EXPECT_LE(sent_ns, now);
    delays.sent.push_back(static_cast<double>(sent_ns - wall_ns) * 1e-6);
    delays.received.push_back(static_cast<double>(now - wall_ns) * 1e-6);
  }
  return delays;
}

// Returns the growth from the first to the last value, estimated by the median of all slopes (Theil
// and Sen). A single disturbed window then has no effect.
double Growth(const std::vector<double>& values) {
  std::vector<double> slopes;
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t k = i + 1; k < values.size(); ++k)
      slopes.push_back((values[k] - values[i]) / static_cast<double>(k - i));
  return Quantile(slopes, 0.5) * static_cast<double>(values.size() - 1);
}

// Computes Mann and Kendall's test for an upward trend in the normal approximation. Among series
// without a trend, the result of one in a hundred exceeds kTrend.
constexpr double kTrend = 2.33;
double Trend(const std::vector<double>& values) {
  double s = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t k = i + 1; k < values.size(); ++k)
      s += (values[k] > values[i]) - (values[k] < values[i]);
  const auto n = static_cast<double>(values.size());
  return (s - 1) / std::sqrt(n * (n - 1) * (2 * n + 5) / 18);
}

TEST(Trend, IsDistinguishedFromNoise) {
  EXPECT_GT(Trend({1, 2, 1.9, 3, 4, 3.8, 5, 6, 7, 8}), kTrend);
  EXPECT_LT(Trend({1, 3, 2, 1.5, 2.5, 1.2, 2.8, 2, 1.8, 2.2}), kTrend);
  EXPECT_LT(Trend(std::vector<double>(10, 1.0)), 0);
}

TEST_F(ViewerLoad, DelaysDoNotGrowSoak) {
  const long windows = Count(2, 10);
  const auto window = Window(2, 60);
  WebSocket page(program_.port());
  ASSERT_NE(page.Hello(program_.code()), "");
  std::vector<double> medians;
  for (long k = 0; k < windows; ++k) {
    const Delays delays = Receive(&page, window);
    ASSERT_FALSE(delays.received.empty());
    medians.push_back(Quantile(delays.received, 0.5));
    std::printf(
        "Window %ld: tick to sent %.2f / %.2f ms, to received %.2f / %.2f ms (p50 / p99); "
        "%.0f states and %.0f bytes a second.\n",
        k + 1, Quantile(delays.sent, 0.5), Quantile(delays.sent, 0.99), medians.back(),
        Quantile(delays.received, 0.99),
        static_cast<double>(delays.received.size()) / static_cast<double>(window.count()),
        static_cast<double>(delays.bytes) / static_cast<double>(window.count()));
    std::fflush(stdout);
  }
  const double growth = Growth(medians);
  std::printf("Growth of the median over all windows: %.2f ms; trend %.2f (%.2f is one).\n", growth,
              Trend(medians), kTrend);
  // A growth of a tenth of a tick is negligible even if it is steady.
  if (InFull()) {
    EXPECT_TRUE(Trend(medians) < kTrend || growth < 0.1) << growth << " ms";
  }
}

}  // namespace
}  // namespace predictor::viewer
