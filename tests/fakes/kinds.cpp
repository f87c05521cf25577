#include "fakes/kinds.h"

#include <array>
#include <sstream>
#include <stdexcept>

#include "fakes/franka/fake_franka.h"
#include "fakes/net_ft/fake_net_ft.h"
#include "fakes/ur/fake_ur.h"

namespace predictor {
namespace {

using Make = std::unique_ptr<FakeDevice> (*)(const FakeOptions&);

std::uint64_t Number(const FakeOptions& options, const char* key, std::uint64_t otherwise) {
  const auto it = options.find(key);
  return it == options.end() ? otherwise : std::stoull(it->second);
}

// Parses a vector such as "x/y/z" [m].
std::array<double, 3> VectorOf(const std::string& text) {
  std::array<double, 3> x{};
  std::istringstream numbers(text);
  char slash = 0;
  numbers >> x[0] >> slash >> x[1] >> slash >> x[2];
  return x;
}

// Options of a fake UR: "cb3" for 125 Hz and no built-in sensor; "payload=0.4" and "cog=0/0/0.05"
// as set at the pendant; "model=ur10e" for an arm other than a UR5; "protocol=1" for an older RTDE.
std::unique_ptr<FakeDevice> MakeFakeUr(const FakeOptions& options) {
  FakeUrOptions ur;
  if (options.contains("cb3")) ur.version = {3, 15, 8, 0};
  if (options.contains("payload")) ur.payload = std::stod(options.at("payload"));
  if (options.contains("cog")) ur.payload_cog = VectorOf(options.at("cog"));
  for (const UrGeometry& arm : kUrGeometries)
    if (options.contains("model") && options.at("model") == arm.model) ur.geometry = arm;
  auto fake = std::make_unique<FakeUr>(ur);
  fake->rtde().newest_protocol = static_cast<std::uint16_t>(Number(options, "protocol", 2));
  return fake;
}

// Options of a fake Franka: "panda" for the older arm; "patient" if its time stops until a command
// arrives; "payload" and "cog" as for a UR; "version=9" for an unknown interface version; "first=1"
// for the number of the first state.
std::unique_ptr<FakeDevice> MakeFakeFranka(const FakeOptions& options) {
  FakeFrankaOptions franka;
  if (options.contains("panda")) franka.version = fci::kPandaVersion;
  franka.version = static_cast<std::uint16_t>(Number(options, "version", franka.version));
  franka.first_message = Number(options, "first", franka.first_message);
  franka.patient = options.contains("patient");
  if (options.contains("payload")) franka.payload = std::stod(options.at("payload"));
  if (options.contains("cog")) franka.payload_cog = VectorOf(options.at("cog"));
  return std::make_unique<FakeFranka>(franka);
}

const std::map<std::string, Make> kKinds = {
    {"franka", MakeFakeFranka},
    {"net_ft", MakeFakeNetFt},
    {"ur", MakeFakeUr},
};

}  // namespace

std::unique_ptr<FakeDevice> MakeFake(const std::string& kind, const FakeOptions& options) {
  if (const auto it = kKinds.find(kind); it != kKinds.end()) return it->second(options);
  std::string known;
  for (const auto& [name, make] : kKinds) known += (known.empty() ? "" : ", ") + name;
  throw std::runtime_error("There is no fake \"" + kind + "\". Known: " + known + ".");
}

}  // namespace predictor
