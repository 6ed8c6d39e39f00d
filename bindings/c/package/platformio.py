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
    # Xtensa: `src/twb_portable.c` is compiled.
    "esp8266": "portable",
    "esp32": "portable",
    "esp32s2": "portable",
    "esp32s3": "portable",
}

cpu = env.BoardConfig().get("build.cpu", "")  # noqa: F821
mcu = env.BoardConfig().get("build.mcu", "")  # noqa: F821
core = CORES.get(cpu) or CORES.get(mcu)
if core is None:
    raise SystemExit("twb: no archive for cpu '%s', mcu '%s'" % (cpu, mcu))
flags = " ".join(str(flag) for flag in env.get("CCFLAGS", []))  # noqa: F821
if core in ("cortex-m4", "cortex-m33") and "float-abi=hard" in flags:
    core += "f"
if core != "portable":
    here = os.path.dirname(os.path.realpath("platformio.py"))
    env.Append(LIBPATH=[os.path.join(here, "lib", core)], LIBS=["twb"])  # noqa: F821
