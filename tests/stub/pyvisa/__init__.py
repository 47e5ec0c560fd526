"""Stands in for pyvisa in tests: a supply that answers SCPI; commands go to the file STUB_LOG."""
import os


class Resource:
    volts = 0.0

    def __enter__(self):
        return self

    def __exit__(self, *args):
        pass

    def write(self, text):
        with open(os.environ["STUB_LOG"], "a") as file:
            file.write(text + "\n")
        if text.startswith("SOUR:VOLT "):
            self.volts = float(text.split()[1])

    def query(self, text):
        return {"MEAS:VOLT?": f"{self.volts:.3f}\n", "MEAS:CURR?": "1e-6\n"}[text]


class ResourceManager:
    def open_resource(self, address):
        return Resource()
