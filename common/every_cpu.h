// Functions compiled twice, for every x86-64 processor and for those with AVX2; the loader chooses.
#pragma once

// AVX2 brings no fused multiplications, so both compute the same bits. Not for Clang: version 19
// leaves out inline functions that only such functions call, and its thread sanitizer is not ready
// when the loader asks for the choice.
#if defined(__x86_64__) && !defined(__clang__)
#define CW2_EVERY_CPU __attribute__((target_clones("default", "avx2")))
#else
#define CW2_EVERY_CPU
#endif

/// A part of such functions: what is not inlined is not compiled twice.
#define CW2_INLINE [[gnu::always_inline]] inline
