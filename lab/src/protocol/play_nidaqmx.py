# From here on the same for every protocol.
import csv
import math
import os
import signal
import sys
import time

import nidaqmx
from nidaqmx.constants import AcquisitionType

BLOCK_S = 0.1  # read at once: a signal is noticed after that time
LATE_S = 0.05  # that the output may go on before it is stopped
FOLDER = os.path.dirname(os.path.abspath(__file__))

stopped = []  # why, once somebody asked for it


def on_signal(number, frame):
    stopped.append("signal %d" % number)


def physical(device, terminal):
    return terminal if "/" in terminal else device + "/" + terminal


def read_waveform():
    """Asked voltages [kV] and control voltages [V], one a sample; the last one is 0 V."""
    with open(os.path.join(FOLDER, "waveform.csv"), newline="") as file:
        rows = list(csv.reader(file))[1:]
    voltage = [float(row[1]) for row in rows]
    control = [float(row[2]) for row in rows]
    rounded = 1e-9 * (HIGHEST_V - LOWEST_V)
    if not all(LOWEST_V - rounded <= value <= HIGHEST_V + rounded for value in control):  # or NaN
        sys.exit(
            "waveform.csv goes beyond the %g V to %g V of control voltage that were checked"
            % (LOWEST_V, HIGHEST_V)
        )
    largest = max(abs(value) for value in voltage)
    if not all(abs(v - GAIN / 1000 * c) <= 1e-6 * largest for v, c in zip(voltage, control)):
        sys.exit("the voltages in waveform.csv are not its control voltages times the gain")
    if control[-1] != 0:
        sys.exit("waveform.csv does not end at 0 V")
    return voltage, control


def ramp_to_zero(device, start):
    """From a control voltage to 0 V, by software; 0 V is written in any case."""
    with nidaqmx.Task() as output:
        output.ao_channels.add_ao_voltage_chan(
            physical(device, OUTPUT), min_val=-CONTROL_V, max_val=CONTROL_V
        )
        try:
            began = time.monotonic()
            left = abs(start)
            speed = max(RAMP_V_PER_S / GAIN, left / LONGEST_RAMP_S)
            while left > 0:
                output.write(math.copysign(left, start), auto_start=True)
                time.sleep(0.002)
                left = abs(start) - speed * (time.monotonic() - began)
        finally:
            output.write(0.0, auto_start=True)


class Trip:
    """A current that stays above the limit ends the measurement."""

    def __init__(self):
        self.run = [0] * len(CHANNELS)

    def look(self, rows):
        for row in rows:
            for i, channel in enumerate(CHANNELS):
                above = channel["trip"] is not None and abs(row[i]) > channel["trip"]
                self.run[i] = self.run[i] + 1 if above else 0
                if self.run[i] >= TRIP_SAMPLES:
                    return "the current '%s' was above its limit" % channel["title"]
        return None


def prepare(device, output, inputs, control):
    output.ao_channels.add_ao_voltage_chan(
        physical(device, OUTPUT), min_val=-CONTROL_V, max_val=CONTROL_V
    )
    for channel in CHANNELS:
        inputs.ai_channels.add_ai_voltage_chan(
            physical(device, channel["terminal"]), min_val=-channel["range"], max_val=channel["range"]
        )
    inputs.timing.cfg_samp_clk_timing(
        RATE_HZ, sample_mode=AcquisitionType.FINITE, samps_per_chan=len(control)
    )
    rate = inputs.timing.samp_clk_rate  # that of the device's clock, divided
    if abs(rate - RATE_HZ) > 1e-7 * RATE_HZ:
        sys.exit(
            "the device has no rate of %.12g Hz; write 'rate: %.12g Hz' into the protocol and export it "
            "again" % (RATE_HZ, rate)
        )
    first = physical(device, CHANNELS[0]["terminal"]).split("/")[0]
    clock = "/" + first + "/ai/SampleClock"  # one clock for both
    output.timing.cfg_samp_clk_timing(
        RATE_HZ, source=clock, sample_mode=AcquisitionType.FINITE, samps_per_chan=len(control)
    )
    output.write(control, auto_start=False)


def read_rows(inputs, count):
    """Values of all channels, a row a sample, in the units of their titles."""
    columns = inputs.read(number_of_samples_per_channel=count, timeout=3.0 + count / RATE_HZ)
    if len(CHANNELS) == 1:
        columns = [columns]
    scaled = [
        [volts * channel["scale"] + channel["offset"] for volts in column]
        for channel, column in zip(CHANNELS, columns)
    ]
    return [list(row) for row in zip(*scaled)]


def record(inputs, voltage, state, writer, file):
    """Reads until all was played; returns why it ended early, or None."""
    trip = Trip()
    block = max(1, int(BLOCK_S * RATE_HZ))
    while state["read"] < len(voltage):
        if stopped:
            return stopped[0]
        count = min(block, len(voltage) - state["read"])
        rows = read_rows(inputs, count)
        for row in rows:
            time_s = state["read"] / RATE_HZ
            writer.writerow(["%.9g" % v for v in [time_s, voltage[state["read"]]] + row])
            state["read"] += 1
        file.flush()
        why = trip.look(rows)
        if why:
            return why
        print("\r%.1f of %.1f s" % (state["read"] / RATE_HZ, len(voltage) / RATE_HZ), end="")
    return None


def still_there(output, state, control):
    """Control voltage that the output may be left at. It went on a little after it was asked: of
    these samples the one nearest to 0 V, so that the way to 0 V never begins with a jump up."""
    try:
        count = int(output.out_stream.total_samp_per_chan_generated)
    except Exception:  # a driver that cannot say: what was read was played
        count = state["read"]
    if count <= 0:
        return 0.0
    return min(control[count - 1 : count + int(LATE_S * RATE_HZ) + 1] or [0.0], key=abs)


def play(device):
    voltage, control = read_waveform()
    recording = os.path.join(FOLDER, "recording.csv")
    if os.path.exists(recording):
        sys.exit("recording.csv already exists; rename it first")
    for name in ("SIGINT", "SIGTERM", "SIGBREAK", "SIGHUP", "SIGQUIT"):  # as the system has them
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), on_signal)
    state = {"read": 0}
    last = 0.0  # control voltage that the output may still have
    why = "an error"
    try:
        with open(recording, "w", newline="") as file, nidaqmx.Task() as output, nidaqmx.Task() as inputs:
            writer = csv.writer(file)
            writer.writerow(["time (s)", "command (kV)"] + [c["title"] for c in CHANNELS])
            prepare(device, output, inputs, control)
            try:
                output.start()  # waits for the clock of the inputs
                inputs.start()
                why = record(inputs, voltage, state, writer, file)
            finally:
                last = still_there(output, state, control)
                output.stop()
                inputs.stop()
    finally:
        ramp_to_zero(device, last)
        print()
    if why:
        sys.exit(
            "ended after %g s: %s; the output was set to 0 V, not read back"
            % (state["read"] / RATE_HZ, why)
        )
    print("recording.csv is complete. Next:  dea import recording.csv")


if __name__ == "__main__":
    play(sys.argv[1] if len(sys.argv) > 1 else "Dev1")
