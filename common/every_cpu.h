// Functions compiled twice, for every x86-64 processor and for those with AVX2; the loader chooses.
#pragma once

// AVX2 brings no fused multiplications, so both compute the same bits.
#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
// The loader asks for the choice before the sanitizer is ready.
#define CW2_EVERY_CPU
#endif
#endif
#if defined(CW2_EVERY_CPU)
#elif defined(__x86_64__)
#define CW2_EVERY_CPU __attribute__((target_clones("default", "avx2")))
#else
#define CW2_EVERY_CPU
#endif

/// A part of such functions: what is not inlined is not compiled twice.
#define CW2_INLINE [[gnu::always_inline]] inline
