/* Of `emulated.c`: a cross compiler may come without a C library. */
int printf(const char *format, ...);
