#include "core/shared_run.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace predictor {
namespace {

void* Map(int descriptor, std::size_t bytes, int protection) {
  void* memory = mmap(nullptr, bytes, protection, MAP_SHARED, descriptor, 0);
  if (memory == MAP_FAILED)
    throw std::runtime_error(std::string("shared memory could not be mapped: ") +
                             std::strerror(errno));
  // A child that was only forked (process/sandboxed_call.h) must not access the run through this
  // memory.
  madvise(memory, bytes, MADV_DONTFORK);
  return memory;
}

}  // namespace

template <class T>
Shared<T>::Shared() {
  descriptor_ = memfd_create("predictor", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (descriptor_ < 0 || ftruncate(descriptor_, sizeof(T)) != 0)
    throw std::runtime_error(
        std::string("shared memory could not be created: ") + std::strerror(errno) +
        (errno == EFBIG ? ". Allow larger files with `ulimit -f unlimited`." : ""));
  memory_ = new (Map(descriptor_, sizeof(T), PROT_READ | PROT_WRITE)) T;
  // A process that receives the descriptor can neither shrink the memory that the run uses nor
  // write records.
  int seals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;
  if (std::is_same_v<T, RunBoard>) seals |= F_SEAL_FUTURE_WRITE;
  if (fcntl(descriptor_, F_ADD_SEALS, seals) != 0)
    throw std::runtime_error(std::string("shared memory could not be sealed: ") +
                             std::strerror(errno));
}

template <class T>
Shared<T>::Shared(int descriptor, bool writable) : descriptor_(descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || status.st_size < static_cast<off_t>(sizeof(T)))
    throw std::runtime_error("descriptor " + std::to_string(descriptor) +
                             " is not the shared memory of a run");
  memory_ =
      static_cast<T*>(Map(descriptor, sizeof(T), writable ? PROT_READ | PROT_WRITE : PROT_READ));
}

template <class T>
Shared<T>::~Shared() {
  munmap(memory_, sizeof(T));
  close(descriptor_);
  if (read_only_ >= 0) close(read_only_);
}

template <class T>
int Shared<T>::read_only_descriptor() const {
  if (read_only_ < 0)
    read_only_ =
        open(("/proc/self/fd/" + std::to_string(descriptor_)).c_str(), O_RDONLY | O_CLOEXEC);
  if (read_only_ < 0)
    throw std::runtime_error(std::string("shared memory could not be opened for reading: ") +
                             std::strerror(errno));
  return read_only_;
}

template class Shared<RunBoard>;
template class Shared<RunMailbox>;
template class Shared<StopMailbox>;
template class Shared<WatchdogMailbox>;
template class Shared<EvaluationBoard>;
template class Shared<StreamBoard>;

}  // namespace predictor
