#!/usr/bin/env python3
"""Opens every 3D model of exported worlds with the readers of their consumers, and compares them with their annotations.

Usage: check_models.py FOLDER...

USD by Pixar's library (validators included): one default prim, meters, z up, bounds as annotated. SDF by an XML reader:
unique names among siblings, finite sizes, positive mass. Every `model` of a world.yaml is there, with the same box.
Exit status 0 when all hold, 1 when one does not.
"""

import math
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import yaml
from pxr import Usd, UsdGeom, UsdValidation

TOLERANCE = 0.002  # m
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def differ(a, b):
    return any(abs(x - y) > TOLERANCE for pair in zip(a, b) for x, y in zip(*pair))


def check_usd(file, box):
    stage = Usd.Stage.Open(str(file))
    if not stage.GetDefaultPrim():
        yield "has no default prim"
    if UsdGeom.GetStageMetersPerUnit(stage) != 1.0 or UsdGeom.GetStageUpAxis(stage) != "Z":
        yield "is not in meters with z up"
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_, UsdGeom.Tokens.render], False)
    bounds = cache.ComputeWorldBound(stage.GetPseudoRoot()).ComputeAlignedRange()
    found = list(zip(bounds.GetMin(), bounds.GetMax()))
    if differ(found, box):
        yield f"spans {[[round(v, 3) for v in side] for side in found]}, annotated {box}"
    registry = UsdValidation.ValidationRegistry()
    validators = registry.GetOrLoadAllValidators()
    for error in UsdValidation.ValidationContext(validators).Validate(stage):
        # Text files are for people to read; the performance advice is to use the binary form.
        if error.GetType() != UsdValidation.ValidationErrorType.Warn and "Performance" not in error.GetName():
            yield f"{error.GetName()}: {error.GetMessage()}"


def check_sdf(file):
    root = ET.parse(file).getroot()
    if root.tag != "sdf" or root.find("model") is None:
        yield "holds no model"
    for node in root.iter():
        names = [child.get("name") for child in node if child.get("name")]
        if len(names) != len(set(names)):
            yield f"has siblings of one name in {node.tag} {node.get('name')}"
        if node.tag in ("size", "pose", "radius", "length", "mass"):
            values = [float(v) for v in (node.text or "").split()]
            if not values or not all(map(math.isfinite, values)) or (node.tag != "pose" and min(values) <= 0):
                yield f"has {node.tag} {node.text}"


def check_folder(folder):
    boxes = {}
    for file in sorted(folder.rglob("annotation.yaml")):
        annotation = yaml.load(file.read_text(), LOADER)
        name, box = annotation["name"], annotation["bounding_box"]
        boxes[f"{file.parents[2].name}/{name}"] = box
        usd = [f for f in file.parent.glob(f"{name}.usd*")]
        sdf = [f for f in file.parent.rglob(f"{name}.sdf") if f.is_file()]
        if not usd or not sdf:
            yield f"{file.parent}: USD or SDF is missing"
        yield from (f"{f}: {problem}" for f in usd for problem in check_usd(f, box))
        yield from (f"{f}: {problem}" for f in sdf for problem in check_sdf(f))
    for file in sorted(folder.rglob("world.yaml")):
        for zone in yaml.load(file.read_text(), LOADER)["zones"]:
            for thing in zone["entities"]["static"]:
                if thing["model"] not in boxes:
                    yield f"{file}: {thing['name']} is the model {thing['model']}, which is not there"
                elif differ(thing["bbox"], boxes[thing["model"]]):
                    yield f"{file}: {thing['name']} has box {thing['bbox']}, its model {boxes[thing['model']]}"
    print(f"{folder}: {len(boxes)} models opened", file=sys.stderr)
    if not boxes:
        yield f"{folder}: no model at all"


def main():
    problems = [p for folder in sys.argv[1:] for p in check_folder(Path(folder))]
    print("\n".join(problems) or "every model holds")
    sys.exit(1 if problems or len(sys.argv) < 2 else 0)


if __name__ == "__main__":
    main()
