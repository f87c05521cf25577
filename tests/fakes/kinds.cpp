#include "fakes/kinds.h"

#include <stdexcept>

#include "fakes/net_ft/fake_net_ft.h"

namespace predictor {
namespace {

using Make = std::unique_ptr<FakeDevice> (*)(const FakeOptions&);

// One line a fake.
const std::map<std::string, Make> kKinds = {
    {"net_ft", MakeFakeNetFt},
};

}  // namespace

std::unique_ptr<FakeDevice> MakeFake(const std::string& kind, const FakeOptions& options) {
  if (const auto it = kKinds.find(kind); it != kKinds.end()) return it->second(options);
  std::string known;
  for (const auto& [name, make] : kKinds) known += (known.empty() ? "" : ", ") + name;
  throw std::runtime_error("There is no fake \"" + kind + "\". Known: " + known + ".");
}

}  // namespace predictor
