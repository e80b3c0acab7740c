#!/usr/bin/env bash
# mosqito 1.2.1 tells the lines of a spectrum at frequencies that are one line too high.
#
# Expected: the first line of a discrete Fourier transform at 0 Hz, the k-th at k / T (T: length of the signal). The axis of `comp_spectrum` begins with
# 1 / T instead: the mean stands at 1 / T, a mesh frequency of 1000 Hz in 0.1 s at 1010 Hz, and in orders the whine of a gear moves to another order; the
# short signals of a run-up move farthest. The tones that `tnr_ecma_st` lists move with it.
# Do instead: subtract `freqs[0]` from the frequencies.
#
# Seen (1000 Hz and a mean, 48 kHz):
# 0.1 s: first line at 10.0 Hz, tone at 1010.0 Hz, its own 1000.0 Hz
# 1.0 s: first line at 1.0 Hz, tone at 1001.0 Hz, its own 1000.0 Hz
# tonality of 0.2 s: tone at 1005.0 Hz
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet mosqito==1.2.1 numpy==2.4.6 scipy==1.17.1 pyuff==2.5.8 matplotlib==3.11.2
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
from importlib.metadata import version

import numpy as np
from mosqito.sound_level_meter import comp_spectrum
from mosqito.sq_metrics import tnr_ecma_st

assert version("mosqito") == "1.2.1", version("mosqito")
RATE, TONE = 48000, 1000.0
for seconds in (0.1, 1.0):
    count = round(RATE * seconds)
    time = np.arange(count) / RATE
    signal = 0.5 + np.sin(2 * np.pi * TONE * time)
    lines, freqs = comp_spectrum(signal, RATE, db=False)
    largest = 20 + int(np.argmax(np.abs(lines[20:])))
    # The line that carries the tone, found without the axis: the sum of its own turns.
    turns = np.abs([signal @ np.exp(-2j * np.pi * k * np.arange(count) / count) for k in range(largest - 1, largest + 2)])
    own = (largest - 1 + int(np.argmax(turns))) / seconds
    print(f"{seconds} s: first line at {freqs[0]:.1f} Hz, tone at {freqs[largest]:.1f} Hz, its own {own:.1f} Hz")
    assert abs(own - TONE) < 1e-9
    assert abs(np.abs(lines[0]) / np.abs(lines[largest]) - 1) < 1e-3, "the mean 0.5 is the first line: as large as a tone of amplitude 1 in two halves"
    assert abs(freqs[0] - 1 / seconds) < 1e-9 and abs(freqs[largest] - TONE - 1 / seconds) < 1e-9, "the axis begins with 0 Hz now: the finding has ended"
time = np.arange(RATE // 5) / RATE
noise = np.random.default_rng(0).normal(0, 0.02, len(time))
tones = tnr_ecma_st(0.2 * np.sin(2 * np.pi * TONE * time) + noise, RATE)[3]
print(f"tonality of 0.2 s: tone at {tones[0]:.1f} Hz")
assert len(tones) == 1 and abs(tones[0] - TONE - 5) < 1e-6
PYTHON
