"""The files that dea fab writes of designs, read back as the shapes of the same designs."""
import json
import os
import re
import subprocess


def shapes_of(dxf):
    """Names of the layers with something on them."""
    lines = [line.strip() for line in open(dxf).read().split("\n")]
    pairs = list(zip(lines[0::2], lines[1::2]))
    start = pairs.index(("2", "ENTITIES"))
    return list(dict.fromkeys(value for code, value in pairs[start:] if code == "8" and value != "0"))


def again(command, design, folder):
    """Writes the files of a design; a design with the shapes of layout.dxf, and its areas."""
    name = os.path.basename(design)[:-5]
    out = os.path.join(folder, name)
    subprocess.run([command, "--quiet", "fab", design, "-o", out], check=True)
    shapes = "".join(
        f'  - {{name: "{s}", kind: drawing, file: "{out}/layout.dxf", layer: "{s}"}}\n'
        for s in shapes_of(f"{out}/layout.dxf")
    )
    text = re.sub(r"(?m)^shapes:\n(?:[ #].*\n)*", lambda m: "shapes:\n" + shapes, open(design).read())
    path = os.path.join(folder, name + "-again.yaml")
    open(path, "w").write(text)
    return path


def areas(command, design):
    run = subprocess.run([command, "check", design, "--json"], check=True, capture_output=True)
    return json.loads(run.stdout)["derived"]["area_m2"]
