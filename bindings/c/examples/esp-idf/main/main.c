/* The CMake example as ESP-IDF begins it. */
#define main park
#include "../../cmake/main.c"
#undef main

void app_main(void) {
    park();
}
