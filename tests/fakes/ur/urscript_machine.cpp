#include "fakes/ur/urscript_machine.h"

#include <cmath>
#include <utility>

namespace predictor::urscript {
namespace {

// A thread that executes this many instructions without a wait would exceed a controller's cycle.
constexpr int kMaxInstructions = 20000;

template <class T>
T As(const Value& value, const Instruction& i) {
  if (const T* found = std::get_if<T>(&value)) return *found;
  throw Error(i.line, "a value is of the wrong type");
}
double Number(const Value& value, const Instruction& i) { return As<double>(value, i); }

std::size_t Index(const Value& value, std::size_t size, const Instruction& i) {
  const double x = Number(value, i);
  if (!(x >= 0 && x < static_cast<double>(size)) || x != std::floor(x))
    throw Error(i.line, "an index is out of range");
  return static_cast<std::size_t>(x);
}

UrVector Joints(const Value& value, const Instruction& i) {
  const List list = As<List>(value, i);
  UrVector joints{};
  if (list.size() != joints.size()) throw Error(i.line, "six joints expected");
  for (std::size_t j = 0; j < joints.size(); ++j) joints[j] = Number(list[j], i);
  return joints;
}

Value Pop(std::vector<Value>* stack) {
  Value value = std::move(stack->back());
  stack->pop_back();
  return value;
}

Value Binary(const Instruction& i, const Value& left, const Value& right) {
  const std::string& op = i.name;
  if (op == "==") return left == right;
  if (op == "!=") return left != right;
  const double a = Number(left, i), b = Number(right, i);
  if (op == "<") return a < b;
  if (op == ">") return a > b;
  if (op == "<=") return a <= b;
  if (op == ">=") return a >= b;
  if (op == "+") return a + b;
  if (op == "-") return a - b;
  if (op == "*") return a * b;
  if (b == 0) throw Error(i.line, "division by zero");
  return op == "/" ? a / b : std::fmod(a, b);
}

}  // namespace

Machine::Machine(const Program* program, UrController* controller)
    : program_(program), controller_(controller) {
  Thread main;
  main.at = static_cast<std::size_t>(program->functions.at(program->name).entry);
  main.frames.push_back({program->code.size(), {}});
  threads_.push_back(std::move(main));
}

bool Machine::Cycle() {
  for (std::size_t t = 0; t < threads_.size(); ++t)  // including threads that start during this
                                                     // cycle
    if (Ready(threads_[t])) Run(t);
  ++cycle_;
  return threads_[0].wait != Wait::kForever;
}

bool Machine::Ready(const Thread& thread) const {
  switch (thread.wait) {
    case Wait::kNothing:
      return true;
    case Wait::kCycle:
      return cycle_ >= thread.until;
    case Wait::kStanding:
      return controller_->Standing();
    case Wait::kThread:
      return threads_[static_cast<std::size_t>(thread.until)].wait == Wait::kForever;
    case Wait::kForever:
      return false;
  }
  return false;
}

void Machine::Run(std::size_t t) {
  Thread& thread = threads_[t];  // a deque keeps this reference valid when threads are added
  thread.wait = Wait::kNothing;
  thread.moving = false;
  for (int n = 0; thread.wait == Wait::kNothing; ++n) {
    const Instruction& i = program_->code[thread.at];
    if (n == kMaxInstructions) throw Error(i.line, "a thread runs without waiting");
    ++thread.at;
    Step(&thread, i);
    // When the program ends, its threads end too.
    if (threads_[0].wait == Wait::kForever)
      for (Thread& other : threads_) other.wait = Wait::kForever;
  }
}

void Machine::Step(Thread* thread, const Instruction& i) {
  auto& stack = thread->stack;
  switch (i.op) {
    case Op::kPush:
      stack.push_back(i.value);
      return;
    case Op::kPop:
      stack.pop_back();
      return;
    case Op::kBinary: {
      const Value right = Pop(&stack);
      stack.back() = Binary(i, stack.back(), right);
      return;
    }
    case Op::kNot:
      stack.back() = !As<bool>(stack.back(), i);
      return;
    case Op::kMinus:
      stack.back() = -Number(stack.back(), i);
      return;
    case Op::kJump:
    case Op::kJumpIfFalse:
    case Op::kAnd:
    case Op::kOr:
      return Jumps(thread, i);
    case Op::kLoad:
    case Op::kStore:
    case Op::kStoreLocal:
    case Op::kStoreGlobal:
    case Op::kStoreItem:
    case Op::kList:
    case Op::kIndex:
      return Variables(thread, i);
    case Op::kRun:
    case Op::kKill:
    case Op::kJoin:
    case Op::kHalt:
      return Threads(thread, i);
    case Op::kCall:
    case Op::kBuiltin:
      return Call(thread, i);
    case Op::kReturn:
      return Return(thread);
  }
}

void Machine::Jumps(Thread* thread, const Instruction& i) {
  const auto jump = [&] { thread->at = static_cast<std::size_t>(i.number); };
  if (i.op == Op::kJump) return jump();
  const bool condition = As<bool>(thread->stack.back(), i);
  if (i.op == Op::kJumpIfFalse) {
    thread->stack.pop_back();
    if (!condition) jump();
  } else if (condition == (i.op == Op::kOr)) {
    jump();
  } else {
    thread->stack.pop_back();
  }
}

void Machine::Variables(Thread* thread, const Instruction& i) {
  auto& stack = thread->stack;
  auto& locals = thread->frames.back().locals;
  const auto find = [&]() -> Value* {
    if (const auto local = locals.find(i.name); local != locals.end()) return &local->second;
    if (const auto global = globals_.find(i.name); global != globals_.end()) return &global->second;
    return nullptr;
  };
  const auto known = [&]() -> Value& {
    Value* value = find();
    if (value == nullptr) throw Error(i.line, "unknown variable '" + i.name + "'");
    return *value;
  };
  switch (i.op) {
    case Op::kLoad:
      stack.push_back(known());
      return;
    case Op::kStoreLocal:
      locals[i.name] = Pop(&stack);
      return;
    case Op::kStoreGlobal:
      globals_[i.name] = Pop(&stack);
      return;
    case Op::kStoreItem: {
      const Value value = Pop(&stack), at = Pop(&stack);
      auto* list = std::get_if<List>(&known());
      if (list == nullptr) throw Error(i.line, "'" + i.name + "' is not a list");
      (*list)[Index(at, list->size(), i)] = value;
      return;
    }
    case Op::kList: {
      const auto first = stack.end() - i.number;
      List list(first, stack.end());
      stack.erase(first, stack.end());
      stack.emplace_back(std::move(list));
      return;
    }
    case Op::kIndex: {
      const Value at = Pop(&stack);
      const List list = As<List>(Pop(&stack), i);
      stack.push_back(list[Index(at, list.size(), i)]);
      return;
    }
    default: {
      Value* value = find();
      (value != nullptr ? *value : locals[i.name]) = Pop(&stack);
    }
  }
}

void Machine::Threads(Thread* thread, const Instruction& i) {
  if (i.op == Op::kHalt) {
    threads_[0].wait = Wait::kForever;
    return;
  }
  if (i.op == Op::kRun) {
    Thread begun;
    begun.at = program_->code.size();
    begun.stack.assign(thread->stack.end() - i.number, thread->stack.end());
    thread->stack.erase(thread->stack.end() - i.number, thread->stack.end());
    Call(&begun, i);
    thread->stack.emplace_back(static_cast<double>(threads_.size()));
    threads_.push_back(std::move(begun));
    return;
  }
  const std::size_t other = Index(Pop(&thread->stack), threads_.size(), i);
  if (i.op == Op::kKill) {
    threads_[other].wait = Wait::kForever;
    threads_[other].moving = false;
  } else {
    thread->wait = Wait::kThread;
    thread->until = static_cast<long>(other);
  }
}

void Machine::Call(Thread* thread, const Instruction& i) {
  const auto first = thread->stack.end() - i.number;
  const List arguments(first, thread->stack.end());
  thread->stack.erase(first, thread->stack.end());
  if (i.op == Op::kBuiltin) {
    thread->stack.push_back(Builtin(thread, i, arguments));
    return;
  }
  const Function& function = program_->functions.at(i.name);
  Frame frame{thread->at, {}};
  for (std::size_t k = 0; k < arguments.size(); ++k)
    frame.locals[function.parameters[k]] = arguments[k];
  if (thread->frames.size() > 100) throw Error(i.line, "calls are nested too deeply");
  thread->frames.push_back(std::move(frame));
  thread->at = static_cast<std::size_t>(function.entry);
}

void Machine::Return(Thread* thread) {
  thread->at = thread->frames.back().back;
  thread->frames.pop_back();
  if (thread->frames.empty()) thread->wait = Wait::kForever;
}

long Machine::Cycles(double time) const {
  return std::max(1L, std::lround(std::ceil(time / controller_->cycle - 1e-9)));
}

// If two threads move the arm at the same time, the URScript program ends with an error.
void Machine::Move(Thread* thread, const Instruction& i, Wait wait) {
  for (const Thread& other : threads_)
    if (other.moving && other.wait != Wait::kForever)
      throw Error(i.line, "another thread is already controlling the robot");
  thread->wait = wait;
  thread->moving = true;
}

Value Machine::Builtin(Thread* thread, const Instruction& i, const List& a) {
  UrController& c = *controller_;
  const auto number = [&](std::size_t k) { return Number(a[k], i); };
  const auto at = [&] { return Index(a[0], UrController::kRegisters, i); };
  const auto wait = [&](double time) {
    thread->wait = Wait::kCycle;
    thread->until = cycle_ + Cycles(time);
  };
  if (i.name == "read_input_float_register") return c.input_double[at()];
  if (i.name == "read_input_integer_register") return static_cast<double>(c.input_int[at()]);
  if (i.name == "write_output_float_register") c.output_double[at()] = number(1);
  if (i.name == "write_output_integer_register")
    c.output_int[at()] = static_cast<std::int32_t>(number(1));
  if (i.name == "get_steptime") return c.cycle;
  if (i.name == "sync") wait(0);
  if (i.name == "sleep") wait(number(0));
  if (i.name == "speedj") {
    Move(thread, i, Wait::kCycle);
    c.Speedj(Joints(a[0], i), number(1));
    wait(a.size() > 2 ? number(2) : 0);
  }
  if (i.name == "stopj") {
    Move(thread, i, Wait::kStanding);
    c.Stopj(number(0));
  }
  return 0.0;
}

}  // namespace predictor::urscript
