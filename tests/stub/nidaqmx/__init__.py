"""Stands in for nidaqmx in tests: what was written goes to the file STUB_LOG, inputs follow the
output. STUB_FAIL, STUB_SIGNAL, STUB_TRIP: number of the sample at which something happens;
STUB_RATE: that it has instead of the one that is asked."""
import os
import signal

played = []  # the output's samples of the finite task


def number(name):
    return int(os.environ.get(name, "1000000000"))


def log(text):
    with open(os.environ["STUB_LOG"], "a") as file:
        file.write(text + "\n")


class Timing:
    def cfg_samp_clk_timing(self, rate, source="", sample_mode=None, samps_per_chan=0):
        log("clock %g %s %d" % (rate, source or "own", samps_per_chan))
        self.samp_clk_rate = float(os.environ.get("STUB_RATE", rate))


class Channels:
    def __init__(self):
        self.count = 0

    def add_ao_voltage_chan(self, name, min_val=0, max_val=0):
        log("output %s %g %g" % (name, min_val, max_val))

    def add_ai_voltage_chan(self, name, min_val=0, max_val=0):
        log("input %s %g %g" % (name, min_val, max_val))
        self.count += 1


class OutStream:
    generated = 0

    @property
    def total_samp_per_chan_generated(self):
        return OutStream.generated


class Task:
    def __init__(self):
        self.ao_channels = Channels()
        self.ai_channels = Channels()
        self.timing = Timing()
        self.out_stream = OutStream()
        self.at = 0

    def __enter__(self):
        return self

    def __exit__(self, *args):
        log("close")

    def write(self, data, auto_start=True):
        if isinstance(data, list):
            played.extend(data)
            log("queued %d %.9g %.9g" % (len(data), sum(data), data[-1]))
        else:
            log("write %.9g" % data)

    def start(self):
        log("start")

    def stop(self):
        log("stop")

    def read(self, number_of_samples_per_channel=1, timeout=0):
        first, last = self.at, self.at + number_of_samples_per_channel
        if last > number("STUB_FAIL"):
            raise RuntimeError("the device was taken away")
        if first <= number("STUB_SIGNAL") < last:
            os.kill(os.getpid(), getattr(signal, os.environ.get("STUB_NAME", "SIGINT")))
        self.at = OutStream.generated = last
        before = [played[i - 1] if i > 0 else 0.0 for i in range(first, last)]
        current = [2.0 if i >= number("STUB_TRIP") else 0.01 for i in range(first, last)]
        columns = [before, current, [0.05 * volts * volts for volts in before]]
        return columns[: self.ai_channels.count]
