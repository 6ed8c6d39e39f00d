"""PlatformIO: links the archive for the board's core."""

import os

Import("env")  # noqa: F821, of PlatformIO

CORES = {
    "cortex-m0": "cortex-m0plus",
    "cortex-m0plus": "cortex-m0plus",
    "cortex-m3": "cortex-m3",
    "cortex-m4": "cortex-m4",
    "cortex-m7": "cortex-m4",
    "cortex-m33": "cortex-m33",
    "esp32c2": "rv32imc",
    "esp32c3": "rv32imc",
    "esp32c6": "rv32imac",
    "esp32h2": "rv32imac",
    "esp32p4": "rv32imafc",
}

cpu = env.BoardConfig().get("build.cpu", "")  # noqa: F821
mcu = env.BoardConfig().get("build.mcu", "")  # noqa: F821
core = CORES.get(cpu) or CORES.get(mcu)
flags = " ".join(str(flag) for flag in env.get("CCFLAGS", []))  # noqa: F821
if core in ("cortex-m4", "cortex-m33") and "float-abi=hard" in flags:
    core += "f"
if core is None:
    # Xtensa, and what else there is: `src/twb_portable.c` is compiled.
    env.Append(CPPDEFINES=["TWB_PORTABLE"])  # noqa: F821
else:
    here = os.path.dirname(os.path.realpath("platformio.py"))
    env.Append(LIBPATH=[os.path.join(here, "lib", core)], LIBS=["twb"])  # noqa: F821
