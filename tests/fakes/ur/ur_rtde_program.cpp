#include "fakes/ur/ur_rtde_program.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

namespace predictor {
namespace {

enum Command { kNone = 0, kSpeedj = 9, kSpeedStop = 15, kStopj = 34, kStopScript = 255 };
enum Signal { kReady = 1, kDone = 2 };

class UrRtdeProgram final : public UrProgram {
 public:
  UrRtdeProgram(std::size_t first_register, UrController* controller)
      : first_(first_register), c_(controller) {}

  const std::string& name() const override { return name_; }

  bool Cycle() override {
    const int command = c_->input_int[first_];
    if (command == kNone) {
      busy_ = false;
      Send(kReady);
    } else if (command == kSpeedj) {
      UrVector qd;
      for (std::size_t i = 0; i < qd.size(); ++i) qd[i] = Argument(i);
      c_->Speedj(qd, Argument(6));
      Send(kReady);
    } else if (!busy_) {
      busy_ = true;
      return Begin(command);
    } else if (c_->Standing()) {
      Send(kDone);
    }
    return true;
  }

 private:
  double Argument(std::size_t i) const { return c_->input_double[first_ + i]; }
  void Send(Signal signal) { c_->output_int[first_] = signal; }

  // Returns false if the command ends the program.
  bool Begin(int command) {
    if (command == kStopScript) return false;
    if (command != kSpeedStop && command != kStopj)
      throw std::runtime_error("ur_rtde's command " + std::to_string(command) +
                               " is not supported here");
    c_->Stopj(Argument(0));
    return true;
  }

  std::string name_ = "rtde_control";
  std::size_t first_;
  UrController* c_;
  bool busy_ = false;
};

}  // namespace

std::unique_ptr<UrProgram> RecogniseUrRtde(const std::string& text, UrController* controller) {
  const std::string mark = "# int register offset\n";
  const std::size_t at = text.find(mark);
  if (text.compare(0, 18, "def rtde_control()") != 0 || at == std::string::npos) return nullptr;
  const long first = std::strtol(text.c_str() + at + mark.size(), nullptr, 10);
  return std::make_unique<UrRtdeProgram>(static_cast<std::size_t>(std::clamp(first, 0L, 24L)),
                                         controller);
}

}  // namespace predictor
