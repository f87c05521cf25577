// Swings that were measured, beside the machine file until its loop is written: a session that ends
// early need not be repeated. Nothing but `calibrate loop` reads them.
#pragma once

#include <filesystem>
#include <string>

#include "commissioning/loop_record.h"

namespace predictor {

class SwingFile {
 public:
  // MACHINE.swings-left, or -right. of: a hash of the arm; swings of any other one are none.
  SwingFile(const std::filesystem::path& machine, const std::string& hand, std::string of)
      : path_(machine.string() + ".swings-" + hand), of_(std::move(of)) {}

  const std::filesystem::path& path() const { return path_; }

  struct Kept {
    Swings swings;       // none: no record
    std::string date;    // of the last one
    std::string remark;  // why what is there cannot be used; "" else
  };
  // Does not throw: what cannot be read is none.
  Kept Load() const;
  // date: a word. Throws InputError; what was there is then as it was.
  void Save(const Swings& swings, const std::string& date) const;
  void Remove() const noexcept;

 private:
  std::filesystem::path path_;
  std::string of_;
};

}  // namespace predictor
