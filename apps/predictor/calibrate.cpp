#include "commissioning/calibrate.h"

#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <optional>

#include "calibrate_json.h"
#include "commands.h"
#include "commissioning/arm_checks.h"
#include "commissioning/machine_file.h"
#include "commissioning/swing_file.h"
#include "core/error.h"
#include "core/format.h"
#include "core/heartbeat.h"
#include "core/message_catalogue.h"
#include "core/real_time.h"
#include "core/text.h"
#include "core/words.h"
#include "devices/connect.h"
#include "emulator/emulator.h"
#include "models/arm_model.h"
#include "quit.h"
#include "raw_keys.h"
#include "real_arms.h"
#include "watchdog/watchdog_process.h"

namespace predictor {
namespace {

// Returns the local time in a form such as "2026-11-22T14-03-59".
std::string Date() { return LocalTime("%Y-%m-%dT%H-%M-%S", std::time(nullptr)); }

using Json = nlohmann::ordered_json;

// The terminal at which a person beside the arms controls the calibration.
// This class prints lines. It reads keys without waiting for Enter, and does not show these keys.
// The destructor restores the terminal. The constructor throws InputError if standard input is not
// a terminal. The function Key also throws InputError, after Ctrl-C and if the terminal was closed.
class Terminal final : public commissioning::Person {
 public:
  Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  void Show(const std::string& line) override;
  char Key() override;

 private:
  std::optional<RawKeys> keys_;
};

Terminal::Terminal() {
  if (isatty(STDIN_FILENO) != 1)
    throw InputError(
        "This command needs a person at a terminal, but standard input is not a terminal.");
  QuitOn({SIGINT, SIGTERM, SIGHUP, SIGQUIT});
  keys_.emplace(true);
}

void Terminal::Show(const std::string& line) {
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

// A calibration session: a machine, its connected arms, and a person at the terminal. Each function
// for a step of the calibration returns the result of this step.
class Commissioner {
 public:
  explicit Commissioner(const CalibrateOptions& options)
      : options_(options), machine_(LoadMachine(options.machine)), network_(SocketNetwork()) {}

  Json Handle() {
    const int hand = OneHand();
    const commissioning::Station& station = Connect(hand, ArmUse::kListen);
    commissioning::Session session = Begin();
    const commissioning::HandleCalibration found = commissioning::MeasureHandle(&session, station);
    const HandlePayloadSpec before = station.spec().arm.payload;
    options_.Print(commissioning::HandleText(found, before));
    MachineArm after = station.spec();
    after.arm.payload = commissioning::WithCalibration(before, found);
    if (const std::string refusal = commissioning::PayloadRefusal(station.facts(), after);
        !refusal.empty())
      session.Show(refusal);
    return Keep(&session, hand, ToJson(found),
                [&](Machine* machine) { ArmOf(machine, hand).arm.payload = after.arm.payload; });
  }

  Json Bases() {
    const int kept = 1 - OneHand(1), moved = 1 - kept;
    const commissioning::Station& a = Connect(kept, ArmUse::kListen);
    const commissioning::Station& b = Connect(moved, ArmUse::kListen);
    commissioning::Session session = Begin();
    const commissioning::BaseCalibration found =
        commissioning::MeasureBases(&session, a, b, options_.tip);
    const Pose X_RA = a.spec().arm.base.X_RB();
    options_.Print(commissioning::BasesText(found, X_RA.Inverse() * b.spec().arm.base.X_RB()));
    const Pose X_RB = X_RA * found.X_AB;
    return Keep(&session, moved, ToJson(found, X_RB), [&](Machine* machine) {
      ArmOf(machine, moved).arm.base = {X_RB.p, RpyOf(X_RB.q)};
    });
  }

  Json Loop() {
    const int hand = OneHand();
    const char* name = HandName(hand);
    if (!machine_.arm(hand)) throw NoArm(hand);
    commissioning::Session alone(network_.get(), &person_, {});
    const commissioning::SwingFile file(options_.machine, name, HashOf(*machine_.arm(hand)));
    commissioning::SwingFile::Kept kept = Kept(&alone, file, hand);
    if (const int before = kept.swings.measured(); !kept.swings.complete()) {
      try {
        SwingTheRest(&alone, hand, &kept.swings);
      } catch (...) {
        KeepSwings(file, before, &kept);
        throw;
      }
      KeepSwings(file, before, &kept);
    }
    const commissioning::LoopFit found = Fit(&alone, file, kept.swings);
    options_.Print(commissioning::LoopText(found, machine_.arm(hand)->arm.loop));
    Json result = Keep(&alone, hand, ToJson(found), [&](Machine* machine) {
      MachineArm& arm = ArmOf(machine, hand);
      arm.arm.loop = found.spec();
      if (!arm.commissioned) arm.commissioned.emplace();
      arm.commissioned->loop = kept.date;
      arm.commissioned->loop_of = HashOfLoop(arm);
    });
    if (result["written"]) file.Remove();
    return result;
  }

  Json Push() {
    for (int hand = 0; hand < kHands; ++hand)
      if (machine_.arm(hand)) Connect(hand, ArmUse::kListen);
    commissioning::Session session = Begin();
    Json passed = Json::array();
    for (int hand = 0; hand < kHands; ++hand) {
      const auto i = static_cast<std::size_t>(hand);
      if (!stations_[i] || (!options_.arm.empty() && options_.arm != kHandNames[i])) continue;
      commissioning::TestPushes(&session, *stations_[i], stations_[1 - i].get());
      const std::string hash = HashOf(*machine_.arm(hand));
      session.Show("The " + stations_[i]->name() + " handle's readings agree with the pushes.");
      const auto copy =
          commissioning::ChangeMachine(options_.machine, Date(), [&](Machine* machine) {
            MachineArm& arm = ArmOf(machine, hand);
            if (HashOf(arm) != hash)
              throw InputError(
                  options_.machine,
                  "The arm's settings were changed during the test. Repeat the push test.");
            if (!arm.commissioned) arm.commissioned.emplace();
            arm.commissioned->push_test = Date();
            arm.commissioned->of = hash;
          });
      session.Show("Result written to " + options_.machine +
                   " (copy of the old file: " + copy.string() + ").");
      passed.push_back({{"arm", kHandNames[i]}, {"copy", copy.string()}});
    }
    return {{"step", "push"}, {"machine", options_.machine}, {"passed", passed}};
  }

 private:
  static MachineArm& ArmOf(Machine* machine, int hand) {
    std::optional<MachineArm>& arm = hand == 0 ? machine->left : machine->right;
    if (!arm)
      throw InputError(machine->file.string(),
                       "The arm was removed from the machine file during the calibration.");
    return *arm;
  }

  // Returns the index of the hand to use: the hand that --arm names or, without --arm, the
  // machine's only hand. If the machine has two hands and --arm is missing, returns `usual`.
  int OneHand(int usual = -1) const {
    if (options_.arm == kHandNames[0]) return 0;
    if (options_.arm == kHandNames[1]) return 1;
    if (machine_.left && machine_.right) {
      if (usual >= 0) return usual;
      throw InputError("The machine has two arms. Choose one: --arm left or --arm right.");
    }
    return machine_.left ? 0 : 1;
  }

  InputError NoArm(int hand) const {
    return {options_.machine, std::string("There is no ") + HandName(hand) + " arm."};
  }

  commissioning::Station& Connect(int hand, ArmUse use) {
    const auto i = static_cast<std::size_t>(hand);
    if (!machine_.arm(hand)) throw NoArm(hand);
    const MachineArm& side = *machine_.arm(hand);
    person_.Show(std::string("Connecting to the ") + kHandNames[i] +
                 " arm. (We have never run its driver on hardware.)");
    auto sensor = ConnectSensor(side, network_.get());
    auto arm = ConnectArm(side, use, network_.get());
    try {
      stations_[i] =
          std::make_unique<commissioning::Station>(hand, side, std::move(arm), std::move(sensor));
    } catch (const InputError& error) {
      throw Located(error, machine_);
    }
    const DeviceFacts& facts = stations_[i]->facts();
    person_.Show("  " + facts.name);
    for (const std::string& remark : facts.remarks) person_.Show("  " + remark);
    if (const std::string refusal = commissioning::PayloadRefusal(facts, side); !refusal.empty())
      person_.Show("  " + refusal);
    return *stations_[i];
  }

  commissioning::Session Begin() {
    std::vector<commissioning::Station*> all;
    for (const auto& station : stations_)
      if (station) all.push_back(station.get());
    return {network_.get(), &person_, all};
  }

  // Returns the contact of the enabling device, if the machine has one. Connects to the arm to
  // which the enabling device is wired.
  commissioning::EnablingContact Contact() {
    if (!machine_.enabling) return {};
    const int hand = machine_.enabling->arm == kHandNames[0] ? 0 : 1;
    const auto i = static_cast<std::size_t>(hand);
    if (!stations_[i]) Connect(hand, ArmUse::kListen);
    return {stations_[i].get(), machine_.enabling->digital_input};
  }

  // Returns measurements of an earlier, incomplete session if the person wants to continue it.
  commissioning::SwingFile::Kept Kept(commissioning::Session* alone,
                                      const commissioning::SwingFile& file, int hand) {
    commissioning::SwingFile::Kept kept = file.Load();
    const std::string path = file.path().string();
    if (const int joints = kept.swings.joints; joints > 0 && joints != JointsOf(hand))
      kept = {{}, "", Formatted("has %d joints, but the arm has %d", joints, JointsOf(hand))};
    if (!kept.remark.empty())
      alone->Show(path + " " + kept.remark + ". All joints will be measured again.");
    const commissioning::Swings& swings = kept.swings;
    if (swings.records.empty()) return {};
    const std::string next = swings.complete()
                                 ? "use these results"
                                 : Formatted("continue with joint %d", swings.measured() + 1);
    const char key =
        alone->Ask(Formatted("For the %s arm, %d of %d joints were measured on %s (%s). Press "
                             "Enter to %s, or n to measure all joints again.",
                             HandName(hand), swings.measured(), swings.joints, kept.date.c_str(),
                             path.c_str(), next.c_str()),
                   {commissioning::kEnter, 'n'});
    return key == 'n' ? commissioning::SwingFile::Kept{} : kept;
  }

  // The hash of the machine file covers the path of the model but not the model itself, which may
  // have changed.
  int JointsOf(int hand) const try {
    const char* name = HandName(hand);
    const ArmSpec& arm = machine_.arm(hand)->arm;
    return LoadArmModel(arm, arm.base.X_RB(), {}, std::string("arms.") + name + ".arm")->dof();
  } catch (const InputError& error) {
    throw Located(error, machine_);
  }

  // The session calls this function at its end, even after an error. `before` is the number of
  // swings from earlier sessions. If this session added no swings, the date of the earlier swings
  // is kept.
  void KeepSwings(const commissioning::SwingFile& file, int before,
                  commissioning::SwingFile::Kept* kept) {
    const commissioning::Swings& swings = kept->swings;
    if (swings.records.empty()) return;
    try {
      if (swings.measured() > before) file.Save(swings, kept->date = Date());
      const std::string path = file.path().string();
      person_.Show(swings.complete()
                       ? "All joints have been measured. The results are kept in " + path +
                             " until the loop is written to the machine file."
                       : Formatted("%d of %d joints have been measured. The results are kept in "
                                   "%s. Run the same command again to continue.",
                                   swings.measured(), swings.joints, path.c_str()));
    } catch (const InputError& error) {
      person_.Show(error.what());
    }
  }

  // Fits the loop to the swings. If this fails, removes the file in which the swings are stored.
  static commissioning::LoopFit Fit(commissioning::Session* alone,
                                    const commissioning::SwingFile& file,
                                    const commissioning::Swings& swings) try {
    return commissioning::FitSwings(alone, swings.records);
  } catch (const InputError&) {
    file.Remove();
    throw;
  }

  void SwingTheRest(commissioning::Session* alone, int hand, commissioning::Swings* swings) {
    alone->Ask("Guide the " + std::string(HandName(hand)) +
                   " arm to a typical working pose. Leave free-drive and switch the controller to "
                   "remote control. Then press Enter.",
               {commissioning::kEnter});
    RequireRealTime(machine_);
    commissioning::Station& station = Connect(hand, ArmUse::kMove);
    const commissioning::SwingOptions options{machine_.limits, Contact(), {}};
    commissioning::Session session = Begin();
    Swing(&session, &station, options, swings);
  }

  // Robots brake by themselves if the next command is late. If the robots accept a second channel,
  // a watchdog process also brakes them when this process hangs.
  void Swing(commissioning::Session* session, commissioning::Station* station,
             const commissioning::SwingOptions& options, commissioning::Swings* swings) {
    Shared<RunBoard> board;
    std::array<bool, kHands> moves = {};
    moves[static_cast<std::size_t>(station->hand())] = true;
    const watchdog::WatchdogProcess watchdog(
        machine_, moves, board, [this](const std::string& text) { person_.Show(text); });
    session->Show("Watchdog  " + watchdog.Describe() + ".");
    const auto record = std::make_unique<TickRecord>();
    Heartbeat heartbeat;
    session->OnStep([&](bool moving) -> std::string {
      ++record->tick;
      record->state = moving ? RunState::kAlign : RunState::kIdle;
      board->records.Publish(*record);
      const double silence = heartbeat.Silence(watchdog.beats(), network_->Now());
      if (silence <= kWatchdogSilence) return "";
      return CauseWords({StopCause::kWatchdog, -1, silence, kWatchdogSilence}) + ". " +
             CauseAdvice({StopCause::kWatchdog}) + " " + Message("next.again");
    });
    const RealTimeScheduling scheduling;
    session->Show("Real-time scheduling: " + scheduling.got() + ".");
    commissioning::SwingJoints(session, station, options, swings);
    session->OnStep({});
  }

  // Asks whether to write the values that `found` describes, and writes them if the person agrees.
  // Returns the step's result.
  Json Keep(commissioning::Session* session, int hand, const Json& found,
            const std::function<void(Machine*)>& change) {
    Json result = {{"step", options_.what},
                   {"machine", options_.machine},
                   {"arm", kHandNames[static_cast<std::size_t>(hand)]},
                   {"found", found},
                   {"written", false},
                   {"copy", nullptr}};
    if (session->Ask("Write these values to " + options_.machine + "? Press y or n.", "yn") ==
        'n') {
      session->Show("Nothing was written.");
      return result;
    }
    const auto copy = commissioning::ChangeMachine(options_.machine, Date(), change);
    session->Show("Written. The old file, with its comments, was kept as " + copy.string() +
                  ". The arm's settings have changed: when all calibration steps are done, run "
                  "`predictor calibrate push --machine " +
                  options_.machine + "` before the next run.");
    result["written"] = true;
    result["copy"] = copy.string();
    return result;
  }

  const CalibrateOptions& options_;
  Machine machine_;
  Terminal person_;
  std::unique_ptr<Network> network_;
  std::array<std::unique_ptr<commissioning::Station>, kHands> stations_;
};

}  // namespace

int CalibrateCommand(const CalibrateOptions& options) {
  options.CheckWritable();
  Commissioner commissioner(options);
  const Json result = options.what == "handle"  ? commissioner.Handle()
                      : options.what == "bases" ? commissioner.Bases()
                      : options.what == "loop"  ? commissioner.Loop()
                                                : commissioner.Push();
  options.WriteJson(result.dump(2) + "\n");
  return kFinished;
}

}  // namespace predictor
