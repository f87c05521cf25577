// The terminal as the interface of a person beside the arms: prints lines, reads single keys.
#pragma once

#include <optional>

#include "commissioning/session.h"
#include "raw_keys.h"

namespace predictor {

// Reads keys without Enter and does not show them; the destructor restores the terminal. Throws
// InputError if standard input is not a terminal. Key also throws it after Ctrl-C or if the
// terminal was closed.
class Terminal final : public commissioning::Person {
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
