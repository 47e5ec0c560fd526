"""Measurements of one's own as recordings, for `dea reduce`."""

import csv
import os
import pathlib
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from typing import Union

from ._api import FileError

Path = Union[str, "os.PathLike[str]"]


def write_recording(path: Path, time_s: Sequence[float], channels: Mapping[str, Sequence[float]],
                    design: Union[Path, None] = None, replace: bool = False) -> None:
    """Writes a recording that `dea reduce` takes.

    channels: a title with its unit, "voltage (kV)", "current (uA)", "displacement (um)",
    "force (mN)", and as many values as time_s has, which rises; nan is a gap. What a channel is
    follows from its title, as in `dea import`. design: of the specimen. It is written by the
    command dea, of DEA_COMMAND or on the PATH, in a build with the bench.
    """
    for title, values in channels.items():
        if len(values) != len(time_s):
            raise ValueError(f"'{title}' has {len(values)} values, and time_s {len(time_s)}")
    with tempfile.TemporaryDirectory() as folder:
        table = pathlib.Path(folder) / (pathlib.Path(path).stem + ".csv")
        with table.open("w", newline="") as file:
            rows = csv.writer(file)
            rows.writerow(["time (s)", *channels])
            rows.writerows(zip(map(float, time_s), *(map(float, v) for v in channels.values())))
        options = ["--force"] if replace else []
        options += ["--design", os.fspath(design)] if design is not None else []
        done = subprocess.run([os.environ.get("DEA_COMMAND", "dea"), "import", str(table), "-o",
                               os.fspath(path), *options], capture_output=True, text=True)
    if done.returncode != 0:
        raise FileError("DEA_E_IO", done.stderr.strip(), [], "")
