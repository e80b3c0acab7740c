#!/usr/bin/env bash
# ezdxf 1.4.2 declares a new drawing to be in meters, whatever its coordinates are meant in, and drops the unit of a drawing of R12.
#
# Expected: a drawing without a unit ($INSUNITS 0) until somebody sets one, or millimeters, as its own header variable $MEASUREMENT 1 (metric) suggests.
# A gear that is drawn in millimeters, tip circle 52, is a gear of 52 meters to a program that follows $INSUNITS. In R12 the variable does not
# exist: `doc.units = 4` (mm) is taken, told by the log alone, and not written.
# Do instead: set `doc.units` before saving, and write R2000 or later.
#
# Seen:
# R2010 as made: 6; R2010 in mm: 4; R12 in mm: None
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet ezdxf==1.4.2
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import io
import logging

import ezdxf

logging.getLogger("ezdxf").setLevel(logging.CRITICAL)

METERS, MILLIMETERS = 6, 4


def written(version: str, units: int | None) -> str:
    """The text of a drawing of a tip circle."""
    doc = ezdxf.new(version)
    if units is not None:
        doc.units = units
    doc.modelspace().add_circle((0, 0), 52)
    text = io.StringIO()
    doc.write(text)
    return text.getvalue()


def told(text: str) -> int | None:
    """The value of $INSUNITS, as any reader of DXF finds it: behind the group code 70."""
    lines = [line.strip() for line in text.splitlines()]
    return int(lines[lines.index("$INSUNITS") + 2]) if "$INSUNITS" in lines else None


assert ezdxf.__version__ == "1.4.2", ezdxf.__version__
as_made = told(written("R2010", None))
in_mm = told(written("R2010", MILLIMETERS))
old = told(written("R12", MILLIMETERS))
print(f"R2010 as made: {as_made}; R2010 in mm: {in_mm}; R12 in mm: {old}")
assert as_made == METERS, "a new drawing is not in meters any more: the finding has ended"
assert in_mm == MILLIMETERS
assert old is None, "R12 has the unit now: the finding has ended"
PYTHON
