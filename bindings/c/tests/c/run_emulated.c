/* The mission on an emulated board, without C library: entry, printing by semihosting, and the little that compilers call. */
#include "robots.h"
#include "mission.h"

#define SYS_WRITE0 4u
#define SYS_EXIT_EXTENDED 0x20u
#define APPLICATION_EXIT 0x20026u

#if defined(__arm__)
extern uint32_t stack_top[];
void reset(void);
int main(void);

__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    void (*handlers[15])(void);
} vectors = {stack_top, {reset}};

static uintptr_t semihosting(uintptr_t operation, uintptr_t argument) {
    register uintptr_t r0 __asm__("r0") = operation;
    register uintptr_t r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

void reset(void) {
    /* The floating-point unit is off after a reset. */
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20;
    __asm__ volatile("dsb\n isb" ::: "memory");
    main();
}
#else
__asm__(".section .vectors,\"ax\"\n"
        ".global reset\n"
        "reset:\n"
        "la sp, stack_top\n"
        "li t0, 0x2000\n"
        ".option arch, +zicsr\n"
        "csrs mstatus, t0\n" /* the floating-point unit is off after a reset */
        "call main\n"
        "1: j 1b\n"
        ".text\n");

static uintptr_t semihosting(uintptr_t operation, uintptr_t argument) {
    register uintptr_t a0 __asm__("a0") = operation;
    register uintptr_t a1 __asm__("a1") = argument;
    __asm__ volatile(".balign 16\n"
                     ".option push\n"
                     ".option norvc\n"
                     "slli x0, x0, 0x1f\n"
                     "ebreak\n"
                     "srai x0, x0, 7\n"
                     ".option pop\n"
                     : "+r"(a0)
                     : "r"(a1)
                     : "memory");
    return a0;
}
#endif

__attribute__((used)) void *memcpy(void *to, const void *from, size_t bytes) {
    uint8_t *out = to;
    const uint8_t *in = from;
    while (bytes-- != 0) {
        *out++ = *in++;
    }
    return to;
}

__attribute__((used)) void *memset(void *to, int value, size_t bytes) {
    uint8_t *out = to;
    while (bytes-- != 0) {
        *out++ = (uint8_t)value;
    }
    return to;
}

static void print(const char *text) {
    semihosting(SYS_WRITE0, (uintptr_t)text);
}

static void print_number(uint64_t value, uint32_t radix, int digits) {
    static char text[24];
    char *at = text + sizeof text - 1;
    *at = 0;
    while (value != 0 || digits > 0) {
        uint32_t digit = (uint32_t)(value % radix);
        *--at = (char)(digit < 10 ? '0' + digit : 'a' + digit - 10);
        value /= radix;
        digits--;
    }
    print(at);
}

int main(void) {
    static twb_base base;
    struct mission_result result;
    mission_run(&base, lab_10kg, sizeof lab_10kg, TICKS, &result);
    print("hash ");
    print_number(result.hash, 16, 16);
    print(" parked ");
    print_number(result.parked, 10, 1);
    print(" states ");
    print_number(result.states, 16, 1);
    print(" faults ");
    print_number(result.faults, 16, 1);
    print(" refused ");
    print_number(result.refused, 10, 1);
    print(" error ");
    print(result.error == TWB_OK ? "0\n" : twb_status_text(result.error));
    {
        uintptr_t block[2] = {APPLICATION_EXIT, 0};
        semihosting(SYS_EXIT_EXTENDED, (uintptr_t)block);
    }
    return 0;
}
