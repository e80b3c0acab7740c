#!/usr/bin/env bash
# pyuff 2.5.8 declares the length of a binary dataset 58 as that of real, evenly spaced values, whatever it writes.
#
# Expected: the number of bytes that follow (dataset 58b, identifier line, field 6). Complex values, such as a frequency response, take twice as many, and
# an uneven abscissa, such as the times of an encoder's marks, takes eight more a value. Whoever reads by the declared length gets the first
# half, two thirds or third of the record, and finds numbers where the end mark should be. pyuff itself looks for the end mark and does not notice.
# Do instead: write evenly spaced records, complex ones in ASCII; or mend columns 32 to 43 of the identifier line.
#
# Seen (a record of 100 values):
# real, even:      declared  800, there  800
# real, uneven:    declared  800, there 1600
# complex, even:   declared  800, there 1600
# complex, uneven: declared  800, there 2400
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
REAL = np.sin(np.arange(100.0))


def lengths(name: str, values: np.ndarray, even: int) -> tuple[int, int]:
    """The bytes of values that the file declares, and those that stand between its 11 lines of text and its end mark."""
    record = {"type": 58, "binary": 1, "func_type": 4, "rsp_node": 1, "rsp_dir": 3, "ref_node": 1, "ref_dir": 3, "id1": name}
    record |= {"x": np.arange(100) / 1024, "data": values, "abscissa_spacing": even, "orddenom_spec_data_type": 0}
    pyuff.UFF(name).write_sets(record, "add")
    text = Path(name).read_bytes()
    begin = text.index(b"    -1\n    58b")
    *header, body = text[begin:].split(b"\n", 13)
    assert len(header) == 13, "a mark, the identifier and 11 lines"
    return int(header[1][31:43]), body.rindex(b"    -1")


CASES = {"real, even": (REAL, 1, 800), "real, uneven": (REAL, 0, 1600), "complex, even": (REAL * (1 + 2j), 1, 1600), "complex, uneven": (REAL * (1 + 2j), 0, 2400)}
for name, (values, even, expected) in CASES.items():
    declared, there = lengths(name, values, even)
    print(f"{name + ':':16} declared {declared:4}, there {there:4}")
    assert there == expected, "as many as the format asks for"
    assert declared == 800, "the length is declared otherwise now: the finding has ended"
PYTHON
