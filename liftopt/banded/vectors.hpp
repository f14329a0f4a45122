// Vector types of GCC and Clang, one for each instruction set that code is compiled for, and which the processor has.
#pragma once

#define LIFTOPT_INLINE inline __attribute__((always_inline))

namespace banded {

// Vectors as wide as the target's registers: wider ones would be split through memory.
typedef double Two __attribute__((vector_size(16), aligned(16)));

#if defined(__x86_64__)
typedef double Four __attribute__((vector_size(32), aligned(32)));
typedef double Eight __attribute__((vector_size(64), aligned(64)));

#define LIFTOPT_AVX2 __attribute__((target("avx2,fma")))
#define LIFTOPT_AVX512 __attribute__((target("avx512f,avx512dq,avx512vl,avx2,fma")))

inline bool has_avx2() { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }

inline bool has_avx512() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
}
#endif

}  // namespace banded
