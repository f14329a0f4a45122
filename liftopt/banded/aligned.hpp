// Memory aligned to a lane of the dense operations, zero at first.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace banded {

template <typename T>
struct AlignedAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};
  AlignedAllocator() = default;
  template <typename U>
  AlignedAllocator(const AlignedAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kAlignment)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, kAlignment); }
  bool operator==(const AlignedAllocator&) const { return true; }
  bool operator!=(const AlignedAllocator&) const { return false; }
};

using Aligned = std::vector<double, AlignedAllocator<double>>;
using Vector = std::vector<double>;

}  // namespace banded
