"""Declarations of dea.h for cffi, as a module of Python: nothing is compiled.

setup.py calls it; by hand: build_cffi.py HEADER OUTPUT.py
"""

import pathlib
import re
import sys

import cffi

HERE = pathlib.Path(__file__).resolve().parent


def declarations(header: pathlib.Path) -> str:
    """What stands between the marks of dea.h."""
    parts = re.findall(r"/\* \[declarations\] \*/(.*?)/\* \[end\] \*/", header.read_text(), re.S)
    if not parts:
        raise SystemExit(f"{header}: no declarations between marks")
    return "\n".join(parts)


def find_header() -> pathlib.Path:
    """The copy of a source package, or the one of the repository."""
    for path in (HERE / "dea.h", HERE.parent / "src" / "api" / "dea.h"):
        if path.exists():
            return path
    raise SystemExit("dea.h is neither here nor in ../src/api")


def builder(header: pathlib.Path) -> cffi.FFI:
    ffi = cffi.FFI()
    ffi.cdef(declarations(header))
    ffi.set_source("dea._cffi", None)
    return ffi


if __name__ == "__main__":
    builder(pathlib.Path(sys.argv[1])).emit_python_code(sys.argv[2])
else:
    ffibuilder = builder(find_header())
