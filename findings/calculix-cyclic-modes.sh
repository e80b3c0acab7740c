#!/usr/bin/env bash
# CalculiX 2.20 lists each natural mode of 0 nodal diameters twice when it computes a sector in cyclic symmetry.
#
# Expected: as often as the whole disc has it. A mode of n nodal diameters is a pair, cosine and sine, but for n = 0 and, with an even number N of
# sectors, n = N/2: these stand alone, and a whole disc lists them once. In cyclic symmetry every frequency comes twice, whatever its diameter, because
# the eigenproblem is solved in complex form. Asking for 4 modes of diameter 0 gives 2, and the k-th mode of the list is not the k-th of the disc.
# Do instead: compare modes by nodal diameter and drop every second one of 0 and N/2 diameters; ask there for twice the number.
#
# Seen (Hz):
# whole disc:          2069.9 2069.9 2099.1 2389.8 2389.8
# sector, 0 diameters: 2099.1 2099.1 9412.8 9412.8
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
# Debian 12: the program and all that it needs but the C library, unpacked beside each other and installed nowhere.
needed=$(apt-cache depends --recurse --no-recommends --no-suggests --no-conflicts --no-breaks --no-replaces --no-enhances calculix-ccx \
    | grep --extended-regexp '^(lib|gcc)' | grep --extended-regexp --invert-match '^(libc6|libatlas|libblis|libopenblas|libc-|libcrypt)' | sort --unique)
# Virtual packages, which have no file, are left out one by one.
for package in calculix-ccx=2.20-1 $needed; do apt-get download "$package" >/dev/null 2>&1 || true; done
for file in *.deb; do dpkg-deb --extract "$file" root; done
libraries=root/usr/lib/$(dpkg-architecture --query DEB_HOST_MULTIARCH 2>/dev/null || echo "$(uname -m)-linux-gnu")
export LD_LIBRARY_PATH="$folder/$libraries:$folder/$libraries/blas:$folder/$libraries/lapack"
export CCX="$folder/root/usr/bin/ccx"
python3 - <<'PYTHON'
import math
import os
import re
import subprocess
from pathlib import Path

SECTORS, ALONG, ACROSS = 6, 4, 6


def deck(sectors: int) -> str:
    """A disc of 20 to 60 mm, 4 mm thick, held at its bore: whole, or one sector of six."""
    whole, steps = sectors == SECTORS, ALONG * sectors
    number: dict[tuple[int, int, int], int] = {}

    def node(i: int, j: int, k: int) -> int:
        return number.setdefault((i, j % steps if whole else j, k), len(number) + 1)

    corners = ((0, 0), (1, 0), (1, 1), (0, 1))
    bricks = [[node(i + a, j + b, k) for k in (0, 1) for a, b in corners] for j in range(steps) for i in range(ACROSS)]
    radius = [20 + 40 * i / ACROSS for i in range(ACROSS + 1)]
    turn = [2 * math.pi * j / (ALONG * SECTORS) for j in range(steps + 1)]

    def group(name: str, chosen: list[int]) -> list[str]:
        return [f"*NSET,NSET={name}", *(f"{n}," for n in chosen)]

    lines = ["*NODE,NSET=ALL", *(f"{n},{radius[i] * math.cos(turn[j]):.9f},{radius[i] * math.sin(turn[j]):.9f},{4 * k}" for (i, j, k), n in number.items())]
    lines += ["*ELEMENT,TYPE=C3D8I,ELSET=DISC", *(",".join(map(str, [e, *brick])) for e, brick in enumerate(bricks, 1))]
    lines += group("HELD", [n for (i, _, _), n in number.items() if i == 0])
    if not whole:
        for name, side in (("LOW", 0), ("HIGH", steps)):
            lines += group(name, [n for (i, j, _), n in number.items() if j == side and i > 0])
            lines += [f"*SURFACE,NAME=OF{name},TYPE=NODE", name]
        lines += ["*TIE,POSITION TOLERANCE=0.01,CYCLIC SYMMETRY,NAME=SIDES", "OFLOW,OFHIGH"]
        lines += [f"*CYCLIC SYMMETRY MODEL,N={SECTORS},NGRAPH={SECTORS},TIE=SIDES", "0,0,0,0,0,1"]
    lines += ["*BOUNDARY", "HELD,1,3", "*MATERIAL,NAME=STEEL", "*ELASTIC", "210000,0.3", "*DENSITY", "7.85E-9", "*SOLID SECTION,ELSET=DISC,MATERIAL=STEEL"]
    lines += ["*STEP", "*FREQUENCY", "5" if whole else "4", *([] if whole else ["*SELECT CYCLIC SYMMETRY MODES,NMIN=0,NMAX=0"])]
    return "\n".join([*lines, "*NODE FILE", "U", "*END STEP", ""])


def frequencies(name: str, sectors: int) -> list[float]:
    """The natural frequencies in Hz that the program lists, in its order."""
    Path(f"{name}.inp").write_text(deck(sectors))
    said = subprocess.run([os.environ["CCX"], "-i", name], capture_output=True, text=True, check=True).stdout
    assert "Version 2.20" in said, said[:300]
    table = Path(f"{name}.dat").read_text().split("P A R T I C I P A T I O N")[0]
    rows = [line.split() for line in table.splitlines() if re.match(r"\s+\d+\s", line)]
    return [float(row[-2]) for row in rows]


whole, sector = frequencies("whole", SECTORS), frequencies("sector", 1)
print("whole disc:         ", *(f"{hz:.1f}" for hz in whole))
print("sector, 0 diameters:", *(f"{hz:.1f}" for hz in sector))
same = lambda one, other: abs(one / other - 1) < 1e-5  # noqa: E731
assert sum(same(hz, sector[0]) for hz in whole) == 1, "the disc has the mode of no nodal diameter once"
assert len(sector) == 4 and same(sector[0], sector[1]) and same(sector[2], sector[3]) and not same(sector[1], sector[2]), "the finding has ended"
PYTHON
