// Runs the devices as a separate process: one rig (arms, sensors, handles, the scenario's simulated
// operator), and fakes for its arms that use real protocols over sockets.
//
//   fake_rig SCENARIO left=ur:127.0.0.2 right=franka:127.0.0.3 left=net_ft:127.0.0.4
//
// The program runs in real time with steps of a millisecond. The program executes each line on
// standard input and answers with one or more lines. kHelp lists the commands.
#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <initializer_list>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "fakes/far_rig.h"
#include "fakes/kinds.h"
#include "fakes/lateness.h"
#include "fakes/socket_host.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

constexpr const char* kHelp =
    "run, rest                the person at the handles starts or stops working\n"
    "press SIDE X Y Z         pushes the handle with this force [N], axes of W; 0 0 0 ends it\n"
    "lead SIDE Q ...          guides the arm to these joint angles [rad]; no angles: releases it\n"
    "led SIDE                 prints yes if the guided arm has arrived, otherwise no\n"
    "state, joints SIDE       print the joint angles [rad]; state also prints velocities [rad/s]\n"
    "mark, motion             motion prints, since mark: time of the last motion of a handle [s],\n"
    "                         maximum speed [m/s] and acceleration [m/s^2], distance [m],\n"
    "                         maximum speed of a joint [rad/s], and its maximum commanded\n"
    "                         deceleration [rad/s^2]\n"
    "wire SIDE M ...          multiplies the sensor's readings by this matrix (9 numbers by rows)\n"
    "do SIDE PLACE EVENT      applies an event to the fake at this place of that side, from 0\n"
    "                         UR: press INPUT, release INPUT, protective stop, unlock,\n"
    "                             emergency stop, slider PERCENT, freedrive, freedrive off\n"
    "                         Franka: user stop, emergency stop, release, guide, freeze, continue\n"
    "late FROM TO             prints delays [ms] between two times of the monotonic clock [ns]:\n"
    "                         longest delay and sum of the worst processor, longest delay of the\n"
    "                         rig, longest silence of a client, longest delay of a thread of\n"
    "                         ordinary priority\n"
    "log SIDE PLACE           prints the recorded events of the fake, then a line with a dot\n"
    "help, quit               SIDE is left or right; Ctrl-D also ends the program";

double Milliseconds(std::uint64_t from, std::uint64_t to) {
  return to > from ? 1e-6 * static_cast<double>(to - from) : 0;
}

struct Fake {
  int hand;
  std::unique_ptr<FakeDevice> device;
  std::unique_ptr<SocketHost> host;
  Mechanics* mechanics = nullptr;
  bool is_arm = true;       // false: a sensor, whose client sends one request and then only listens
  std::uint64_t heard = 0;  // time of the last data from its client [ns]; 0: never
};

// Parses an argument such as "left=ur:127.0.0.2,cb3,payload=1.2".
Fake ParseFake(const std::string& text) {
  const std::size_t equals = text.find('='), colon = text.find(':');
  const std::string side = text.substr(0, equals);
  if ((side != "left" && side != "right") || colon == std::string::npos || colon < equals)
    throw std::runtime_error("\"" + text + "\" does not have the form of left=ur:127.0.0.2.");
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
  fake.is_arm = text.substr(equals + 1, colon - equals - 1) != "net_ft";
  return fake;
}

class FarEnd {
 public:
  explicit FarEnd(const std::string& file) : rig_(LoadScenario(file)) {}

  void Add(Fake fake) {
    fake.mechanics = rig_.Hang(fake.hand);
    fakes_.push_back(std::move(fake));
  }

  // `due` is the scheduled start of this step [ns].
  void Step(std::uint64_t due) {
    const std::uint64_t now = MonotonicNow();
    late_.Add(now, Milliseconds(due, now));
    for (Fake& fake : fakes_) {
      if (fake.host->Receive()) NoteSilence(&fake, now);
      fake.device->Step(fake.mechanics);
    }
    rig_.Step();
  }

  // Returns an answer of one or more lines. A command that contains an error has no effect.
  std::string Obey(const std::string& line) {
    std::istringstream words(line);
    std::string what, side;
    words >> what;
    if (OneOf(what, {"help", "run", "rest", "state", "mark", "motion"})) {
      const std::string more = Rest(&words);
      return more.empty() ? Alone(what) : what + " takes no arguments, but " + more + " was given.";
    }
    if (what == "late") return Late(&words);
    if (!OneOf(what, {"joints", "lead", "led", "press", "wire", "do", "log"}))
      return "There is no command \"" + what + "\". Type help for a list.";
    words >> side;
    if (!OneOf(side, {"left", "right"})) return what + " needs a side, left or right. See help.";
    const int hand = side == "left" ? 0 : 1;
    return OneOf(what, {"do", "log"}) ? OfFake(what, hand, &words) : ByHand(what, hand, &words);
  }

 private:
  void NoteSilence(Fake* fake, std::uint64_t now) {
    constexpr double kSilence = 4;  // two cycles of a UR [ms]
    const double silence = fake->heard == 0 ? 0 : Milliseconds(fake->heard, now);
    if (fake->is_arm && silence > kSilence) silences_.Add(now, silence);
    fake->heard = now;
  }

  std::string Late(std::istream* words) {
    std::uint64_t from = 0, to = 0;
    if (!(*words >> from >> to) || !Rest(words).empty())
      return "late takes 2 times of the monotonic clock [ns].";
    const Delay processors = processors_.Within(from, to);
    double silence = silences_.Within(from, to).longest;
    for (const Fake& fake : fakes_)  // includes a silence that still lasts
      if (fake.is_arm && fake.heard != 0)
        silence = std::max(silence, Milliseconds(std::max(from, fake.heard), to));
    std::ostringstream text;
    text << processors.longest << " " << processors.sum << " " << late_.Within(from, to).longest
         << " " << silence << " " << processors_.OrdinaryWithin(from, to).longest;
    return text.str();
  }

  static bool OneOf(const std::string& word, std::initializer_list<const char*> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
  }
  static std::string Rest(std::istream* words) {
    words->clear();
    std::string rest;
    std::getline(*words >> std::ws, rest);
    return rest;
  }

  std::string Alone(const std::string& what) {
    if (what == "help") return kHelp;
    if (what == "state") return rig_.ToString();
    if (what == "motion") {
      const FarRig::Motion& m = rig_.motion();
      std::ostringstream text;
      text << m.rest_after << " " << m.fastest << " " << m.hardest << " " << m.distance << " "
           << m.joint << " " << m.braking;
      return text.str();
    }
    if (what == "mark")
      rig_.Mark();
    else
      rig_.SetRunning(what == "run");
    return "ok";
  }

  // Performs an action of a person at the arm.
  std::string ByHand(const std::string& what, int hand, std::istream* words) {
    std::vector<double> x;
    for (double number = 0; *words >> number;) x.push_back(number);
    if (const std::string more = Rest(words); !more.empty())
      return more + " is not a number. The command was ignored.";
    const auto count = static_cast<long>(x.size()), joints = rig_.joints(hand).size();
    const long wanted = what == "press"                ? 3
                        : what == "wire"               ? 9
                        : what == "lead" && count != 0 ? joints
                                                       : 0;
    if (count != wanted)
      return what + " takes " + std::to_string(wanted) + " numbers, but " + std::to_string(count) +
             " were given. The command was ignored.";
    if (what == "led") return rig_.Led(hand) ? "yes" : "no";
    if (what == "joints") {
      std::ostringstream text;
      text.precision(12);
      text << rig_.joints(hand).transpose();
      return text.str();
    }
    if (what == "lead") rig_.Lead(hand, Eigen::Map<Eigen::VectorXd>(x.data(), count));
    if (what == "press") rig_.Press(hand, {x[0], x[1], x[2]});
    if (what == "wire")
      rig_.Wire(hand, Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(x.data()));
    return "ok";
  }

  std::string OfFake(const std::string& what, int hand, std::istream* words) {
    std::size_t place = 0;
    if (!(*words >> place))
      return what + " needs the place of a fake. 0 is the first one of that side.";
    Fake* fake = Find(hand, place);
    if (fake == nullptr) return "There is no fake at place " + std::to_string(place) + ".";
    const std::string rest = Rest(words);
    if (what == "do") return Do(fake, rest);
    if (!rest.empty()) return rest + " is not expected here.";
    std::string text;
    for (const std::string& event : fake->device->log()) text += event + "\n";
    return text + ".";
  }

  // If a command to a fake has a number, it must be the last word.
  static std::string Do(Fake* fake, const std::string& what) try {
    std::istringstream words(what);
    for (std::string word; words >> word;)
      if (std::isdigit(static_cast<unsigned char>(word[0])))
        if (const std::string more = Rest(&words); !more.empty())
          return more + " is not expected here. The command was ignored.";
    return fake->device->Do(what) ? "ok" : "That fake does not know \"" + what + "\".";
  } catch (const std::exception&) {  // an invalid number
    return "That fake cannot interpret \"" + what + "\".";
  }

  Fake* Find(int hand, std::size_t place) {
    for (Fake& fake : fakes_)
      if (fake.hand == hand && place-- == 0) return &fake;
    return nullptr;
  }

  FarRig rig_;
  std::vector<Fake> fakes_;
  ProcessorWatch processors_;
  DelayLog late_, silences_;  // delays of this loop; silences of the arms' clients
};

// Reads a line. Returns false at the end of the input or on a request to quit.
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

// A robot's controller does not wait for other processes on this computer.
void AskForRealTime() {
  sched_param priority{};
  priority.sched_priority = 75;
  sched_setscheduler(0, SCHED_FIFO, &priority);
  mlockall(MCL_CURRENT | MCL_FUTURE);
}

int Serve(int argc, char** argv) {
  if (argc < 3) throw std::runtime_error("Usage: fake_rig SCENARIO left=KIND:ADDRESS ...");
  FarEnd far_end(argv[1]);
  for (int i = 2; i < argc; ++i) far_end.Add(ParseFake(argv[i]));
  AskForRealTime();
  std::cout << "ready" << std::endl;
  std::uint64_t due = MonotonicNow();
  std::string line;
  while (Listen(&far_end, &line)) {
    WaitUntil(due += 1'000'000);
    far_end.Step(due);
    const std::uint64_t now = MonotonicNow();
    if (now > due + 50'000'000) due = now;  // skips the missed steps
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
