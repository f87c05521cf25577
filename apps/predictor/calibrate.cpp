#include "commissioning/calibrate.h"

#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>

#include "commands.h"
#include "commissioning/machine_file.h"
#include "commissioning/payload_check.h"
#include "commissioning/swing_file.h"
#include "core/error.h"
#include "core/format.h"
#include "core/real_time.h"
#include "devices/connect.h"
#include "models/arm_model.h"
#include "real_arms.h"
#include "terminal.h"
#include "watchdog/watchdog_process.h"

namespace predictor {
namespace {

// "2026-11-22T14-03-59", local time.
std::string Date() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H-%M-%S", &local);
  return text;
}

// A machine, some of its arms connected, and a person at the terminal.
class Commissioner {
 public:
  explicit Commissioner(const CalibrateOptions& options)
      : options_(options), machine_(LoadMachine(options.machine)), network_(SocketNetwork()) {}

  void Handle() {
    const int hand = OneHand();
    const Station& station = Connect(hand, ArmUse::kListen);
    Session session = Begin();
    const HandleCalibration found = MeasureHandle(&session, station);
    const HandlePayloadSpec before = station.spec().arm.payload;
    WriteOut(HandleText(found, before));
    MachineArm after = station.spec();
    after.arm.payload = WithCalibration(before, found);
    if (const std::string refusal = PayloadRefusal(station.facts(), after); !refusal.empty())
      session.Tell(refusal);
    Keep(&session, [&](Machine* machine) { ArmOf(machine, hand).arm.payload = after.arm.payload; });
  }

  void Bases() {
    const int kept = 1 - OneHand(1), moved = 1 - kept;
    const Station& a = Connect(kept, ArmUse::kListen);
    const Station& b = Connect(moved, ArmUse::kListen);
    Session session = Begin();
    const BaseCalibration found = MeasureBases(&session, a, b, options_.tip);
    const Pose X_WA = a.spec().arm.base.ToPose();
    WriteOut(BasesText(found, X_WA.Inverse() * b.spec().arm.base.ToPose()));
    const Pose X_WB = X_WA * found.X_AB;
    Keep(&session, [&](Machine* machine) {
      ArmOf(machine, moved).arm.base = {X_WB.p, RpyOf(X_WB.q)};
    });
  }

  void Loop() {
    const int hand = OneHand();
    const char* name = kHandNames[static_cast<std::size_t>(hand)];
    if (!machine_.arm(hand)) throw NoArm(hand);
    Session alone(network_.get(), &person_, {});
    const SwingFile file(options_.machine, name, HashOf(*machine_.arm(hand)));
    SwingFile::Kept kept = Kept(&alone, file, hand);
    if (const int before = kept.swings.measured(); !kept.swings.complete()) {
      try {
        SwingTheRest(&alone, hand, &kept.swings);
      } catch (...) {
        KeepSwings(file, before, &kept);
        throw;
      }
      KeepSwings(file, before, &kept);
    }
    const LoopFit found = Fit(&alone, file, kept.swings);
    WriteOut(LoopText(found, machine_.arm(hand)->arm.loop));
    const bool written = Keep(&alone, [&](Machine* machine) {
      MachineArm& arm = ArmOf(machine, hand);
      arm.arm.loop = found.spec();
      if (!arm.commissioned) arm.commissioned.emplace();
      arm.commissioned->loop = kept.date;
      arm.commissioned->loop_of = HashOfLoop(arm);
    });
    if (written) file.Remove();
  }

  void Push() {
    for (int hand = 0; hand < kHands; ++hand)
      if (machine_.arm(hand)) Connect(hand, ArmUse::kListen);
    Session session = Begin();
    for (int hand = 0; hand < kHands; ++hand) {
      const auto i = static_cast<std::size_t>(hand);
      if (!stations_[i] || (!options_.arm.empty() && options_.arm != kHandNames[i])) continue;
      TestPushes(&session, *stations_[i], stations_[1 - i].get());
      const std::string hash = HashOf(*machine_.arm(hand));
      session.Tell("The " + stations_[i]->name() + " handle reads as it is pushed.");
      const auto copy = ChangeMachine(options_.machine, Date(), [&](Machine* machine) {
        MachineArm& arm = ArmOf(machine, hand);
        if (HashOf(arm) != hash)
          throw InputError(options_.machine,
                           "The arm was changed meanwhile: test the pushes again.");
        if (!arm.commissioned) arm.commissioned.emplace();
        arm.commissioned->push_test = Date();
        arm.commissioned->of = hash;
      });
      session.Tell("Noted in " + options_.machine + " (before: " + copy.string() + ").");
    }
  }

 private:
  static MachineArm& ArmOf(Machine* machine, int hand) {
    std::optional<MachineArm>& arm = hand == 0 ? machine->left : machine->right;
    if (!arm) throw InputError(machine->file.string(), "The arm was removed meanwhile.");
    return *arm;
  }

  // The hand that --arm names, or the machine's only one, or, with both, `usual`.
  int OneHand(int usual = -1) const {
    if (options_.arm == kHandNames[0]) return 0;
    if (options_.arm == kHandNames[1]) return 1;
    if (machine_.left && machine_.right) {
      if (usual >= 0) return usual;
      throw InputError("The machine has two arms. Say which: --arm left or --arm right.");
    }
    return machine_.left ? 0 : 1;
  }

  InputError NoArm(int hand) const {
    return {options_.machine,
            std::string("There is no ") + kHandNames[static_cast<std::size_t>(hand)] + " arm."};
  }

  Station& Connect(int hand, ArmUse use) {
    const auto i = static_cast<std::size_t>(hand);
    if (!machine_.arm(hand)) throw NoArm(hand);
    const MachineArm& side = *machine_.arm(hand);
    person_.Tell(std::string("Connecting to the ") + kHandNames[i] +
                 " arm. (Its driver has never run on hardware by us.)");
    auto sensor = ConnectSensor(side, network_.get());
    auto arm = ConnectArm(side, use, network_.get());
    try {
      stations_[i] = std::make_unique<Station>(hand, side, std::move(arm), std::move(sensor));
    } catch (const InputError& error) {
      throw Located(error, machine_);
    }
    const DeviceFacts& facts = stations_[i]->facts();
    person_.Tell("  " + facts.name);
    for (const std::string& remark : facts.remarks) person_.Tell("  " + remark);
    if (const std::string refusal = PayloadRefusal(facts, side); !refusal.empty())
      person_.Tell("  " + refusal);
    return *stations_[i];
  }

  Session Begin() {
    std::vector<Station*> all;
    for (const auto& station : stations_)
      if (station) all.push_back(station.get());
    return {network_.get(), &person_, all};
  }

  // Of the enabling device, if the machine has one; connects to the arm that it is wired to.
  EnablingContact Contact() {
    if (!machine_.enabling) return {};
    const int hand = machine_.enabling->arm == kHandNames[0] ? 0 : 1;
    const auto i = static_cast<std::size_t>(hand);
    if (!stations_[i]) Connect(hand, ArmUse::kListen);
    return {stations_[i].get(), machine_.enabling->digital_input};
  }

  // What an earlier session that ended too soon has measured, if the person wants to go on with it.
  SwingFile::Kept Kept(Session* alone, const SwingFile& file, int hand) {
    SwingFile::Kept kept = file.Load();
    const std::string path = file.path().string();
    if (const int joints = kept.swings.joints; joints > 0 && joints != JointsOf(hand))
      kept = {{}, "", Formatted("is of %d joints, and the arm has %d", joints, JointsOf(hand))};
    if (!kept.remark.empty())
      alone->Tell(path + " " + kept.remark + ": all joints are measured anew.");
    const Swings& swings = kept.swings;
    if (swings.records.empty()) return {};
    const std::string next =
        swings.complete() ? "uses them" : Formatted("goes on with joint %d", swings.measured() + 1);
    const char key = alone->Ask(
        Formatted("Of the %s arm %d of %d joints are measured, %s (%s). Enter %s; n measures all "
                  "anew.",
                  kHandNames[static_cast<std::size_t>(hand)], swings.measured(), swings.joints,
                  kept.date.c_str(), path.c_str(), next.c_str()),
        {kEnter, 'n'});
    return key == 'n' ? SwingFile::Kept{} : kept;
  }

  // The file's hash has the model's path; what is there may have changed.
  int JointsOf(int hand) const try {
    const char* name = kHandNames[static_cast<std::size_t>(hand)];
    return LoadArmModel(machine_.arm(hand)->arm, {}, std::string("arms.") + name + ".arm")->dof();
  } catch (const InputError& error) {
    throw Located(error, machine_);
  }

  // However the session ended. before: how many of them it did not measure; their date stays where
  // it added none.
  void KeepSwings(const SwingFile& file, int before, SwingFile::Kept* kept) {
    const Swings& swings = kept->swings;
    if (swings.records.empty()) return;
    try {
      if (swings.measured() > before) file.Save(swings, kept->date = Date());
      const std::string path = file.path().string();
      person_.Tell(swings.complete()
                       ? "All joints are measured, and kept in " + path +
                             " until the loop is written."
                       : Formatted("%d of %d joints are measured, and kept in %s: the same command "
                                   "goes on from there.",
                                   swings.measured(), swings.joints, path.c_str()));
    } catch (const InputError& error) {
      person_.Tell(error.what());
    }
  }

  // Swings that nothing can be made of are not kept.
  static LoopFit Fit(Session* alone, const SwingFile& file, const Swings& swings) try {
    return FitSwings(alone, swings.records);
  } catch (const InputError&) {
    file.Remove();
    throw;
  }

  void SwingTheRest(Session* alone, int hand, Swings* swings) {
    alone->Ask(
        "Lead the " + std::string(kHandNames[static_cast<std::size_t>(hand)]) +
            " arm to a pose amid its work, leave free-drive, let the controller take commands "
            "(Remote Control, or the like), then press Enter.",
        {kEnter});
    RequireRealTime(machine_);
    Station& station = Connect(hand, ArmUse::kMove);
    const SwingOptions options{machine_.limits, Contact(), {}};
    Session session = Begin();
    Swing(&session, &station, options, swings);
  }

  // Robots whose next word is late brake by themselves; where they leave a channel open, another
  // process of ours brakes them too when this one hangs.
  void Swing(Session* session, Station* station, const SwingOptions& options, Swings* swings) {
    Shared<RunBoard> board;
    std::array<bool, kHands> moves = {};
    moves[static_cast<std::size_t>(station->hand())] = true;
    const WatchdogProcess watchdog(machine_, moves, board,
                                   [this](const std::string& text) { person_.Tell(text); });
    session->Tell("Watchdog  " + watchdog.Describe() + ".");
    const auto record = std::make_unique<TickRecord>();
    session->OnStep([&](bool moving) {
      ++record->tick;
      record->state = moving ? RunState::kAlign : RunState::kIdle;
      board->records.Publish(*record);
    });
    const RealTimeScheduling scheduling;
    session->Tell("This program: " + scheduling.got() + ".");
    SwingJoints(session, station, options, swings);
    session->OnStep({});
  }

  // Whether it was written.
  bool Keep(Session* session, const std::function<void(Machine*)>& change) {
    if (session->Ask("Write this into " + options_.machine + "? y or n", "yn") == 'n') {
      session->Tell("Nothing was written.");
      return false;
    }
    const auto copy = ChangeMachine(options_.machine, Date(), change);
    session->Tell("Written. What was there, with its comments, is in " + copy.string() +
                  ". The arm has changed: once all is measured, run `predictor calibrate push "
                  "--machine " +
                  options_.machine + "` before the next run.");
    return true;
  }

  const CalibrateOptions& options_;
  Machine machine_;
  Terminal person_;
  std::unique_ptr<Network> network_;
  std::array<std::unique_ptr<Station>, kHands> stations_;
};

}  // namespace

int CalibrateCommand(const CalibrateOptions& options) {
  Commissioner commissioner(options);
  if (options.what == "handle") commissioner.Handle();
  if (options.what == "bases") commissioner.Bases();
  if (options.what == "loop") commissioner.Loop();
  if (options.what == "push") commissioner.Push();
  return kFinished;
}

}  // namespace predictor
