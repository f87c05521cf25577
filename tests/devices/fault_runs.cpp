#include "devices/fault_runs.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "core/words.h"
#include "devices/audit.h"
#include "devices/fault_bring.h"
#include "devices/fault_starts.h"
#include "scenario/paths.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

static_assert(std::is_trivially_copyable_v<FaultRun>, "it is sent through a pipe");

constexpr unsigned kPatience = 300;  // time limit of one run, in real time [s]
constexpr int kLastPair = 33;        // higher numbers concern neither the loop nor the devices

bool WriteAll(int to, const void* what, std::size_t bytes) {
  const auto* from = static_cast<const char*>(what);
  while (bytes > 0) {
    const ssize_t n = write(to, from, bytes);
    if (n <= 0) return false;
    from += n;
    bytes -= static_cast<std::size_t>(n);
  }
  return true;
}
bool ReadAll(int from, void* what, std::size_t bytes) {
  auto* to = static_cast<char*>(what);
  while (bytes > 0) {
    const ssize_t n = read(from, to, bytes);
    if (n <= 0) return false;
    to += n;
    bytes -= static_cast<std::size_t>(n);
  }
  return true;
}

// Runs `work` in a child process, which inherits the state of this one.
FaultOutcome InChild(const std::function<FaultOutcome()>& work) {
  std::array<int, 2> ends{};
  FaultOutcome outcome;
  if (pipe(ends.data()) != 0) return outcome.Fail("no pipe"), outcome;
  std::fflush(nullptr);
  const pid_t pid = fork();
  if (pid == 0) {
    alarm(kPatience);
    try {
      outcome = work();
    } catch (const std::exception& error) {
      outcome.Fail(std::string("threw: ") + error.what());
    }
    _exit(WriteAll(ends[1], &outcome, sizeof outcome) ? 0 : 1);
  }
  close(ends[1]);
  const bool reported = pid > 0 && ReadAll(ends[0], &outcome, sizeof outcome);
  close(ends[0]);
  int status = 0;
  if (pid > 0) waitpid(pid, &status, 0);
  if (!reported) outcome = {};
  if (!reported) outcome.Fail("the process died (status " + std::to_string(status) + ")");
  return outcome;
}

// ---- finished and remaining runs ---------------------------------------------------------------

// Adds the content and the length of a file to a hash (FNV-1a).
void Hash(const std::filesystem::path& file, std::uint64_t* hash) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot be read: " + file.string());
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  for (const char c : text + '\0') *hash = (*hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
}

// Hashes the inputs of a rig's runs, except the program. The inputs are the audit, the scenario,
// and the robot descriptions.
std::uint64_t HashOfInputs(const FaultRig& rig) {
  std::uint64_t hash = 14695981039346656037U;
  const std::filesystem::path source = PREDICTOR_SOURCE_DIR;
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(source / "tests/devices/audit"))
    if (entry.path().extension() == ".py") files.insert(entry.path());
  const Scenario s = LoadScenario(OptionsOf(rig, 1).scenario);
  files.insert(s.file);
  for (const std::string& model : {s.arm(0).model, s.arm(1).model, s.cobot.model, s.object.model})
    if (!model.empty()) files.insert(ResolveModelPath(model, s.folder()));
  for (const std::filesystem::path& file : files) Hash(file, &hash);
  return hash;
}

// The results of earlier calls of this program. The results of a beginning are kept only if all its
// runs are complete, so that all kept results have been audited.
class Kept {
 public:
  Kept(const std::string& file, const FaultRig& rig) {
    if (file.empty()) return;
    struct stat program {};
    stat("/proc/self/exe", &program);
    const std::array<long, 4> now = {static_cast<long>(sizeof(FaultRun)), program.st_size,
                                     program.st_mtim.tv_sec, static_cast<long>(HashOfInputs(rig))};
    file_ = open(file.c_str(), O_RDWR | O_CREAT, 0644);
    std::array<long, 4> then{};
    FaultRun run;
    if (ReadAll(file_, then.data(), sizeof then) && then == now)
      while (ReadAll(file_, &run, sizeof run)) Take(run);
    if (ftruncate(file_, 0) != 0 || lseek(file_, 0, SEEK_SET) != 0) return;
    WriteAll(file_, now.data(), sizeof now);
    for (const FaultRun& done : runs) WriteAll(file_, &done, sizeof done);
  }
  ~Kept() {
    if (file_ >= 0) close(file_);
  }
  Kept(const Kept&) = delete;
  Kept& operator=(const Kept&) = delete;

  bool Has(std::uint64_t beginning) const { return audited_.contains(beginning); }
  void Add(const FaultRun& run) {
    Take(run);
    if (file_ >= 0) WriteAll(file_, &run, sizeof run);
  }

  std::vector<FaultRun> runs;  // of complete beginnings only

 private:
  // The audit is the last run of a beginning.
  void Take(const FaultRun& run) {
    std::vector<FaultRun>& of_it = begun_[run.beginning];
    of_it.push_back(run);
    if (run.fault != kAudit) return;
    audited_.insert(run.beginning);
    runs.insert(runs.end(), of_it.begin(), of_it.end());
    begun_.erase(run.beginning);
  }

  int file_ = -1;
  std::map<std::uint64_t, std::vector<FaultRun>> begun_;
  std::set<std::uint64_t> audited_;
};

struct Due {
  FaultRun run;
  double time = 0;  // time in RUN [s]
};

// A child process executes this function.
FaultOutcome OnARun(Bench& bench, const FaultRig& rig, const FaultRun& run,
                    const std::string& audit) {
  const Fault& fault = Faults()[run.fault];
  if (!fault.Begins() && bench.emulator().state() != RunState::kRun) {
    FaultOutcome outcome;
    outcome.Fail(std::string("RUN was not reached before the fault: ") +
                 Name(bench.emulator().state()) + ", " + StopCauseWords(bench.record()));
    return outcome;
  }
  const Fault* second = run.second < 0 ? nullptr : &Faults()[static_cast<std::size_t>(run.second)];
  return second ? BringBoth(bench, fault, *second, rig, run.seed, audit)
                : Bring(bench, fault, rig, run.seed, audit);
}

// Audits the commands to the arms in all runs with the same beginning.
FaultRun Audited(std::uint64_t seed, const std::string& file) {
  FaultRun run{kAudit, -1, seed, 0, {}};
  if (const std::string wrong = Audit(file); !wrong.empty()) run.outcome.Fail(wrong);
  if (std::getenv("PREDICTOR_KEEP_AUDITS") == nullptr) unlink(file.c_str());
  return run;
}

// Runs with the same beginning share the seed and the faults that are present from the start (at
// most two).
struct Beginning {
  std::uint64_t number = 0;
  std::uint64_t seed = 0;
  std::vector<const Fault*> with;
  std::vector<Due> due;
};

BenchOptions OptionsOf(const FaultRig& rig, const Beginning& beginning) {
  BenchOptions options = OptionsOf(rig, beginning.seed);
  for (const Fault* fault : beginning.with)
    if (fault->options) fault->options(rig, beginning.seed, &options);
  return options;
}

// Starts the run and continues it to the point at which faults are injected.
bool Start(Bench& bench, const Beginning& beginning) {
  bool recovers = false;
  for (const Fault* fault : beginning.with) {
    if (fault->begin) fault->begin(bench, beginning.seed);
    recovers = recovers || fault->recovers;
  }
  return recovers ? StartToRecover(bench) : bench.Start();
}

// Performs all runs of a beginning and calls `report` after each of them.
void RunDue(const FaultRig& rig, Beginning beginning,
            const std::function<void(const FaultRun&)>& report) {
  const std::uint64_t seed = beginning.seed;
  std::vector<Due>& due = beginning.due;
  const auto on_a_run = [](const Due& d) {
    return d.run.second >= 0 || Faults()[d.run.fault].alone == nullptr;
  };
  const auto alone = std::stable_partition(due.begin(), due.end(), on_a_run);
  std::sort(due.begin(), alone, [](const Due& a, const Due& b) { return a.time < b.time; });
  const std::string audit =
      "/tmp/predictor-audit-" + std::to_string(getpid()) + "-" + std::to_string(beginning.number);
  unlink(audit.c_str());
  for (auto it = alone; it != due.end(); ++it) {
    it->run.outcome = InChild([&] {
      FaultOutcome outcome;
      Faults()[it->run.fault].alone(rig, seed, audit, &outcome);
      return outcome;
    });
    report(it->run);
  }
  Bench bench(OptionsOf(rig, beginning));
  bench.Capture();
  const bool runs = Start(bench, beginning);
  double now = 0;
  for (auto it = due.begin(); it != alone; ++it) {
    if (runs) bench.Pass(it->time - now);
    now = std::max(now, it->time);
    it->run.outcome = InChild([&] { return OnARun(bench, rig, it->run, audit); });
    report(it->run);
  }
  AppendForAudit(audit, "seed " + std::to_string(seed) + " before its faults", rig, bench, {});
  report(Audited(seed, audit));
}

// Distributes the beginnings to one process per processor.
void RunLeft(const FaultRig& rig, const std::vector<Beginning>& beginnings, Kept* kept) {
  const std::size_t workers =
      std::min<std::size_t>(beginnings.size(), std::max(1U, std::thread::hardware_concurrency()));
  std::array<int, 2> ends{};
  if (workers == 0 || pipe(ends.data()) != 0) return;
  std::fflush(nullptr);
  std::vector<pid_t> pids;
  for (std::size_t w = 0; w < workers; ++w) {
    const pid_t pid = fork();
    if (pid != 0) {
      pids.push_back(pid);
      continue;
    }
    close(ends[0]);
    for (std::size_t i = w; i < beginnings.size(); i += workers)
      RunDue(rig, beginnings[i], [&](FaultRun run) {
        run.beginning = beginnings[i].number;
        WriteAll(ends[1], &run, sizeof run);
      });
    _exit(0);
  }
  close(ends[1]);
  for (FaultRun run; ReadAll(ends[0], &run, sizeof run);) kept->Add(run);
  close(ends[0]);
  for (const pid_t pid : pids) waitpid(pid, nullptr, 0);
}

FaultRuns RunAll(const FaultRig& rig, const std::vector<Beginning>& all, Kept* kept) {
  FaultRuns runs;
  std::vector<Beginning> beginnings;
  for (const Beginning& beginning : all) {
    runs.due += beginning.due.size();
    ++runs.audits_due;
    if (!kept->Has(beginning.number)) beginnings.push_back(beginning);
  }
  RunLeft(rig, beginnings, kept);
  runs.all = std::move(kept->runs);
  return runs;
}

}  // namespace

double TimeOf(const std::string& fault, std::uint64_t seed) {
  return 1.5 + 2 * RandomStream(seed, "time of " + fault).Uniform();
}

int OnlyFault() {
  const char* number = std::getenv("PREDICTOR_FAULT");
  return number == nullptr ? 0 : std::atoi(number);
}

bool Concerns(const Fault& fault, const FaultRig& rig) {
  if (OnlyFault() != 0 && OnlyFault() != fault.number) return false;
  return !HandsWith(fault.carrier, rig).empty();
}

FaultRuns RunFaults(const FaultRig& rig, long seeds, const std::string& file) {
  Kept kept(file, rig);
  std::vector<Beginning> beginnings;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(seeds); ++seed) {
    std::vector<Due> due;
    for (std::size_t i = 0; i < Faults().size(); ++i)
      if (Concerns(Faults()[i], rig))
        due.push_back({{i, -1, seed, 0, {}}, TimeOf(Faults()[i].ToString(), seed)});
    beginnings.push_back({seed, seed, {}, std::move(due)});
  }
  return RunAll(rig, beginnings, &kept);
}

bool HavePair(const Fault& first, const Fault& second, const FaultRig& rig) {
  if (first.ToString() == second.ToString()) return false;
  for (const Fault* fault : {&first, &second})
    if (fault->number > kLastPair || !fault->Pairs() || !Concerns(*fault, rig)) return false;
  if (second.Begins()) return first.Begins() && first.number < second.number;
  // Both faults change the same sequence numbers, so one would hide the other.
  if (first.number == 7 && second.number == 7 && first.Begins()) return false;
  // A hanging process may still die. A process without its loop can have no faults of the loop.
  if (first.gone)
    return second.gone ? first.number > second.number
                       : second.carrier != Carrier::kLoop && !second.before;
  return true;
}

FaultRuns RunFaultPairs(const FaultRig& rig, double share, const std::string& file) {
  constexpr std::size_t kAtOnce = 40;  // largest number of runs per beginning
  Kept kept(file, rig);
  std::vector<Beginning> beginnings;
  RandomStream sample(1, "pairs"), times(1, "times of pairs");
  std::size_t count = 0;
  for (std::size_t i = 0; i < Faults().size(); ++i) {
    const Fault& first = Faults()[i];
    for (std::size_t j = 0; j < Faults().size(); ++j) {
      const Fault& second = Faults()[j];
      if (!HavePair(first, second, rig)) continue;
      const bool chosen = sample.Uniform() < share;
      // The arms return from beyond a limit within a short time.
      const double time =
          first.recovers || second.recovers ? times.Uniform() : 1.5 + 2 * times.Uniform();
      if (!chosen) continue;
      const FaultRun run{i, static_cast<int>(j), 1 + count++ / kAtOnce, 0, {}};
      std::vector<const Fault*> with;
      for (const Fault* fault : {&first, &second})
        if (fault->Begins()) with.push_back(fault);
      if (beginnings.empty() || beginnings.back().seed != run.seed ||
          beginnings.back().with != with)
        beginnings.push_back({beginnings.size(), run.seed, with, {}});
      beginnings.back().due.push_back({run, time});
    }
  }
  return RunAll(rig, beginnings, &kept);
}

}  // namespace predictor
