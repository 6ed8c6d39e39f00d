/* The calls of twb.h. */

/* A pointer of the caller as the core sees it; NULL stays NULL, and one that is not aligned stays so. */
#ifdef TWB_PIECES
static inline u32 address(call_t *call, u32 piece, const void *pointer) {
    uintptr_t beside = (uintptr_t)pointer & 15u;
    call->w2c_memory[piece] = (u8 *)((uintptr_t)pointer - beside);
    return pointer == NULL ? 0 : piece << 28 | (u32)beside;
}
#else
static inline u32 address(call_t *call, u32 piece, const void *pointer) {
    (void)call;
    (void)piece;
    return pointer == NULL ? 0 : (u32)((uintptr_t)pointer - origin());
}
#endif

/* A call with as much of a stack as it needs at most, aligned as the core relies on. */
#define CALL(bytes)                                                                                                            \
    u64 stack[(bytes) / 8 + 2];                                                                                                \
    call_t call;                                                                                                               \
    begin(&call, (u8 *)stack + (-(uintptr_t)stack & 15u), (bytes))

static inline void begin(call_t *call, u8 *stack, u32 bytes) {
    call->w2c_g0 = address(call, 15, stack) + bytes;
#ifdef TWB_PIECES
    call->w2c_memory[0] = (u8 *)(uintptr_t)&constants;
#endif
}

/* Lengths are compared with what is far below this. */
static inline u32 bytes(size_t number) {
    return number > UINT32_MAX ? UINT32_MAX : (u32)number;
}

static inline const char *text(u32 at) {
    return (const char *)&constants + at;
}
