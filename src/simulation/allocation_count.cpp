#include "simulation/allocation_count.h"

#include <dlfcn.h>
#include <elf.h>
#include <link.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <string_view>

#include "core/error.h"

namespace predictor {
namespace {

thread_local std::int64_t allocation_calls = 0;

// These pointers refer to the C library's own functions, and are set once. In this program, the
// usual names refer to the functions that count allocations.
void* (*real_malloc)(std::size_t);
void* (*real_calloc)(std::size_t, std::size_t);
void* (*real_realloc)(void*, std::size_t);
void (*real_free)(void*);
void* (*real_aligned_alloc)(std::size_t, std::size_t);
int (*real_posix_memalign)(void**, std::size_t, std::size_t);

void* CountedMalloc(std::size_t size) {
  ++allocation_calls;
  return real_malloc(size);
}
void* CountedCalloc(std::size_t count, std::size_t size) {
  ++allocation_calls;
  return real_calloc(count, size);
}
void* CountedRealloc(void* memory, std::size_t size) {
  ++allocation_calls;
  return real_realloc(memory, size);
}
void CountedFree(void* memory) {
  if (memory != nullptr) ++allocation_calls;
  real_free(memory);
}
void* CountedAlignedAlloc(std::size_t alignment, std::size_t size) {
  ++allocation_calls;
  return real_aligned_alloc(alignment, size);
}
int CountedPosixMemalign(void** memory, std::size_t alignment, std::size_t size) {
  ++allocation_calls;
  return real_posix_memalign(memory, alignment, size);
}

struct Counted {
  const char* name;
  void* counting;
};

template <class F>
Counted CountedAs(const char* name, F* counting, F** real) {
  *real = reinterpret_cast<F*>(dlsym(RTLD_DEFAULT, name));
  if (*real == nullptr)
    throw InputError(std::string("This system's C library has no ") + name +
                     " that can be counted. Use cobot.controller.type: process.");
  return {name, reinterpret_cast<void*>(counting)};
}

using Functions = std::array<Counted, 6>;

Functions FindFunctions() {
  return {CountedAs("malloc", CountedMalloc, &real_malloc),
          CountedAs("calloc", CountedCalloc, &real_calloc),
          CountedAs("realloc", CountedRealloc, &real_realloc),
          CountedAs("free", CountedFree, &real_free),
          CountedAs("aligned_alloc", CountedAlignedAlloc, &real_aligned_alloc),
          CountedAs("posix_memalign", CountedPosixMemalign, &real_posix_memalign)};
}

// The tables of a loaded library that contain the addresses of functions of other libraries.
struct Tables {
  const ElfW(Sym) * symbols = nullptr;
  const char* names = nullptr;
  std::array<const ElfW(Rela)*, 2> entries{};
  std::array<std::size_t, 2> sizes{};  // [bytes]
};

Tables TablesOf(const dl_phdr_info& library) {
  Tables tables;
  const ElfW(Dyn)* entry = nullptr;
  for (int i = 0; i < library.dlpi_phnum; ++i)
    if (library.dlpi_phdr[i].p_type == PT_DYNAMIC)
      entry = reinterpret_cast<const ElfW(Dyn)*>(library.dlpi_addr + library.dlpi_phdr[i].p_vaddr);
  for (; entry && entry->d_tag != DT_NULL; ++entry) {
    const ElfW(Addr) address = entry->d_un.d_ptr;
    if (entry->d_tag == DT_SYMTAB) tables.symbols = reinterpret_cast<const ElfW(Sym)*>(address);
    if (entry->d_tag == DT_STRTAB) tables.names = reinterpret_cast<const char*>(address);
    if (entry->d_tag == DT_JMPREL) tables.entries[0] = reinterpret_cast<const ElfW(Rela)*>(address);
    if (entry->d_tag == DT_PLTRELSZ) tables.sizes[0] = entry->d_un.d_val;
    if (entry->d_tag == DT_RELA) tables.entries[1] = reinterpret_cast<const ElfW(Rela)*>(address);
    if (entry->d_tag == DT_RELASZ) tables.sizes[1] = entry->d_un.d_val;
  }
  return tables;
}

void Replace(void** place, void* with) {
  if (*place == with) return;
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const std::uintptr_t start = reinterpret_cast<std::uintptr_t>(place) / page * page;
  if (mprotect(reinterpret_cast<void*>(start), page, PROT_READ | PROT_WRITE) == 0) *place = with;
}

int CountIn(dl_phdr_info* library, std::size_t, void* functions) {
  // The kernel's own library (the vDSO) is skipped, because it has addresses of another kind and
  // allocates nothing.
  if (std::string_view(library->dlpi_name).starts_with("linux-vdso")) return 0;
  const Tables tables = TablesOf(*library);
  if (!tables.symbols || !tables.names) return 0;
  for (std::size_t t = 0; t < tables.entries.size(); ++t) {
    for (std::size_t i = 0; tables.entries[t] && i < tables.sizes[t] / sizeof(ElfW(Rela)); ++i) {
      const ElfW(Rela)& entry = tables.entries[t][i];
      const auto symbol = entry.r_info >> 32U;
      if (symbol == 0) continue;
      const char* name = tables.names + tables.symbols[symbol].st_name;
      for (const Counted& function : *static_cast<const Functions*>(functions))
        if (std::strcmp(name, function.name) == 0 && tables.symbols[symbol].st_shndx == SHN_UNDEF)
          Replace(reinterpret_cast<void**>(library->dlpi_addr + entry.r_offset), function.counting);
    }
  }
  return 0;
}

}  // namespace

// The loader calls CountIn under its own lock, so only one thread at a time changes the tables.
void BeginAllocationCount() {
  static Functions functions = FindFunctions();
  dl_iterate_phdr(CountIn, &functions);
}

std::int64_t AllocationCalls() noexcept { return allocation_calls; }

}  // namespace predictor
