# SPDX-License-Identifier: MIT
"""Tells what can compute here: the processor, always, and the CUDA devices that this build and this machine offer."""

from __future__ import annotations

import importlib
import os
import platform
import sys
from dataclasses import dataclass
from typing import Any

from saddleback._saddleback import set_cuda_module


@dataclass(frozen=True)
class Device:
    """Something that `device="cpu"` or `device="cuda"` may run on."""

    kind: str
    """"cpu" or "cuda"."""
    name: str
    """For a person to read."""
    threads: int
    """Threads that `threads=0` uses; 0 for a CUDA device."""
    memory: int
    """Bytes; 0 when not known."""
    compute_capability: tuple[int, int] | None
    """Of a CUDA device, None for a processor."""
    index: int
    """The driver's number of a CUDA device, 0 for the processor."""

    def __str__(self) -> str:
        """One line for a person: the name and what it brings."""
        if self.compute_capability is None:
            return f"{self.name}, {self.threads} thread{'s' if self.threads != 1 else ''}"
        return f"{self.name}, {self.memory / 2**30:.0f} GiB, compute {'.'.join(map(str, self.compute_capability))}"


def devices() -> list[Device]:
    """List what can compute here: the processor first, then every usable CUDA device.

    Never raises: a build without the CUDA module, a machine without a driver and a driver without a device all mean
    that only the processor is listed; `cuda_status` tells which of them it is.
    """
    return [_processor(), *_cuda()[0]]


def cuda_status() -> str:
    """Say in one sentence whether CUDA can be used here and, when not, why. Never raises."""
    found, reason = _cuda()
    if not found:
        return reason
    return f"{len(found)} CUDA device{'s' if len(found) != 1 else ''} can be used"


def _usable_cuda_devices(wanted: list[int] | None) -> list[int] | str:
    """Return the driver's numbers of the wanted ones of the usable CUDA devices, or a sentence telling why not.

    None wants all.

    The library is told what the CUDA module offers: from here on it can be called.
    """
    found, reason = _cuda()
    if not found:
        return reason
    places = range(len(found)) if wanted is None else wanted
    for place in places:
        if place >= len(found):
            return f"there is no CUDA device {place}; the usable ones are 0 to {len(found) - 1}"
    set_cuda_module(_cuda_module().functions)
    return [found[place].index for place in places]


def _processor() -> Device:
    threads = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return Device("cpu", _processor_name(), threads, _processor_memory(), None, 0)


def _processor_name() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8", errors="replace") as lines:
            for line in lines:
                key, _, value = line.partition(":")
                if key.strip() == "model name" and value.strip():
                    return value.strip()
    except OSError:
        pass
    return platform.processor() or "CPU"


def _processor_memory() -> int:
    if sys.platform == "win32":
        import ctypes

        status = (ctypes.c_uint64 * 8)(64)  # MEMORYSTATUSEX: its size, then the memory that there is, then more
        return status[1] if ctypes.windll.kernel32.GlobalMemoryStatusEx(status) else 0
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return 0


def _cuda() -> tuple[list[Device], str]:
    """Return the usable CUDA devices and, when there are none, the reason."""
    module = _cuda_module()
    if isinstance(module, str):
        return [], module
    try:
        answer = module.cuda_devices()
    except Exception as error:  # whatever a broken driver does, the processor still computes
        return [], f"CUDA cannot be asked for its devices: {error}"
    found = [
        Device("cuda", one.name, 0, one.memory, (one.compute_major, one.compute_minor), one.index)
        for one in answer.usable
    ]
    return found, answer.reason


def _cuda_module() -> Any:
    """Return the CUDA module, or a sentence telling why there is none."""
    try:
        return importlib.import_module("saddleback._saddleback_cuda")
    except ModuleNotFoundError:
        return "This build of saddleback has no CUDA module"
    except ImportError as error:
        return f"The CUDA module cannot be loaded: {error}"
