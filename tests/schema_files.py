"""All files that ship against the JSON Schemas of data/schema, and the bad files of
tests/design/test_design_errors.c: test_schema_files.sh calls it with the folders of both."""

import json
import pathlib
import re
import sys

import jsonschema
import yaml

# What no schema can say: values beside each other, upper limits of numbers with a unit, geometry,
# names of materials and laws.
BEYOND = [
    "more than 10000 voltages",
    "must be above the pre-stretch 1.5",
    "must be at most 10 mm",
    "do not fit into",
    "does not fit on",
    "18 mm in radius",
    "overlap each other",
    "meet at the centre",
    "reach beyond the centre",
    "are not inside the frame",
    "leaves nothing of fibres",
    "is larger than the electrode",
    "at most 1.768 mm wide",
    "there is no material",
    "no law set",
    "no breakdown field",
    "did you mean 'flat'?",
    "no linear elastic constants",
    "none is given",
    "is taken by the material",
    "is not a law",
    "lacks 'mu'",
    "did you mean 'mu'?",
    "has no hyperelastic law",
    "before the pre-stretch 1.5 of",
    "a material in one line",
    "the law 'yeoh' has",
    "c3: '3' has no unit",
    "value: '9 kPa'",
    "'film.material' has no",
]
# What YAML allows and design files do not.
YAML_ONLY = ["aliases", "a second document", "zero byte", "nested too deeply", "tags"]


class Loader(yaml.SafeLoader):
    """YAML 1.2, as editors read it: yes and no are text, no dates; a key stands once."""

    def construct_mapping(self, node, deep=False):
        keys = [self.construct_object(key, deep=True) for key, _ in node.value]
        if any(isinstance(key, (list, dict)) for key in keys) or len(set(keys)) < len(keys):
            raise yaml.YAMLError("a key that is a list, or one that stands twice")
        return super().construct_mapping(node, deep)


Loader.yaml_implicit_resolvers = {}
for tag, pattern, first in [
    ("bool", r"true|True|TRUE|false|False|FALSE", "tTfF"),
    ("null", r"~|null|Null|NULL|", ["~", "n", "N", ""]),
    ("int", r"[-+]?[0-9]+", "-+0123456789"),
    ("float", r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.inf|\.nan", "-+.0123456789"),
]:
    Loader.add_implicit_resolver("tag:yaml.org,2002:" + tag, re.compile("^(?:" + pattern + ")$"), list(first))


def schema(root, name):
    text = json.loads((root / "data/schema" / (name + ".json")).read_text())
    jsonschema.Draft202012Validator.check_schema(text)
    return jsonschema.Draft202012Validator(text)


def kind_of(path, data):
    if path.parent.name == "materials":
        return "material"
    if "dea-protocol" in data:
        return "protocol"
    if "dea_explore" in data:
        return "explore"
    if "dea_fit" in data:
        return ("fit-device" if "design" in data else "fit-breakdown" if "breakdown" in data
                else "fit-life" if "life" in data else "fit")
    return "design"


def check_shipped(root):
    """All files are valid; each says which schema is its."""
    bad = count = 0
    schemas = {}
    files = sorted(root.glob("examples/**/*.yaml")) + sorted(root.glob("data/materials/*.yaml"))
    for path in files:
        data = yaml.load(path.read_text(), Loader)
        kind = kind_of(path, data)
        if kind not in schemas:
            schemas[kind] = schema(root, kind)
        for error in schemas[kind].iter_errors(data):
            print(f"{path}: {'/'.join(map(str, error.absolute_path))}: {error.message[:200]}")
            bad += 1
        line = re.search(r"^# yaml-language-server: \$schema=(\S+)$", path.read_text(), re.M)
        named = (path.parent / line.group(1)).resolve() if line else None
        if named != (root / "data/schema" / (kind + ".json")).resolve():
            print(f"{path}: names the schema {named}, not that of a {kind}")
            bad += 1
        count += 1
    print(f"{count} files that ship, {bad} faults")
    return bad == 0 and count > 50


def refused(validator, path):
    try:
        data = yaml.load(path.read_bytes(), Loader)
    except (yaml.YAMLError, UnicodeDecodeError):
        return True
    return not validator.is_valid(data)


def check_refused(root, cases):
    """All bad files are refused but those that no schema can refuse."""
    validator = schema(root, "design")
    wrong = done = beyond = 0
    for path in sorted(cases.glob("*.yaml")):
        part = path.with_suffix(".error").read_text()
        expected = not any(word in part for word in BEYOND)
        free = any(word in part for word in YAML_ONLY)  # these depend on who reads the YAML
        done += expected
        beyond += not expected
        if not free and refused(validator, path) != expected:
            print(f"{path.name}: {part}: {'accepted' if expected else 'refused'}")
            wrong += 1
    print(f"{done} bad files refused, {beyond} beyond a schema, {wrong} wrong")
    return wrong == 0 and done >= 43


def check_lists(root):
    """Members of lists of numbers are numbers, without what stands around them in the example."""
    data = yaml.load((root / "examples/explore/spread.yaml").read_text(), Loader)
    validator = schema(root, "explore")
    wrong = 0
    for member, good in ((0.8, True), ("0.8", False), ("0.8 [0.8]", False), (1.5, False)):
        if validator.is_valid({**data, "correlations": [member]}) != good:
            print(f"correlations: [{member!r}] is {'refused' if good else 'accepted'}")
            wrong += 1
    return wrong == 0


ROOT = pathlib.Path(sys.argv[1])
GOOD = check_shipped(ROOT)
LISTS = check_lists(ROOT)
sys.exit(0 if check_refused(ROOT, pathlib.Path(sys.argv[2])) and GOOD and LISTS else 1)
