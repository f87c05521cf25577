#include "process/sandbox.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <linux/sockios.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <vector>

namespace predictor {
namespace {

// ---- Landlock -----------------------------------------------------------------------------------

// Its numbers are the same on every architecture; older headers lack them.
constexpr long kCreateRuleset = 444, kRestrictSelf = 446;
constexpr std::uint32_t kAskVersion = 1;

struct Ruleset {
  std::uint64_t files = 0, ports = 0, scopes = 0;
};

// All that a version of Landlock can refuse.
Ruleset EverythingOf(long version) {
  Ruleset all;
  all.files = (std::uint64_t{1} << 13) - 1;
  if (version >= 2) all.files |= std::uint64_t{1} << 13;  // moves between folders
  if (version >= 3) all.files |= std::uint64_t{1} << 14;  // truncation
  if (version >= 5) all.files |= std::uint64_t{1} << 15;  // devices' ioctl
  if (version >= 4) all.ports = 3;                        // bind, connect
  if (version >= 6) all.scopes = 3;                       // abstract sockets, signals
  return all;
}

// The older a version, the shorter its ruleset.
std::size_t SizeOf(long version) {
  if (version >= 6) return sizeof(Ruleset);
  return version >= 4 ? offsetof(Ruleset, scopes) : offsetof(Ruleset, ports);
}

bool EnterLandlock() {
  const long version = syscall(kCreateRuleset, nullptr, 0, kAskVersion);
  if (version < 1) return false;
  const Ruleset all = EverythingOf(version);
  const long rules = syscall(kCreateRuleset, &all, SizeOf(version), 0);
  if (rules < 0) return false;
  const bool entered = syscall(kRestrictSelf, rules, 0) == 0;
  close(static_cast<int>(rules));
  return entered;
}

// ---- system calls -------------------------------------------------------------------------------

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t kArchitecture = 0;
#endif

// Some are of one architecture, or newer than the headers.
constexpr std::uint32_t kRefused[] = {
#ifdef __NR_open
    __NR_open, __NR_creat, __NR_rename, __NR_mkdir, __NR_rmdir, __NR_link, __NR_unlink,
    __NR_symlink, __NR_chmod, __NR_chown, __NR_mknod, __NR_fork, __NR_vfork,
#endif
    // files
    __NR_openat, __NR_openat2, __NR_open_by_handle_at, __NR_truncate, __NR_renameat2, __NR_mkdirat,
    __NR_linkat, __NR_unlinkat, __NR_symlinkat, __NR_fchmodat, __NR_fchownat, __NR_mknodat,
    __NR_mount, __NR_umount2, __NR_chroot, __NR_pivot_root, __NR_memfd_create,
    // processes
    __NR_execve, __NR_execveat, __NR_clone, __NR_clone3, __NR_unshare, __NR_setns, __NR_ptrace,
    __NR_process_vm_readv, __NR_process_vm_writev, __NR_pidfd_open, __NR_pidfd_getfd,
    __NR_pidfd_send_signal, __NR_kill, __NR_tkill, __NR_rt_sigqueueinfo, __NR_rt_tgsigqueueinfo,
    __NR_prlimit64, __NR_setpriority, __NR_sched_setscheduler, __NR_sched_setparam,
    __NR_sched_setattr, __NR_sched_setaffinity, __NR_ioprio_set, __NR_move_pages,
    __NR_migrate_pages,
    // connections
    __NR_socket, __NR_connect, __NR_bind, __NR_listen,
    // the kernel's larger doors
    __NR_bpf, __NR_perf_event_open, __NR_io_uring_setup, __NR_userfaultfd, __NR_keyctl,
    __NR_add_key, __NR_request_key, __NR_init_module, __NR_finit_module, __NR_kexec_load};

sock_filter Statement(int code, std::uint32_t k) {
  return {static_cast<std::uint16_t>(code), 0, 0, k};
}
// Goes on with the next statement if equal, else over one.
sock_filter IfEqual(std::uint32_t k) {
  return {static_cast<std::uint16_t>(BPF_JMP | BPF_JEQ | BPF_K), 0, 1, k};
}

sock_filter Load(std::size_t at) {
  return Statement(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(at));
}
sock_filter Answer(std::uint32_t what) { return Statement(BPF_RET | BPF_K, what); }
constexpr std::uint32_t kRefuse = SECCOMP_RET_ERRNO | EPERM;

// Refuses a call whose second argument is one of these. Expects the call's number loaded, and
// leaves it so.
void RefuseCommands(std::uint32_t call, std::initializer_list<std::uint32_t> commands,
                    std::vector<sock_filter>* program) {
  const auto over = static_cast<std::uint8_t>(2 + 2 * commands.size());
  program->push_back({static_cast<std::uint16_t>(BPF_JMP | BPF_JEQ | BPF_K), 0, over, call});
  program->push_back(Load(offsetof(seccomp_data, args) + sizeof(std::uint64_t)));
  for (const std::uint32_t command : commands) {
    program->push_back(IfEqual(command));
    program->push_back(Answer(kRefuse));
  }
  program->push_back(Answer(SECCOMP_RET_ALLOW));
}

std::vector<sock_filter> Filter() {
  constexpr std::uint32_t kOtherAbi = 0x40000000;  // x86-64's x32
  std::vector<sock_filter> program = {
      Load(offsetof(seccomp_data, arch)),
      {static_cast<std::uint16_t>(BPF_JMP | BPF_JEQ | BPF_K), 1, 0, kArchitecture},
      Answer(SECCOMP_RET_KILL_PROCESS),
      Load(offsetof(seccomp_data, nr)),
      {static_cast<std::uint16_t>(BPF_JMP | BPF_JGE | BPF_K), 0, 1, kOtherAbi},
      Answer(kRefuse)};
  for (const std::uint32_t call : kRefused) {
    program.push_back(IfEqual(call));
    program.push_back(Answer(kRefuse));
  }
  // Who owns a descriptor is sent signals by it, SIGKILL among them.
  RefuseCommands(__NR_fcntl, {F_SETOWN, F_SETSIG, F_SETOWN_EX}, &program);
  RefuseCommands(__NR_ioctl, {FIOSETOWN, SIOCSPGRP}, &program);
  // To a thread of one's own only: abort() ends by it.
  program.push_back({static_cast<std::uint16_t>(BPF_JMP | BPF_JEQ | BPF_K), 0, 3, __NR_tgkill});
  program.push_back(Load(offsetof(seccomp_data, args)));
  program.push_back({static_cast<std::uint16_t>(BPF_JMP | BPF_JEQ | BPF_K), 1, 0,
                     static_cast<std::uint32_t>(getpid())});
  program.push_back(Answer(kRefuse));
  program.push_back(Answer(SECCOMP_RET_ALLOW));
  return program;
}

bool FilterSystemCalls() {
  if (kArchitecture == 0) return false;
  std::vector<sock_filter> filter = Filter();
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0;
}

}  // namespace

std::string EnterSandbox() {
  std::string missing;
  if (!EnterLandlock()) missing = "Landlock (Linux 5.13 or newer)";
  if (!FilterSystemCalls())
    missing += std::string(missing.empty() ? "" : ", ") + "the filter of system calls (seccomp)";
  return missing;
}

}  // namespace predictor
