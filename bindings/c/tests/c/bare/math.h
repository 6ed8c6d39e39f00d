#define NAN __builtin_nanf("")
#define HUGE_VALF __builtin_huge_valf()
