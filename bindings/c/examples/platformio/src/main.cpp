// The Arduino example as PlatformIO has it.
#include <Arduino.h>

#include "../../arduino/park/park.ino"
