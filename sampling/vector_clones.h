// ABN_VECTOR_CLONES before a function compiles it twice, for baseline x86-64 and for AVX2 (x86-64-v3); the loader picks
// the better one for the machine. Only for functions whose results do not depend on the choice: integers, or floating
// point without fused multiply-add (the build says -ffp-contract=off). Elsewhere, and under sanitizers, which cannot
// instrument the loader's choice, it is nothing.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__CUDACC__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define ABN_VECTOR_CLONES [[gnu::target_clones("arch=x86-64-v3", "default")]]
#else
#define ABN_VECTOR_CLONES
#endif
