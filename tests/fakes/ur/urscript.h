// URScript, as much of it as the driver's program needs, compiled for a machine that runs it cycle
// by cycle. What is not known here is an error, as on a controller.
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace predictor::urscript {

struct Value;
using List = std::vector<Value>;

// Numbers are floats: they hold every integer of a register. A thread's handle is a number too.
struct Value : std::variant<double, bool, std::string, List> {
  using variant::variant;
};

// At a line of the program, counted from one.
class Error : public std::runtime_error {
 public:
  Error(int line, const std::string& what)
      : std::runtime_error("line " + std::to_string(line) + ": " + what) {}
};

enum class Op {
  kPush,         // value
  kLoad,         // name
  kStore,        // name: the local if there is one, else the global if there is one, else a local
  kStoreLocal,   // name
  kStoreGlobal,  // name
  kStoreItem,    // name: of value and index
  kList,         // of `number` values
  kIndex,
  kBinary,  // name: the operator
  kNot,
  kMinus,
  kJump,         // to `number`
  kJumpIfFalse,  // takes the condition
  kAnd,          // jumps if it is false and leaves it, else takes it
  kOr,           // jumps if it is true and leaves it, else takes it
  kCall,         // name, with `number` arguments
  kBuiltin,      // name, with `number` arguments
  kRun,          // name, with `number` arguments: a thread
  kReturn,
  kPop,
  kKill,
  kJoin,
  kHalt,
};

struct Instruction {
  Op op;
  int line = 0;
  int number = 0;
  std::string name;
  Value value = 0.0;
};

struct Function {
  bool thread = false;
  int entry = 0;  // in code
  std::vector<std::string> parameters;
};

struct Program {
  std::string name;
  std::vector<Instruction> code;
  std::map<std::string, Function> functions;  // the program itself among them
};

// How many arguments a builtin function takes at least and at most.
struct Arity {
  int least, most;
};
const std::map<std::string, Arity>& Builtins();

// One program: `def name(): ... end`. Throws Error.
Program Compile(const std::string& text);

// Whether a text that has arrived so far is a whole program, by its blocks and their ends.
bool Complete(const std::string& text);

}  // namespace predictor::urscript
