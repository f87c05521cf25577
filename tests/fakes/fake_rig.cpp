// The far end of the wire as a process of its own: one rig (arms, sensors, handles, the scenario's
// virtual operator), on whose arms fakes hang that speak real protocols over sockets.
//
//   fake_rig SCENARIO left=ur:127.0.0.2 right=franka:127.0.0.3 left=net_ft:127.0.0.4
//
// Real time, a millisecond a step. A line on standard input is obeyed, and answered by a line:
//   run | rest           the operator is told that the run is on, or over
//   state                joints and their velocities
//   mark                 from here on the true handles' motion is watched
//   motion               since mark: last moving after [s], fastest [m/s], hardest [m/s²], way [m],
//                        fastest joint [rad/s], hardest that one was told to brake [rad/s²]
//   joints left          its joints
//   lead left Q ...      a person leads the arm to these joints; without any: lets go of it
//   led left             "yes" once it is there, or "no"
//   press left X Y Z     a person presses on the handle, axes of the world [N]
//   wire left M ...      its sensor reads this matrix times what it should (nine numbers, by rows)
//   do left PLACE WHAT   of the fake that is the PLACE-th of that side (0, 1, ...), as "do left 0
//                        protective stop"
//   log left PLACE       what it has seen, then "."
//   quit
#include <poll.h>
#include <sched.h>
#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "fakes/far_rig.h"
#include "fakes/kinds.h"
#include "fakes/socket_host.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

std::uint64_t Now() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<std::uint64_t>(t.tv_sec) * 1'000'000'000ULL +
         static_cast<std::uint64_t>(t.tv_nsec);
}

void WaitUntil(std::uint64_t due) {
  const timespec t{static_cast<time_t>(due / 1'000'000'000ULL),
                   static_cast<long>(due % 1'000'000'000ULL)};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr);
}

struct Fake {
  int hand;
  std::unique_ptr<FakeDevice> device;
  std::unique_ptr<SocketHost> host;
  Mechanics* mechanics = nullptr;
};

// "left=ur:127.0.0.2,cb3,payload=1.2".
Fake ParseFake(const std::string& text) {
  const std::size_t equals = text.find('='), colon = text.find(':');
  const std::string side = text.substr(0, equals);
  if ((side != "left" && side != "right") || colon == std::string::npos || colon < equals)
    throw std::runtime_error("\"" + text + "\" is not as in left=ur:127.0.0.2.");
  std::stringstream rest(text.substr(colon + 1));
  std::string host;
  std::getline(rest, host, ',');
  FakeOptions options;
  for (std::string word; std::getline(rest, word, ',');)
    options[word.substr(0, word.find('='))] =
        word.find('=') == std::string::npos ? "" : word.substr(word.find('=') + 1);
  Fake fake{side == "left" ? 0 : 1, MakeFake(text.substr(equals + 1, colon - equals - 1), options),
            nullptr, nullptr};
  fake.host = std::make_unique<SocketHost>(host, fake.device.get());
  return fake;
}

class FarEnd {
 public:
  explicit FarEnd(const std::string& file) : rig_(LoadScenario(file)) {}

  void Add(Fake fake) {
    fake.mechanics = rig_.Hang(fake.hand);
    fakes_.push_back(std::move(fake));
  }

  void Step() {
    for (Fake& fake : fakes_) {
      fake.host->Receive();
      fake.device->Step(fake.mechanics);
    }
    rig_.Step();
  }

  // An answer of one line or several.
  std::string Obey(const std::string& line) {
    std::istringstream words(line);
    std::string what, side;
    std::size_t place = 0;
    words >> what;
    if (what == "run" || what == "rest") {
      rig_.SetRunning(what == "run");
      return "ok";
    }
    if (what == "state") return rig_.ToString();
    if (what == "mark") {
      rig_.Mark();
      return "ok";
    }
    if (what == "motion") {
      const FarRig::Motion& m = rig_.motion();
      std::ostringstream text;
      text << m.rest_after << " " << m.fastest << " " << m.hardest << " " << m.distance << " "
           << m.joint << " " << m.braking;
      return text.str();
    }
    if (!(words >> side)) return "not known: " + line;
    const int hand = side == "left" ? 0 : 1;
    if (const std::string answer = ByHand(what, hand, &words); !answer.empty()) return answer;
    return words >> place ? OfFake(what, Find(hand, place), &words) : "not known: " + line;
  }

 private:
  // What a person does at the arm; "" if it is something else.
  std::string ByHand(const std::string& what, int hand, std::istream* words) {
    if (what == "joints") {
      std::ostringstream text;
      text.precision(12);
      text << rig_.joints(hand).transpose();
      return text.str();
    }
    if (what == "led") return rig_.Led(hand) ? "yes" : "no";
    if (what != "lead" && what != "press" && what != "wire") return "";
    std::vector<double> x;
    for (double number = 0; *words >> number;) x.push_back(number);
    if (what == "lead" && (x.empty() || static_cast<long>(x.size()) == rig_.joints(hand).size())) {
      rig_.Lead(hand, Eigen::Map<Eigen::VectorXd>(x.data(), static_cast<long>(x.size())));
    } else if (what == "press" && x.size() == 3) {
      rig_.Press(hand, {x[0], x[1], x[2]});
    } else if (what == "wire" && x.size() == 9) {
      rig_.Wire(hand, Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(x.data()));
    } else {
      return "not so many numbers";
    }
    return "ok";
  }

  static std::string OfFake(const std::string& what, Fake* fake, std::istream* words) {
    if (fake == nullptr) return "no such fake";
    if (what == "log") {
      std::string text;
      for (const std::string& event : fake->device->log()) text += event + "\n";
      return text + ".";
    }
    std::string rest;
    std::getline(*words >> std::ws, rest);
    return what == "do" && fake->device->Do(rest) ? "ok" : "not known: " + what + " " + rest;
  }

  Fake* Find(int hand, std::size_t place) {
    for (Fake& fake : fakes_)
      if (fake.hand == hand && place-- == 0) return &fake;
    return nullptr;
  }

  FarRig rig_;
  std::vector<Fake> fakes_;
};

// False at the end of the input, or if asked to end.
bool Listen(FarEnd* far_end, std::string* line) {
  pollfd ready{STDIN_FILENO, POLLIN, 0};
  while (poll(&ready, 1, 0) > 0) {
    char byte = 0;
    if (read(STDIN_FILENO, &byte, 1) <= 0 || *line == "quit") return false;
    if (byte != '\n') {
      line->push_back(byte);
      continue;
    }
    if (*line == "quit") return false;
    std::cout << far_end->Obey(*line) << std::endl;
    line->clear();
  }
  return true;
}

// A controller of a robot does not wait for what else this computer does.
void AskForRealTime() {
  sched_param priority{};
  priority.sched_priority = 75;
  sched_setscheduler(0, SCHED_FIFO, &priority);
}

int Serve(int argc, char** argv) {
  if (argc < 3) throw std::runtime_error("Usage: fake_rig SCENARIO left=KIND:ADDRESS ...");
  FarEnd far_end(argv[1]);
  for (int i = 2; i < argc; ++i) far_end.Add(ParseFake(argv[i]));
  AskForRealTime();
  std::cout << "ready" << std::endl;
  std::uint64_t due = Now();
  std::string line;
  while (Listen(&far_end, &line)) {
    WaitUntil(due += 1'000'000);
    far_end.Step();
    if (Now() > due + 50'000'000) due = Now();  // what was missed is missed
  }
  return 0;
}

}  // namespace
}  // namespace predictor

int main(int argc, char** argv) {
  try {
    return predictor::Serve(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "fake_rig: " << error.what() << std::endl;
    return 2;
  }
}
