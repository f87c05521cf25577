// Executes a URScript program as a controller does. In each cycle, each thread runs in turn until
// it waits.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "fakes/ur/ur_controller.h"
#include "fakes/ur/urscript.h"

namespace predictor::urscript {

class Machine {
 public:
  // Both arguments must outlive the machine.
  Machine(const Program* program, UrController* controller);

  // Performs one cycle of the controller. Returns false if the program has ended. Throws Error.
  bool Cycle();

 private:
  enum class Wait { kNothing, kCycle, kStanding, kThread, kForever };

  struct Frame {
    std::size_t back;  // return address
    std::map<std::string, Value> locals;
  };
  struct Thread {
    std::size_t at = 0;  // next instruction
    std::vector<Value> stack;
    std::vector<Frame> frames;
    Wait wait = Wait::kNothing;
    long until = 0;       // cycle, or index of a thread
    bool moving = false;  // the wait belongs to a motion
  };

  bool Ready(const Thread& thread) const;
  void Run(std::size_t thread);
  void Step(Thread* thread, const Instruction& i);
  void Jumps(Thread* thread, const Instruction& i);
  void Variables(Thread* thread, const Instruction& i);
  void Threads(Thread* thread, const Instruction& i);
  void Call(Thread* thread, const Instruction& i);
  void Return(Thread* thread);
  Value Builtin(Thread* thread, const Instruction& i, const List& arguments);
  void Move(Thread* thread, const Instruction& i, Wait wait);
  long Cycles(double time) const;  // returns at least one

  const Program* program_;
  UrController* controller_;
  std::map<std::string, Value> globals_;
  std::deque<Thread> threads_;  // the first is the program itself; a handle is an index
  long cycle_ = 0;
};

}  // namespace predictor::urscript
