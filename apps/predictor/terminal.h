// The terminal as the place of a person beside the arms: lines out, single keys in.
#pragma once

#include <optional>

#include "commissioning/session.h"
#include "raw_keys.h"

namespace predictor {

// Keys come without Enter and are not shown; the terminal is put back at the end. Throws InputError
// if standard input is no terminal, and, from Key, once Ctrl-C was pressed or the terminal is gone.
class Terminal final : public Person {
 public:
  Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  void Tell(const std::string& line) override;
  char Key() override;

 private:
  std::optional<RawKeys> keys_;
};

}  // namespace predictor
