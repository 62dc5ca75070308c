"""The command that does the work: where it is, how it is run, what its exit codes mean."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

UNSOUND = 1
"""Exit code of a world that breaks a hard rule: its report is written, the world is not."""


class _Coded(Exception):
    """An error of the command; `code` is its stable name, which `d3dgen explain CODE` tells more about."""

    def __init__(self, message: str, code: str = "") -> None:
        super().__init__(message)
        self.code = code


class Refused(_Coded, ValueError):
    """The request cannot be met; the message says what is wrong and what would work."""


class Unsound(_Coded, RuntimeError):
    """A world was made that breaks a hard rule; the message says which."""


def program() -> str:
    """Returns the path of the command: $D3DGEN_PROGRAM, the one installed with this package, or the one on the PATH.

    Raises FileNotFoundError when there is none.
    """
    name = "d3dgen.exe" if sys.platform == "win32" else "d3dgen"
    if named := os.environ.get("D3DGEN_PROGRAM"):
        return named
    schemes = [sysconfig.get_path("scripts"), sysconfig.get_path("scripts", f"{os.name}_user")]
    for folder in schemes:
        if (installed := Path(folder) / name).is_file():
            return str(installed)
    if found := shutil.which(name):
        return found
    raise FileNotFoundError("the command d3dgen is not installed; `pip install d3dgen` brings it, or set D3DGEN_PROGRAM")


def run(*arguments: str) -> str:
    """Runs the command and returns what it prints on standard output.

    Raises Refused or Unsound with what it says on standard error.
    """
    command = [program(), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=False)
    if done.returncode == 0:
        return done.stdout
    said = done.stderr.strip()
    said, _, code = said.rpartition("\ncode: ") if "\ncode: " in said else (said, "", "")
    reason = said.rsplit("error: ", 1)[-1]
    raise (Unsound if done.returncode == UNSOUND else Refused)(reason or f"d3dgen ended with {done.returncode}", code)
