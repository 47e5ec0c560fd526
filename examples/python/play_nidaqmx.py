"""Plays a protocol by a DAQ of NI (USB too, Windows too) with nidaqmx, and records two inputs.

    python play_nidaqmx.py PROTOCOL RECORDING.h5

HIGH VOLTAGE. Tried with an imitation of nidaqmx only: begin with the amplifier's high voltage off.
`dea drive PROTOCOL --export DIR` writes a longer script, with the protocol's channels, its limit of
current and a ramp to 0 V after a fault.
"""

import sys

import nidaqmx
from nidaqmx.constants import AcquisitionType

import dea
from checked_waveform import checked_waveform

OUTPUT, VOLTAGE, CURRENT = "Dev1/ao0", "Dev1/ai0", "Dev1/ai1"
KV_PER_V, MA_PER_V = 1.0, 1.0  # of the amplifier's monitors: enter yours


def play(times, control_V):
    count, rate = len(times), 1 / (times[1] - times[0])
    with nidaqmx.Task() as output, nidaqmx.Task() as inputs:
        try:
            output.ao_channels.add_ao_voltage_chan(OUTPUT, min_val=-10, max_val=10)
            for channel in (VOLTAGE, CURRENT):
                inputs.ai_channels.add_ai_voltage_chan(channel, min_val=-10, max_val=10)
            for task, source in ((output, ""), (inputs, "/Dev1/ao/SampleClock")):
                task.timing.cfg_samp_clk_timing(rate, source=source, samps_per_chan=count,
                                                sample_mode=AcquisitionType.FINITE)
            output.write(control_V, auto_start=False)
            inputs.start()
            output.start()
            return inputs.read(number_of_samples_per_channel=count, timeout=times[-1] + 10)
        finally:
            output.stop()
            with nidaqmx.Task() as zero:  # whatever happened
                zero.ao_channels.add_ao_voltage_chan(OUTPUT, min_val=-10, max_val=10)
                zero.write(0.0, auto_start=True)


def main(protocol, recording):
    times, _, control_V = checked_waveform(protocol)
    voltage, current = play(times, control_V)
    dea.write_recording(recording, times, {"voltage (kV)": [KV_PER_V * v for v in voltage],
                                           "current (mA)": [MA_PER_V * v for v in current]})


if __name__ == "__main__":
    main(*sys.argv[1:])
