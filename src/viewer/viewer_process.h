// The viewer, which is a separate process alongside the run. Neither its actions nor its end can
// cause motion.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "process/supervised_process.h"
#include "scenario/catalogue.h"
#include "scenario/scenario.h"
#include "viewer/admission.h"

namespace predictor::viewer {

// A recording that is replayed instead of a run.
struct ReplaySpan {
  double duration = 0;           // time from first to last tick [s]; 0: this is a run
  std::uint64_t first_tick = 0;  // TickRecord::tick
};

struct ViewerOptions {
  std::string address;        // numeric; empty: 127.0.0.1, or 0.0.0.0 if exposed
  std::uint16_t port = 8080;  // 0: any free port
  bool expose = false;        // the user allowed other machines to connect; implies `tls`
  bool tls = false;
  std::filesystem::path certificate, key;  // the user's own, in PEM form; empty: one is made
  std::filesystem::path state_folder;      // where a made certificate is kept; empty: StateFolder()
  std::vector<std::string> names;          // additional names of this machine
  std::vector<std::string> foxglove_origins;  // such as https://app.foxglove.dev
  std::string secret;                         // NewAdmissionSecret(); empty: one is made
  Generations generations;                    // generations of the previous run's tokens
  std::vector<ScenarioTitle> scenarios;       // scenarios that a page may choose
  std::string notice;                         // shown to every client; empty: no notice
  ReplaySpan replay;
  // The results of a run that has ended, as JSON (the page's `scene.results`). During a run, the
  // results are empty.
  std::string results;
  std::filesystem::path report;            // report of that run, an HTML page; empty: no report
  Vector3 object_start = Vector3::Zero();  // O in W at the start of the run [m]
  std::string why_not_judged;  // why the person is not judged: a sentence for when no states come
};

// Returns $XDG_STATE_HOME/predictor, or ~/.local/state/predictor. Throws InputError if the user has
// no home folder.
std::filesystem::path StateFolder();

// The internal subcommand that turns this program into the viewer (`predictor viewer-process`).
// Only ViewerProcess uses it. The process gets all its data through descriptors 3 to 5.
inline constexpr const char* kViewerSubcommand = "viewer-process";
int ViewerMain();

class ViewerProcess {
 public:
  // Shows a message of one or several lines to the user. The viewer calls this function in its own
  // thread.
  using Notify = std::function<void(const std::string& text)>;

  // Starts the process and waits until it accepts clients. Throws InputError, for instance if the
  // port is in use, the certificate cannot be read, or the address needs `expose`. The descriptors
  // of `board`, `mailbox` and `states` are borrowed. `states` are the states of the person, or null
  // if the person is not judged.
  ViewerProcess(const Scenario& scenario, const ViewerOptions& options,
                const Shared<RunBoard>& board, const Shared<RunMailbox>& mailbox, Notify notify,
                const Shared<EvaluationBoard>* states = nullptr);

  // Returns the page's address with the access code. With real arms, this address changes when the
  // viewer restarts.
  std::string url() const;
  std::uint16_t port() const { return process_.port(); }
  std::string fingerprint() const;            // fingerprint of the certificate; "" without TLS
  int pid() const { return process_.pid(); }  // 0 while no process is running
  Generations generations() const;            // generations for the ViewerOptions of the next run

  // Requests of the operator at the console. These functions do not block, may be called from any
  // thread, and report their results by messages.
  void AskPin(const std::string& role);   // "look", "operator", "control"
  void Revoke(const std::string& lease);  // "control", "operator"
  // Removes client N permanently. All tokens that exist so far become invalid. With simulated arms,
  // the address also gets a new code. Pages that remain connected get new tokens. The run's process
  // keeps the generation of the tokens, so this function also works while the viewer is restarting.
  // If the viewer is restarting, all clients are disconnected. If the viewer has not answered a
  // request after at least 2 s, the next request kills and restarts it.
  void Kick(std::uint32_t client);
  // Makes each address that was given to Foxglove invalid in the same way.
  void KickFoxglove();
  // Informs all pages that the run has ended, with a sentence that states how it ended.
  // `results_follow` states whether another viewer, with the run's results, is about to replace
  // this one.
  void EndRun(const std::string& how, bool results_follow = false);
  void AskFoxglove();  // requests an address with which Foxglove may look
  void AskStatus();    // requests the list of clients, their leases, and their delays

 private:
  using Clock = std::chrono::steady_clock;

  void Hear(const Json& line);
  void HearReady(const Json& line);
  void Ask(const Json& line, const std::string& if_absent);
  void Renew(std::uint32_t Generations::*which, Json line, const std::string& who);

  Notify notify_;
  mutable std::mutex mutex_;  // protects the members below
  std::string url_, fingerprint_;
  Generations generations_;
  std::uint32_t starts_ = 0;
  std::optional<Clock::time_point> waits_since_;  // start of the wait for an answer

  SupervisedProcess process_;  // last, because it uses the other members
};

}  // namespace predictor::viewer
