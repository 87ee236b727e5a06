#include "tests/fuzz/heap_meter.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace twopass {
namespace {

std::atomic<std::size_t> in_use{0}, peak{0}, start{0};

void count(std::size_t size) {
  const std::size_t now = in_use.fetch_add(size, std::memory_order_relaxed) + size;
  std::size_t most = peak.load(std::memory_order_relaxed);
  while (now > most && !peak.compare_exchange_weak(most, now, std::memory_order_relaxed)) {
  }
}
void discount(std::size_t size) { in_use.fetch_sub(size, std::memory_order_relaxed); }

}  // namespace

void reset_heap_peak() {
  start = in_use.load();
  peak = start.load();
}
std::size_t heap_growth() { return peak - start; }

}  // namespace twopass

#ifdef TWOPASS_FUZZ

#include <sanitizer/allocator_interface.h>

namespace {
[[maybe_unused]] const bool installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t size) { twopass::count(size); },
    [](const volatile void* block) {
      if (block != nullptr) twopass::discount(__sanitizer_get_allocated_size(const_cast<const void*>(block)));
    });
}  // namespace

#else

#include <malloc.h>

namespace {

void* allocate(std::size_t size, std::size_t alignment = alignof(std::max_align_t)) {
  void* block = alignment <= alignof(std::max_align_t)
                    ? std::malloc(size)
                    : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (block == nullptr) throw std::bad_alloc();
  twopass::count(malloc_usable_size(block));
  return block;
}
void release(void* block) {
  if (block != nullptr) twopass::discount(malloc_usable_size(block));
  std::free(block);
}

}  // namespace

// The other forms of the standard call these.
void* operator new(std::size_t size) { return allocate(size); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* block) noexcept { release(block); }
void operator delete(void* block, std::size_t) noexcept { release(block); }
void operator delete(void* block, std::align_val_t) noexcept { release(block); }
void operator delete(void* block, std::size_t, std::align_val_t) noexcept { release(block); }

#endif
