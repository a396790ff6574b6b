"""What Dr.Jit loads is there before it is imported."""

import ctypes
import platform
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from rectbench import atomic, llvm

ON_LINUX_X86_64 = sys.platform == "linux" and platform.machine() == "x86_64"


@pytest.mark.skipif(not ON_LINUX_X86_64, reason="the stand-in for libatomic is for Linux on x86-64")
def test_the_stand_in_for_libatomic_compares_and_exchanges_sixteen_bytes() -> None:
    # In a process of its own: two libraries of one soname do not live in one process.
    library = Path(atomic.__file__).with_name(atomic.SONAME)
    code = f"""
import ctypes
swap = ctypes.CDLL({str(library)!r}).__getattr__("__atomic_compare_exchange_16")
swap.restype = ctypes.c_bool
pointer, word = ctypes.c_void_p, ctypes.c_uint64
swap.argtypes = [pointer, pointer, word, word, ctypes.c_int, ctypes.c_int]
room = ctypes.create_string_buffer(64)
place = ctypes.addressof(room) + 15 & ~15
value = (ctypes.c_uint64 * 2).from_address(place)
expected = (ctypes.c_uint64 * 2)(1, 2)
value[:] = 1, 2
assert swap(place, ctypes.addressof(expected), 3, 4, 5, 5) and value[:] == [3, 4]
assert not swap(place, ctypes.addressof(expected), 9, 9, 5, 5)
assert value[:] == expected[:] == [3, 4]
"""
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.skipif(not ON_LINUX_X86_64, reason="the stand-in for libatomic is for Linux on x86-64")
def test_the_stand_in_for_libatomic_is_what_its_source_says_it_is_built_from(tmp_path: Path) -> None:
    folder = Path(atomic.__file__).parent
    committed = (folder / atomic.SONAME).read_bytes()
    if shutil.which("gcc") is None:
        pytest.skip("there is no gcc here")
    version = subprocess.run(["gcc", "--version"], capture_output=True, text=True, check=True).stdout
    compiler = version.splitlines()[0].removeprefix("gcc ")
    if f"GCC: {compiler}".encode() not in committed:
        pytest.skip(f"gcc is {compiler}, not the one that the stand-in was built with")
    for name in ("compare_exchange.c", "libatomic.map"):
        shutil.copy(folder / name, tmp_path)
    source = (folder / "compare_exchange.c").read_text()
    command = re.search(r"gcc -Os.*?compare_exchange\.c", source, re.DOTALL)
    assert command is not None
    subprocess.run(re.sub(r"\\\n \*", "", command[0]).split(), cwd=tmp_path, check=True)
    assert (tmp_path / atomic.SONAME).read_bytes() == committed


@pytest.mark.skipif(not ON_LINUX_X86_64, reason="libLLVM comes with the install on Linux x86-64 only")
def test_kernels_can_be_compiled_with_what_the_install_brings() -> None:
    assert llvm.problem() is None


def test_the_systems_own_libatomic_is_preferred(monkeypatch: pytest.MonkeyPatch) -> None:
    loaded: list[str] = []
    monkeypatch.setattr(ctypes, "CDLL", lambda name, *_, **__: loaded.append(name))
    atomic.provide()
    assert loaded in ([], [atomic.SONAME])
