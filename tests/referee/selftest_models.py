#!/usr/bin/env python3
"""Breaks a model in each way that check_models.py names, and expects it to see that: selftest_models.py FOLDER

FOLDER holds exported models; the first one with a joint that has limits is copied and broken.
"""

import re
import shutil
import struct
import sys
import tempfile
import zipfile
from pathlib import Path

import check_models


def repack(file, change):
    """Changes the text of the layer of a package, keeping it aligned."""
    with zipfile.ZipFile(file) as package:
        name = package.namelist()[0]
        text = package.read(name).decode()
    changed = change(text)
    assert changed != text, "the break changes nothing"
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as package:
        entry = zipfile.ZipInfo(name)
        padding = -(30 + len(name) + 4) % 64
        entry.extra = struct.pack("<HH", 0x1986, padding) + bytes(padding)
        package.writestr(entry, changed)


def usd(pattern, replacement):
    return lambda folder, name: repack(folder / f"{name}.usdz", lambda t: re.sub(pattern, replacement, t, count=1))


def text(path, pattern, replacement):
    def change(folder, name):
        file = folder / path.format(name=name)
        before = file.read_text()
        after = re.sub(pattern, replacement, before, count=1)
        assert after != before, "the break changes nothing"
        file.write_text(after)

    return change


def glb(folder, name):
    file = folder / f"{name}.glb"
    data = file.read_bytes()
    changed = re.sub(rb'"mass_kg":[0-9.]+,"joint"', lambda m: m.group().replace(b"joint", b"joinx"), data, count=1)
    assert changed != data, "the break changes nothing"
    file.write_bytes(changed)


def compressed(folder, name):
    file = folder / f"{name}.usdz"
    with zipfile.ZipFile(file) as package:
        layer = package.namelist()[0]
        content = package.read(layer)
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as package:
        package.writestr(layer, content)


BREAKS = {
    "another unit": (usd("metersPerUnit = 1", "metersPerUnit = 0.01"), "not in meters"),
    "another up axis": (usd('upAxis = "Z"', 'upAxis = "Y"'), "not in meters"),
    "no default prim": (usd('defaultPrim = "\\w+"', 'defaultPrim = "Nothing"'), "default prim"),
    "another box": (text("annotation.yaml", r"bounding_box:\n- - -0\.\d+", "bounding_box:\n- - -9.5"), "annotated"),
    "no mass": (usd(r"float physics:mass = [0-9.]+", "float physics:mass = 0"), "has mass"),
    "a joint to nowhere": (usd(r"(PhysicsRevoluteJoint[^}]*?body1 = <)[^>]+>", r"\1/Nowhere>"), "does not join"),
    "a joint that cannot move": (usd(r"upperLimit = [0-9.]+", "upperLimit = -500"), "cannot move"),
    "another hinge in SDF": (text("{name}.sdf/{name}.sdf", r"(<pose>)\S+( [^<]*</pose>\s*<axis>)", r"\g<1>7\2"), "and ("),
    "a mesh that is not there": (text("{name}.sdf/{name}.sdf", "<uri>[^<]+", "<uri>nothing.obj"), "not there"),
    "two links of one name": (text("{name}.sdf/{name}.sdf", '<link name="(?!base)\\w+"', '<link name="base"'), "one name"),
    "an impossible inertia": (text("{name}.sdf/{name}.sdf", "<ixx>[^<]+", "<ixx>99"), "no body has"),
    "a joint lost in GLB": (glb, "joints ["),
    "a compressed package": (compressed, ""),
}


def main():
    source = next(
        (f.parent for f in sorted(Path(sys.argv[1]).rglob("*.glb")) if b'"limits_rad"' in f.read_bytes()), None
    )
    if source is None:
        sys.exit("no model with a joint that turns between limits")
    missed = []
    for what, (change, expected) in BREAKS.items():
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder) / "Domain" / "Object" / source.name
            shutil.copytree(source, copy)
            if sound := check_models.check_model(copy / "annotation.yaml")[2]:
                sys.exit(f"{source} is not sound to begin with: {sound}")
            change(copy, source.name)
            try:
                problems = check_models.check_model(copy / "annotation.yaml")[2]
            except Exception as error:  # Pixar's library refuses some of them itself
                problems = [f"{expected} {error}"]
            if not any(expected in p for p in problems):
                missed.append(f"{what}: {problems}")
    print("\n".join(missed) or f"breaks of a model seen: {len(BREAKS)}")
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
