#include "devices/ur/ur_script.h"

#include <cmath>
#include <locale>
#include <sstream>

namespace predictor {
namespace {

// A counter that arrives just after the start of a cycle is read one cycle later. The program's
// decision then takes effect with the next set-point. The program must therefore decide this much
// earlier than 20 ms.
constexpr double kWatchdog = 0.018;  // [s]
constexpr double kPatience = 30;     // longest wait for the first tick [s]

// Each `$name` is replaced. A thread can access only global variables.
constexpr const char* kTemplate = R"(def predictor():
  # PREDICTOR: follows joint velocities for as long as they keep coming.
  global qd = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]

  thread follow():
    while True:
      speedj(qd, $acceleration, $cycle)
    end
  end

  def velocities():
    return [read_input_float_register($d0), read_input_float_register($d1), read_input_float_register($d2), read_input_float_register($d3), read_input_float_register($d4), read_input_float_register($d5)]
  end

  last = read_input_integer_register($counter)
  heard = False
  silent = 0
  limit = $patience
  moving = False
  follower = 0
  write_output_integer_register($echo, last)
  write_output_integer_register($state, 1)
  sync()

  while silent < limit:
    counter = read_input_integer_register($counter)
    command = read_input_integer_register($command)
    if counter == last:
      silent = silent + 1
    else:
      last = counter
      heard = True
      silent = 0
      limit = $silent
    end

    if silent < limit:
      if heard and command == 1:
        enter_critical
        qd = velocities()
        exit_critical
        if not moving:
          follower = run follow()
          moving = True
        end
      elif moving:
        write_output_integer_register($state, 3)
        kill follower
        stopj($deceleration)
        moving = False
        # That took its time: what was heard before is old.
        counter = read_input_integer_register($counter)
        last = counter
      end
      write_output_integer_register($echo, counter)
      if heard:
        write_output_integer_register($state, 2)
      end
      sync()
    end
  end

  write_output_integer_register($state, 4)
  if moving:
    kill follower
    stopj($deceleration)
  end
end
)";

std::string Number(double x) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << x;
  return text.str();
}

void Replace(std::string* text, const std::string& name, const std::string& by) {
  const std::string mark = "$" + name;
  for (std::size_t at = 0; (at = text->find(mark, at)) != std::string::npos; at += by.size())
    text->replace(at, mark.size(), by);
}

}  // namespace

int UrSilentCycles(double cycle) {
  return static_cast<int>(std::floor(kWatchdog / cycle + 1e-9)) - 1;
}

double UrWatchdog(double cycle) { return (UrSilentCycles(cycle) + 1) * cycle; }

std::string UrScript(const UrScriptOptions& options) {
  std::string text = kTemplate;
  const auto integer = [&text](const char* name, int value) {
    Replace(&text, name, std::to_string(value));
  };
  for (int joint = 0; joint < 6; ++joint)
    integer(("d" + std::to_string(joint)).c_str(), options.first_register + joint);
  for (const char* name : {"counter", "echo"}) integer(name, options.first_register);
  for (const char* name : {"command", "state"}) integer(name, options.first_register + 1);
  integer("silent", UrSilentCycles(options.cycle));
  integer("patience", static_cast<int>(std::lround(kPatience / options.cycle)));
  Replace(&text, "acceleration", Number(options.acceleration));
  Replace(&text, "deceleration", Number(options.deceleration));
  Replace(&text, "cycle", Number(options.cycle));
  return text;
}

}  // namespace predictor
