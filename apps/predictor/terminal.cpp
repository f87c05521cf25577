#include "terminal.h"

#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

std::atomic<bool> quit{false};

void RequestQuit(int) { quit.store(true); }

}  // namespace

Terminal::Terminal() {
  if (isatty(STDIN_FILENO) != 1)
    throw InputError(
        "This command needs a person at a terminal, but standard input is not a terminal.");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, RequestQuit);
  std::signal(SIGPIPE, SIG_IGN);  // without a reader, the arms must still come to rest
  keys_.emplace(true);
}

void Terminal::Tell(const std::string& line) {
  std::fprintf(stderr, "%s\n", Printable(line, Lines::kMany).c_str());
}

char Terminal::Key() {
  if (quit) throw InputError("Ended on request. The machine file was not changed any further.");
  pollfd ready{STDIN_FILENO, POLLIN, 0};
  if (poll(&ready, 1, 0) <= 0) return 0;
  char key = 0;
  if (read(STDIN_FILENO, &key, 1) <= 0) throw InputError("The terminal was closed.");
  return RawKeys::Read(key);
}

}  // namespace predictor
