"""Plays a protocol to a SCPI supply by pyvisa (GPIB, USBTMC, LAN), slowly, and records it.

    python play_visa.py PROTOCOL ADDRESS RECORDING.h5

HIGH VOLTAGE. Tried with an imitation of pyvisa only: begin without the film, and compare commands
and factors with your supply's manual. There are no interlocks here but the supply's own limits.
"""

import sys
import time

import pyvisa

import dea
from checked_waveform import checked_waveform

STEP_S = 0.05  # from one command to the next


def play(supply, times, voltages):
    """Rows of time [s], commanded voltage [V], voltage [V] and current [A], as read back."""
    rows, began = [], time.monotonic()
    supply.write("SOUR:VOLT 0")
    supply.write("OUTP ON")
    try:
        while (now := time.monotonic() - began) <= times[-1]:
            asked = voltages[min(range(len(times)), key=lambda i: abs(times[i] - now))]
            supply.write(f"SOUR:VOLT {asked:.6g}")
            rows.append((now, asked, float(supply.query("MEAS:VOLT?")),
                         float(supply.query("MEAS:CURR?"))))
            time.sleep(STEP_S)
    finally:
        supply.write("SOUR:VOLT 0")
        supply.write("OUTP OFF")
    return rows


def main(protocol, address, recording):
    times, voltages, _ = checked_waveform(protocol)
    with pyvisa.ResourceManager().open_resource(address) as supply:
        rows = play(supply, times, voltages)
        print("at the end:", supply.query("MEAS:VOLT?").strip(), "V")
    t, asked, voltage, current = zip(*rows)
    dea.write_recording(recording, t, {"commanded voltage (V)": asked, "voltage (V)": voltage,
                                       "current (A)": current})


if __name__ == "__main__":
    main(*sys.argv[1:])
