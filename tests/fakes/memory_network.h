// Connects fakes through memory in virtual time, so that the behaviour of a driver depends only on
// the bytes.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "devices/wire/network.h"
#include "fakes/far_end.h"

namespace predictor {

class MemoryNetwork final : public Network {
 public:
  MemoryNetwork();
  ~MemoryNetwork() override;

  // Makes `device` answer at `host`. The device must outlive the network. `mechanics` belongs to
  // the device's arm.
  void Add(const std::string& host, FakeDevice* device, Mechanics* mechanics);
  // Sets a function that moves the arms. The network calls this function every millisecond of
  // virtual time, after the steps of the fakes.
  void SetWorld(std::function<void()> step) { world_ = std::move(step); }
  // Lets this much virtual time pass, in whole milliseconds [s].
  void Pass(double time);

  std::unique_ptr<Stream> Connect(const Address& peer, double timeout) override;
  std::unique_ptr<Datagrams> Open(const Address& peer, std::uint16_t port) override;
  std::uint64_t Now() const noexcept override { return now_; }
  void Wait(double time) override { Pass(time); }

  struct Host;

 private:
  std::uint64_t now_ = 1'000'000'000;  // [ns]
  std::function<void()> world_;
  std::map<std::string, std::unique_ptr<Host>> hosts_;
  std::uint16_t next_port_ = 50000;
};

}  // namespace predictor
