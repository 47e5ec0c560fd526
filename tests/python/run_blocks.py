"""Runs the blocks of code of a page as one script: run_blocks.py PAGE.md [folder of files to copy]."""

import os
import pathlib
import re
import shutil
import sys
import tempfile

page = pathlib.Path(sys.argv[1]).resolve()
files = [pathlib.Path(name).resolve() for name in sys.argv[2:]]
blocks = re.findall(r"^```python\n(.*?)^```$", page.read_text(), re.S | re.M)
if len(blocks) < 3:
    raise SystemExit(f"{page}: hardly a block found: the test is broken")
folder = tempfile.mkdtemp()
for file in files:
    shutil.copy(file, folder)
os.chdir(folder)
try:
    names = {}
    for number, block in enumerate(blocks, 1):
        print(f"--- block {number}")
        exec(compile(block, f"{page.name}, block {number}", "exec"), names)
finally:
    os.chdir("/")
    shutil.rmtree(folder)
