// The subset of URScript that the driver's program needs. A program is compiled for a machine that
// executes it cycle by cycle. Unknown names are errors, as on a controller.
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace predictor::urscript {

struct Value;
using List = std::vector<Value>;

// All numbers are floating-point numbers, which represent every integer of a register exactly. The
// handle of a thread is also a number.
struct Value : std::variant<double, bool, std::string, List> {
  using variant::variant;
};

// An error at a line of the program, counted from one.
class Error : public std::runtime_error {
 public:
  Error(int line, const std::string& what)
      : std::runtime_error("line " + std::to_string(line) + ": " + what) {}
};

enum class Op {
  kPush,         // value
  kLoad,         // name
  kStore,        // name: an existing local, otherwise an existing global, otherwise a new local
  kStoreLocal,   // name
  kStoreGlobal,  // name
  kStoreItem,    // name: stores a value at an index
  kList,         // made of `number` values
  kIndex,
  kBinary,  // name: the operator
  kNot,
  kMinus,
  kJump,         // to `number`
  kJumpIfFalse,  // takes the condition
  kAnd,          // if false, jumps and keeps it; otherwise removes it
  kOr,           // if true, jumps and keeps it; otherwise removes it
  kCall,         // name, with `number` arguments
  kBuiltin,      // name, with `number` arguments
  kRun,          // name, with `number` arguments: starts a thread
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
  int entry = 0;  // index in the code
  std::vector<std::string> parameters;
};

struct Program {
  std::string name;
  std::vector<Instruction> code;
  std::map<std::string, Function> functions;  // including the program itself
};

// The minimum and maximum number of arguments of a built-in function.
struct Arity {
  int least, most;
};
const std::map<std::string, Arity>& Builtins();

// Compiles one program, `def name(): ... end`. Throws Error.
Program Compile(const std::string& text);

// Returns whether the text received so far is a complete program, in which every block is closed.
bool Complete(const std::string& text);

}  // namespace predictor::urscript
