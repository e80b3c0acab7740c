#!/usr/bin/env bash
# pyuff 2.5.8 leaves nothing but an end mark of a binary dataset 58 that it writes with "overwrite", and says nothing.
#
# Expected: a file with the set, as "add" writes it and as "overwrite" does in ASCII. Dataset 58 of the Universal File Format is how measured transmission
# errors and responses are passed on. The text before the values is written, the file is opened anew for the binary values, which empties it, and
# once more for the end mark, which empties it again: 7 bytes are left of any record, without an exception.
# Do instead: write to a new file with "add", and read it back.
#
# Seen (a record of 100 values):
# add 1722 bytes, 100 values; overwrite 7 bytes: b'    -1\n'
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet pyuff==2.5.8 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pyuff

assert version("pyuff") == "2.5.8", version("pyuff")
VALUES = np.sin(np.arange(100.0))


def written(mode: str, binary: int) -> Path:
    """A new file with one evenly spaced record."""
    file = Path(f"{mode}-{binary}.uff")
    record = {"type": 58, "binary": binary, "func_type": 1, "rsp_node": 1, "rsp_dir": 3, "ref_node": 1, "ref_dir": 3, "id1": "transmission error in um"}
    record |= {"x": np.arange(100) / 1024, "data": VALUES, "abscissa_spacing": 1, "orddenom_spec_data_type": 0}
    pyuff.UFF(str(file)).write_sets(record, mode)
    return file


added, overwritten = written("add", 1), written("overwrite", 1)
values = pyuff.UFF(str(added)).read_sets()["data"]
print(f"add {added.stat().st_size} bytes, {len(values)} values; overwrite {overwritten.stat().st_size} bytes: {overwritten.read_bytes()[:20]!r}")
assert np.array_equal(values, VALUES), "added, the record is whole"
assert np.allclose(pyuff.UFF(str(written("overwrite", 0))).read_sets()["data"], VALUES), "in ASCII, overwriting is whole"
assert overwritten.read_bytes() == b"    -1\n", "the file holds something else now: the finding has ended"
PYTHON
