#include "ros_tcp/ros_tcp_process.h"

#include <grp.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "core/error.h"

namespace predictor {
namespace {

constexpr uid_t kNobody = 65534;

void GiveUpRoot() {
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  if (geteuid() == 0 && (setgroups(0, nullptr) != 0 || setresgid(kNobody, kNobody, kNobody) != 0 ||
                         setresuid(kNobody, kNobody, kNobody) != 0))
    throw std::runtime_error("The ROS-TCP server cannot give up its rights as root.");
}

// In the child: says its port or what is wrong, then serves.
[[noreturn]] void Serve(const RosTcpOptions& options, const RosTopics& topics, int board,
                        int mailbox, int parent, int say) {
  std::string answer;
  try {
    const Shared<RunBoard> seen(dup(board), false);
    Shared<RunMailbox> written(dup(mailbox), true);
    RosTcpServer server(options, &topics, &*seen, &*written);
    GiveUpRoot();
    for (const int signal : {SIGINT, SIGHUP, SIGQUIT}) std::signal(signal, SIG_IGN);
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // forgotten when the user changes, hence after that
    if (getppid() != parent) std::_Exit(0);
    answer = "=" + std::to_string(server.port());
    (void)!write(say, answer.data(), answer.size());
    close(say);
    server.Run();
  } catch (const std::exception& error) {
    answer = error.what();
    (void)!write(say, answer.data(), answer.size());
  }
  std::_Exit(1);
}

}  // namespace

RosTcpProcess::RosTcpProcess(const RosTcpOptions& options, const RosTopics& topics,
                             const Shared<RunBoard>& board, const Shared<RunMailbox>& mailbox) {
  std::array<int, 2> answer{};
  const int parent = getpid();
  if (pipe(answer.data()) != 0) throw std::runtime_error("No pipe for the ROS-TCP server.");
  pid_ = fork();
  if (pid_ == 0) {
    close(answer[0]);
    Serve(options, topics, board.descriptor(), mailbox.descriptor(), parent, answer[1]);
  }
  close(answer[1]);
  std::string text;
  std::array<char, 512> bytes;
  for (ssize_t n; pid_ > 0 && (n = read(answer[0], bytes.data(), bytes.size())) > 0;)
    text.append(bytes.data(), static_cast<std::size_t>(n));
  close(answer[0]);
  if (!text.empty() && text[0] == '=') {
    port_ = static_cast<std::uint16_t>(std::stoi(text.substr(1)));
    return;
  }
  if (pid_ > 0) waitpid(pid_, nullptr, 0);
  pid_ = -1;
  throw InputError(text.empty() ? "The ROS-TCP server could not be started." : text);
}

RosTcpProcess::~RosTcpProcess() {
  if (pid_ <= 0) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

}  // namespace predictor
