#include "recording/disk_rules.h"

#include "recording/mcap_file.h"

namespace predictor::recording {
namespace {

constexpr std::chrono::milliseconds kPeriod{500};  // interval of the checks

std::string Gigabytes(std::uint64_t bytes) {
  const std::uint64_t tenths = bytes / 100'000'000;
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " GB";
}

}  // namespace

std::string DiskWatch::Look(const McapFile& file) {
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_ < kPeriod) return "";
  looked_ = now;
  free_ = file.FreeBytes();
  if (free_ < rules_.end_below)
    return "only " + Gigabytes(free_) + " are free on its disk, and recording stops below " +
           Gigabytes(rules_.end_below);
  if (free_ >= rules_.warn_below || warned_) return "";
  warned_ = true;
  if (rules_.notify)
    rules_.notify(file.path() + ": Only " + Gigabytes(free_) +
                  " are free on the recording's disk. Recording stops below " +
                  Gigabytes(rules_.end_below) + ".");
  return "";
}

}  // namespace predictor::recording
