#!/usr/bin/env bash
# pyFRF 1.5.0 tells an amplitude spectrum a thousand times too small, and by a factor that hangs on the length of the signal.
#
# Expected: the amplitude of a harmonic, 2 N for 2 N sin, whatever the length of the record and the rate: `get_exc_spectrum(amplitude_spectrum=True)` is "Get
# excitation amplitude/power spectrum". Inside, the root of a power spectral density is multiplied by the factor of a plain Fourier transform, 2 / n, so that
# an amplitude a comes out as 2 a / n sqrt(T / 2) (n samples in T s). A longer record seems to have less force. `get_resp_spectrum` does the same.
# Frequency response functions are right, because the factor is in both spectra.
# Do instead: take `2 / n * abs(numpy.fft.rfft(x))`, or multiply by n sqrt(1 / (2 T)) (window "none").
#
# Seen (2 N at 50 Hz, 2000 Hz):
# 0.5 s: pyFRF 0.002000 N, Fourier transform 2.000000 N
# 1.0 s: pyFRF 0.001414 N, Fourier transform 2.000000 N
# 4.0 s: pyFRF 0.000707 N, Fourier transform 2.000000 N
set -euo pipefail
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet pyFRF==1.5.0 sdypy-sep005==1.0.1 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'PYTHON'
import math
from importlib.metadata import version

import numpy as np
from pyFRF import FRF

assert version("pyFRF") == "1.5.0", version("pyFRF")
RATE, HZ, FORCE, COMPLIANCE = 2000, 50, 2.0, 1.5
for seconds in (0.5, 1.0, 4.0):
    count, line = round(RATE * seconds), round(HZ * seconds)
    force = FORCE * np.sin(2 * np.pi * HZ * np.arange(count) / RATE)
    test = FRF(sampling_freq=RATE, exc=force, resp=COMPLIANCE * force, exc_type="f", resp_type="d", window="none", fft_len=count)
    told = float(np.abs(test.get_exc_spectrum(amplitude_spectrum=True)[0, line]))
    moved = float(np.abs(test.get_resp_spectrum(amplitude_spectrum=True)[0, line]))
    plain = float(2 / count * np.abs(np.fft.rfft(force))[line])
    print(f"{seconds} s: pyFRF {told:.6f} N, Fourier transform {plain:.6f} N")
    assert abs(plain / FORCE - 1) < 1e-9, "a whole number of periods: the amplitude is the line"
    assert abs(np.abs(test.get_FRF(frf_estimator="H1")[0, 0, line]) / COMPLIANCE - 1) < 1e-9, "the ratio of response to force is right"
    assert abs(told / (2 / count * FORCE * math.sqrt(seconds / 2)) - 1) < 1e-9, "the amplitude is told otherwise now: the finding has ended"
    assert abs(moved / told / COMPLIANCE - 1) < 1e-9
PYTHON
