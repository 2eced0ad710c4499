"""A free decay whose backbone is known: writes decay.csv beside itself.

One mode with frequency 100 Hz (1 - 0.02 a/50) and damping ratio 0.001 + 0.004 a/50 at the acceleration a [m/s2], from
50 m/s2, with sensor noise of 0.02 m/s2.
"""

from pathlib import Path

import numpy as np

RATE, LENGTH, FIRST = 1000, 3.0, 50.0  # samples a second, s, m/s2
FINE = 20  # steps between two samples


def frequency(a):
    """[Hz] at an acceleration amplitude [m/s2]."""
    return 100.0 * (1 - 0.02 * a / FIRST)


def damping(a):
    """Ratio to critical at an acceleration amplitude [m/s2]."""
    return 0.001 + 0.004 * a / FIRST


def main() -> None:
    """Integrate amplitude and phase, and write what a sensor sees."""
    step = 1 / (RATE * FINE)
    a, phase, amplitudes, phases = FIRST, 0.0, [], []
    for k in range(int(RATE * LENGTH * FINE)):
        if k % FINE == 0:
            amplitudes.append(a)
            phases.append(phase)
        w = 2 * np.pi * frequency(a)
        # d(w q^2)/dt = -2 zeta w (w q^2) with a = w^2 q: what the definition of damping says of the acceleration
        bend = (frequency(a * 1.001) - frequency(a)) / (0.001 * frequency(a))  # d ln w/d ln a
        a += step * -damping(a) * w * a / (1 - 1.5 * bend)
        phase += step * w
    signal = np.array(amplitudes) * np.cos(phases) + np.random.default_rng(0).normal(0, 0.02, len(phases))
    rows = [f"{k / RATE:.3f},{x:.3f}" for k, x in enumerate(signal)]
    Path(__file__).with_name("decay.csv").write_text("\n".join(["time [s],acceleration [m/s^2]", *rows, ""]))


if __name__ == "__main__":
    main()
