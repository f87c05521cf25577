// The viewer as a process of its own beside the run: what it does, or that it dies, moves nothing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "scenario/catalogue.h"
#include "scenario/scenario.h"

namespace predictor {

// A recording that is looked at, instead of a run.
struct ReplaySpan {
  double duration = 0;           // first to last tick [s]; 0: it is a run
  std::uint64_t first_tick = 0;  // TickRecord::tick
};

struct ViewerOptions {
  std::string address;        // numeric; empty: 127.0.0.1, or 0.0.0.0 if exposed
  std::uint16_t port = 8080;  // 0: one that is free
  bool expose = false;        // other machines may reach it, as the user said; implies `tls`
  bool tls = false;
  std::filesystem::path certificate, key;     // the user's own, in PEM form; else one is made
  std::filesystem::path state_folder;         // where that is kept; empty: StateFolder()
  std::vector<std::string> names;             // more names by which this machine is called
  std::vector<std::string> foxglove_origins;  // such as https://app.foxglove.dev
  std::string secret;                         // NewAdmissionSecret(); empty: one is made
  std::vector<std::string> revoked;           // of tokens signed by it: revoked() of one before
  std::vector<ScenarioTitle> scenarios;       // what a page may choose
  std::string notice;                         // to whoever looks; empty: none
  ReplaySpan replay;
  Vector3 object_start = Vector3::Zero();  // O in W when the run starts [m]
};

// $XDG_STATE_HOME/predictor, or ~/.local/state/predictor. Throws InputError if nobody has a home.
std::filesystem::path StateFolder();

// The subcommand by which this program becomes the viewer: `predictor viewer-process`, for
// ViewerProcess alone. Everything it needs comes by descriptors 3 to 5.
inline constexpr const char* kViewerSubcommand = "viewer-process";
int ViewerMain();

class ViewerProcess {
 public:
  // What a person is to be told, a line or several; called in the viewer's own thread.
  using Tell = std::function<void(const std::string& text)>;

  // Starts it and waits until it serves. Throws InputError: the port is in use, the certificate
  // cannot be read, the address needs `expose`, ... The descriptors of `board` and `mailbox` are
  // borrowed.
  ViewerProcess(const Scenario& scenario, const ViewerOptions& options,
                const Shared<RunBoard>& board, const Shared<RunMailbox>& mailbox, Tell tell);
  ~ViewerProcess();

  // Where it is to be opened, with the code that admits; with real arms another if it had to start
  // again.
  std::string url() const;
  std::uint16_t port() const;
  std::string fingerprint() const;           // of the certificate; "" without TLS
  int pid() const;                           // 0 while there is none
  std::vector<std::string> revoked() const;  // whom Kick threw out: for ViewerOptions

  // For a person at the console; what comes of it is told. Without waiting, from any thread.
  void AskPin(const std::string& role);   // "look", "operator", "control"
  void Revoke(const std::string& lease);  // "control", "operator"
  // Throws client N out for good: its token is worth nothing any more, and with simulated arms the
  // address gets another code.
  void Kick(std::uint32_t client);
  void KickFoxglove();
  // To all pages, before the program ends: how the run did, in a sentence.
  void EndRun(const std::string& how);
  void AskFoxglove();  // an address that admits to look, for Foxglove
  void AskStatus();    // who is connected, what they hold, and their delays

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
