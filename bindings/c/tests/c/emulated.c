/* An emulated board without C library: entry, printing by semihosting, and the little that programs and compilers call. */
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define SYS_WRITE0 4u
#define SYS_EXIT_EXTENDED 0x20u
#define APPLICATION_EXIT 0x20026u

void finish(int status);
int main(void);

#if defined(__arm__)
extern uint32_t stack_top[];
void reset(void);

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
    finish(main());
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
        "call finish\n"
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

void *memcpy(void *to, const void *from, size_t bytes) {
    uint8_t *out = to;
    const uint8_t *in = from;
    while (bytes-- != 0) {
        *out++ = *in++;
    }
    return to;
}

void *memset(void *to, int value, size_t bytes) {
    uint8_t *out = to;
    while (bytes-- != 0) {
        *out++ = (uint8_t)value;
    }
    return to;
}

int memcmp(const void *one, const void *other, size_t bytes) {
    const uint8_t *left = one, *right = other;
    for (; bytes != 0; bytes--, left++, right++) {
        if (*left != *right) {
            return *left - *right;
        }
    }
    return 0;
}

int strcmp(const char *one, const char *other) {
    while (*one != 0 && *one == *other) {
        one++, other++;
    }
    return *one - *other;
}

static char *number(uint64_t value, uint32_t radix, int digits, char *end) {
    *end = 0;
    while (value != 0 || digits > 0) {
        uint32_t digit = (uint32_t)(value % radix);
        *--end = (char)(digit < 10 ? '0' + digit : 'a' + digit - 10);
        value /= radix;
        digits--;
    }
    return end;
}

/* As far as the tests need it: %s, %u, %d of what is positive, %x, and %X of 64 bits in 16 digits. */
int printf(const char *format, ...) {
    va_list values;
    va_start(values, format);
    for (; *format != 0; format++) {
        char text[24], *end = text + sizeof text - 1;
        const char *part = text;
        if (*format != '%') {
            text[0] = *format;
            text[1] = 0;
        } else {
            switch (*++format) {
            case 's': part = va_arg(values, const char *); break;
            case 'X': part = number(va_arg(values, uint64_t), 16, 16, end); break;
            case 'x': part = number(va_arg(values, unsigned), 16, 1, end); break;
            default: part = number(va_arg(values, unsigned), 10, 1, end); break;
            }
        }
        semihosting(SYS_WRITE0, (uintptr_t)part);
    }
    va_end(values);
    return 0;
}

void finish(int status) {
    uintptr_t block[2] = {APPLICATION_EXIT, (uintptr_t)status};
    for (;;) {
        semihosting(SYS_EXIT_EXTENDED, (uintptr_t)block);
    }
}
