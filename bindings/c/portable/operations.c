/* The run time of what `wasm2c` makes of the core: memory and the few operations that are no operators of C. No heap, no
 * global, no C library.
 *
 * WebAssembly has addresses of 32 bits. Address 0 is that of `constants`; where pointers have 32 bits, every address is as far
 * from there as in the machine's memory, modulo 2^32, so that a caller's pointer becomes an address by a subtraction, and the
 * base, the order and all else stay where the caller has them. Where pointers are longer, the uppermost four bits number a
 * piece of memory that the call was given, and the rest is the place in it; TWB_PIECES gives that to other machines, too. */
#include <stdint.h>

#include "twb.h"

#if !defined(__GNUC__)
#error "twb: GCC or Clang is needed"
#elif __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__ || UINTPTR_MAX < 0xFFFFFFFFu
#error "twb: little-endian machines with pointers of 32 bits or more only"
#elif defined(__FAST_MATH__)
#error "twb: -ffast-math changes results"
#elif defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0 && __FLT_EVAL_METHOD__ != 16
#error "twb: floats have to be computed as floats (x86: -msse2 -mfpmath=sse)"
#endif

/* Rust never fuses a multiplication with an addition; a loop that copies is not to become a call. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#else
#pragma GCC optimize("fp-contract=off", "no-tree-loop-distribute-patterns")
#endif

#if !defined(TWB_PIECES) && UINTPTR_MAX > 0xFFFFFFFFu
#define TWB_PIECES
#endif

typedef int8_t s8;
typedef int16_t s16;
typedef int32_t s32;
typedef int64_t s64;
typedef uint8_t u8;
typedef uint16_t u16;
typedef uint32_t u32;
typedef uint64_t u64;
typedef float f32;
typedef double f64;

/* Memory is read as what it was not written as. */
#define ANY __attribute__((may_alias))
typedef u16 ANY any_u16;
typedef u32 ANY any_u32;
typedef f32 ANY any_f32;

static const struct constants constants;

/* What a call has: the stack of WebAssembly, which is on that of C, and the pieces of memory. */
typedef struct call {
    u32 w2c_g0; /* the stack's end */
#ifdef TWB_PIECES
    u8 *w2c_memory[16];
#else
    u8 w2c_memory[1]; /* named by `wasm2c`; nothing looks at it */
#endif
} call_t;

#ifdef TWB_PIECES
static inline u8 *place(u8 *const *pieces, u64 at) {
    return pieces[(u32)at >> 28] + ((u32)at & 0x0FFFFFFFu);
}
#else
/* Address 0, as a number of which the compiler does not know where it comes from: what it knows to be reached from `constants` it
 * takes for a part of them, and moves across accesses to the stack. */
static inline uintptr_t origin(void) {
    uintptr_t at = (uintptr_t)&constants;
    __asm__("" : "+r"(at));
    return at;
}

static inline u8 *place(const u8 *unused, u64 at) {
    (void)unused;
    return (u8 *)(origin() + (uintptr_t)at);
}
#endif

/* Words are aligned as words; what is not, the builder made bytes of. */
#define LOAD(name, in_memory, as, result)                                                                                      \
    static inline result name(void *memory, u64 at) {                                                                          \
        return (result)(as)*(const in_memory *)place(memory, at);                                                              \
    }
#define STORE(name, in_memory, value_type)                                                                                     \
    static inline void name(void *memory, u64 at, value_type value) {                                                          \
        *(in_memory *)place(memory, at) = (in_memory)value;                                                                    \
    }
LOAD(i32_load, any_u32, u32, u32)
LOAD(i32_load8_u, u8, u8, u32)
LOAD(i32_load8_s, u8, s8, u32)
LOAD(i32_load16_u, any_u16, u16, u32)
LOAD(i32_load16_s, any_u16, s16, u32)
LOAD(i64_load8_u, u8, u8, u64)
LOAD(i64_load16_u, any_u16, u16, u64)
LOAD(i64_load32_u, any_u32, u32, u64)
LOAD(i64_load32_s, any_u32, s32, u64)
LOAD(f32_load, any_f32, f32, f32)
STORE(i32_store, any_u32, u32)
STORE(i32_store8, u8, u32)
STORE(i32_store16, any_u16, u32)
STORE(i64_store8, u8, u64)
STORE(i64_store16, any_u16, u64)
STORE(i64_store32, any_u32, u64)
STORE(f32_store, any_f32, f32)

/* Of the longer ones, half is enough. */
static inline u64 i64_load(void *memory, u64 at) {
    const any_u32 *words = (const any_u32 *)place(memory, at);
    return (u64)words[0] | (u64)words[1] << 32;
}
static inline void i64_store(void *memory, u64 at, u64 value) {
    any_u32 *words = (any_u32 *)place(memory, at);
    words[0] = (u32)value;
    words[1] = (u32)(value >> 32);
}

#define REINTERPRET(name, from, to)                                                                                            \
    static inline to name(from value) {                                                                                        \
        union {                                                                                                                \
            from one;                                                                                                          \
            to other;                                                                                                          \
        } both = {value};                                                                                                      \
        return both.other;                                                                                                     \
    }
REINTERPRET(f32_reinterpret_i32, u32, f32)
REINTERPRET(i32_reinterpret_f32, f32, u32)
REINTERPRET(f64_reinterpret_i64, u64, f64)
REINTERPRET(i64_reinterpret_f64, f64, u64)

static inline f64 f64_load(void *memory, u64 at) {
    return f64_reinterpret_i64(i64_load(memory, at));
}
static inline void f64_store(void *memory, u64 at, f64 value) {
    i64_store(memory, at, i64_reinterpret_f64(value));
}

/* Also where both overlap. */
static void memory_copy(void *to_memory, void *from_memory, u32 to, u32 from, u32 length) {
    u8 *out = place(to_memory, to);
    const u8 *in = place(from_memory, from);
    if (((to | from | length) & 3) == 0) {
        any_u32 *out_words = (any_u32 *)(void *)out;
        const any_u32 *in_words = (const any_u32 *)(const void *)in;
        u32 words = length / 4, word;
        if (to - from >= length) {
            for (word = 0; word < words; word++) {
                out_words[word] = in_words[word];
            }
        } else {
            for (word = words; word-- != 0;) {
                out_words[word] = in_words[word];
            }
        }
    } else if (to - from >= length) {
        u32 at;
        for (at = 0; at < length; at++) {
            out[at] = in[at];
        }
    } else {
        while (length-- != 0) {
            out[length] = in[length];
        }
    }
}

static void memory_fill(void *memory, u32 to, u32 value, u32 length) {
    u8 *out = place(memory, to);
    u32 at = 0;
    if (((to | length) & 3) == 0) {
        for (; at < length; at += 4) {
            *(any_u32 *)(void *)(out + at) = (u8)value * 0x01010101u;
        }
    }
    for (; at < length; at++) {
        out[at] = (u8)value;
    }
}

/* Between the mark of a base in a call and the base: for interrupts on the same core. */
static inline void twb_fence(void *none) {
    (void)none;
    __atomic_signal_fence(__ATOMIC_SEQ_CST);
}

/* Nothing that is here is reached: a panic is refused by the builder, and Rust divides by no zero. */
#define UNREACHABLE __builtin_trap()
#define FUNC_PROLOGUE (void)instance
#define FUNC_EPILOGUE ((void)0)

#define INFINITY __builtin_inff()
#define DIV_U(x, y) ((x) / (y))
#define REM_U(x, y) ((x) % (y))
#define I32_CLZ(x) ((x) != 0 ? (u32)__builtin_clz(x) : 32u)
#define I64_CLZ(x) ((x) != 0 ? (u64)__builtin_clzll(x) : 64u)
#define I32_CTZ(x) ((x) != 0 ? (u32)__builtin_ctz(x) : 32u)
#define I64_CTZ(x) ((x) != 0 ? (u64)__builtin_ctzll(x) : 64u)
#define I32_ROTL(x, y) ((x) << ((y) & 31) | (x) >> (-(y) & 31))
#define I64_ROTL(x, y) ((x) << ((y) & 63) | (x) >> (-(y) & 63))
#define I32_TRUNC_SAT_U_F32(x) ((x) >= 4294967296.0f ? UINT32_MAX : (x) > 0.0f ? (u32)(x) : 0u)
#define I32_TRUNC_SAT_U_F64(x) ((x) >= 4294967296.0 ? UINT32_MAX : (x) > 0.0 ? (u32)(x) : 0u)
#define I32_TRUNC_SAT_S_F32(x)                                                                                                 \
    ((x) >= 2147483648.0f ? INT32_MAX : (x) >= -2147483648.0f ? (u32)(s32)(x) : (x) != (x) ? 0u : 0x80000000u)

/* Bits, and no call of a library. */
static inline f32 wasm_fabsf(f32 x) {
    return __builtin_fabsf(x);
}
static inline f32 twb_copysignf(f32 x, f32 y) {
    return f32_reinterpret_i32((i32_reinterpret_f32(x) & 0x7FFFFFFFu) | (i32_reinterpret_f32(y) & 0x80000000u));
}
#define copysignf twb_copysignf
/* A conversion makes a quiet NaN of any NaN by itself. */
#define wasm_quietf(x) (x)
#define wasm_quiet(x) (x)
static inline u64 I64_POPCNT(u64 x) {
    u64 bits = 0;
    for (; x != 0; x &= x - 1) {
        bits++;
    }
    return bits;
}
