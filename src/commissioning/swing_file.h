// Stores measured swings in a file next to the machine file, until the arm's loop is written to the
// machine file. An interrupted session therefore need not be repeated. Only `calibrate loop` reads
// these swings.
#pragma once

#include <filesystem>
#include <string>

#include "commissioning/loop_record.h"

namespace predictor::commissioning {

class SwingFile {
 public:
  // The file is MACHINE.swings-left or MACHINE.swings-right. `of` is a hash of the arm. Swings
  // recorded for a different arm are ignored.
  SwingFile(const std::filesystem::path& machine, const std::string& hand, std::string of)
      : path_(machine.string() + ".swings-" + hand), of_(std::move(of)) {}

  const std::filesystem::path& path() const { return path_; }

  struct Kept {
    Swings swings;       // empty without a record
    std::string date;    // date of the last swing
    std::string remark;  // why an existing file cannot be used; empty without a problem
  };
  // The function does not throw. A file that cannot be read counts as absent.
  Kept Load() const;
  // `date` is one word. Throws InputError, in which case the old file is unchanged.
  void Save(const Swings& swings, const std::string& date) const;
  void Remove() const noexcept;

 private:
  std::filesystem::path path_;
  std::string of_;
};

}  // namespace predictor::commissioning
