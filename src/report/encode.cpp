#include "report/encode.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/text.h"

namespace predictor {
namespace {

// Beyond it, numbers in a browser are no longer exact integers.
constexpr double kMostSteps = 4e15;

double StepOf(const std::vector<double>& values, double step) {
  double low = INFINITY, high = -INFINITY;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  if (!(low <= high)) return 1;
  if (step <= 0) step = high > low ? (high - low) / 50000 : std::max(std::abs(high), 1.0) / 50000;
  const double least = std::max(std::abs(low), std::abs(high)) / kMostSteps;
  return std::max(step, least);
}

}  // namespace

std::string EncodeSteps(const std::vector<double>& values, double step) {
  std::string bytes;
  bytes.reserve(values.size() + values.size() / 4);
  std::int64_t last = 0;
  for (const double v : values) {
    if (!std::isfinite(v)) {
      bytes += '\0';
      continue;
    }
    const std::int64_t now = std::llround(v / step);
    const std::int64_t difference = now - last;
    last = now;
    std::uint64_t code = (static_cast<std::uint64_t>(difference) << 1U) ^
                         static_cast<std::uint64_t>(difference >> 63);
    ++code;
    for (; code >= 128; code >>= 7U) bytes += static_cast<char>(code | 128U);
    bytes += static_cast<char>(code);
  }
  return bytes;
}

std::string Base64(const std::string& bytes) {
  static constexpr char kLetters[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8U | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= n ? kLetters[three >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

int PageData::Add(const Samples& values, double step) {
  const auto [it, added] = numbers_.try_emplace(values.get(), static_cast<int>(kept_.size()));
  if (!added) return it->second;
  kept_.push_back(values);
  const double used = StepOf(*values, step);
  html_ += "<script type=\"text/plain\" id=\"data-" + std::to_string(it->second) +
           "\" data-count=\"" + std::to_string(values->size()) + "\" data-step=\"" +
           FormatNumber(used) + "\">" + Base64(EncodeSteps(*values, used)) + "</script>\n";
  return it->second;
}

}  // namespace predictor
