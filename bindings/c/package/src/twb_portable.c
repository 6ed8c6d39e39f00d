/* Arduino and PlatformIO compile what is in this folder: for cores without an archive, the C that `archives portable` wrote. */
#if defined(__XTENSA__) || defined(TWB_PORTABLE)
#include "../portable/twb.c"
#else
typedef int twb_is_in_an_archive;
#endif
