"""Which Mitsuba variant renders, and the one place that imports Mitsuba and Dr.Jit for the rest.

Both are handed out as Any: Mitsuba's types depend on the variant, which is known only at run time.
"""

from __future__ import annotations

from typing import Any

from rectbench import llvm
from rectbench.errors import Unavailable

PREFERRED = "llvm_ad_rgb"
FALLBACK = "cuda_ad_rgb"


def mitsuba() -> Any:
    """The module `mitsuba` with a variant that can render here.

    A variant that was set already is kept, so that a session on CUDA stays there. Otherwise LLVM,
    and CUDA where no usable libLLVM is found. Raises Unavailable where neither is to be had, or
    where the variant set is none of the compiled RGB ones.
    """
    llvm.choose_library()  # has to happen before Dr.Jit is imported
    try:
        import mitsuba as mi
    except ImportError as error:
        raise Unavailable(f"rendering needs Mitsuba: {error}") from None

    if mi.variant() is None:
        mi.set_variant(PREFERRED if llvm.available() or not _has_cuda() else FALLBACK)
    variant = str(mi.variant())
    if not variant.endswith("_rgb") or variant.startswith("scalar"):
        raise Unavailable(f"the Mitsuba variant is {variant}; expected {PREFERRED} or {FALLBACK}")
    if variant.startswith("llvm"):
        llvm.require()
    return mi


def drjit() -> Any:
    """The module `drjit`, with the libLLVM that rectbench chose."""
    llvm.choose_library()
    import drjit as dr

    return dr


def _has_cuda() -> bool:
    dr = drjit()
    return bool(dr.has_backend(dr.JitBackend.CUDA))
