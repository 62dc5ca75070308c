#!/usr/bin/env python3
"""Opens every 3D model of exported worlds with the readers of their consumers, and compares them with their annotations.

Usage: check_models.py FOLDER...

USD by Pixar's library (all its validators): one default prim, meters, z up, bounds as annotated, rigid bodies with mass
that are not nested, joints between them with limits, packages aligned. glTF: bounds as annotated. SDF by an XML reader:
unique names among siblings, finite sizes, sound inertias, meshes that are there and have the same bounds. The three formats
have the same joints: names, axes, origins, limits. Every `model` of a world.yaml is there, with the same box.
Exit status 0 when all hold, 1 when one does not.
"""

import json
import math
import multiprocessing
import struct
import sys
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import numpy as np
import yaml
from pxr import Gf, Usd, UsdGeom, UsdPhysics, UsdValidation

TOLERANCE = 0.001  # m
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
KINDS = {"PhysicsRevoluteJoint": "revolute", "PhysicsPrismaticJoint": "prismatic"}


def differ(a, b, tolerance=TOLERANCE):
    return any(abs(x - y) > tolerance for pair in zip(a, b) for x, y in zip(*pair))


def rounded(box):
    return [[round(float(v), 4) for v in side] for side in box]


def check_usd(file, box, joints):
    """Yields problems; fills `joints` with name -> (kind, axis, origin, limits)."""
    stage = Usd.Stage.Open(str(file))
    root = stage.GetDefaultPrim()
    if not root or len(stage.GetPseudoRoot().GetChildren()) != 1:
        yield "has no default prim, or more than one root"
        return
    if UsdGeom.GetStageMetersPerUnit(stage) != 1.0 or UsdGeom.GetStageUpAxis(stage) != "Z":
        yield "is not in meters with z up"
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_, UsdGeom.Tokens.render], False)
    bounds = cache.ComputeWorldBound(stage.GetPseudoRoot()).ComputeAlignedRange()
    found = list(zip(bounds.GetMin(), bounds.GetMax()))
    if differ(found, box):
        yield f"spans {rounded(found)}, annotated {box}"
    bodies = [p for p in stage.Traverse() if p.HasAPI(UsdPhysics.RigidBodyAPI)]
    if not bodies:
        yield "has no rigid body"
    for body in bodies:
        if any(other.GetPath().HasPrefix(body.GetPath()) for other in bodies if other != body):
            yield f"{body.GetName()} holds another rigid body"
        mass = UsdPhysics.MassAPI(body).GetMassAttr().Get() or 0
        moments = UsdPhysics.MassAPI(body).GetDiagonalInertiaAttr().Get() or (0, 0, 0)
        if not mass > 0 or not min(moments) > 0:
            yield f"{body.GetName()} has mass {mass}, moments {moments}"
        if not any(p.HasAPI(UsdPhysics.CollisionAPI) for p in Usd.PrimRange(body)) and body == bodies[0]:
            yield f"{body.GetName()} does not collide"
    for prim in stage.Traverse():
        if prim.GetTypeName() in KINDS:
            joint = UsdPhysics.Joint(prim)
            ends = [stage.GetPrimAtPath(t) for rel in (joint.GetBody0Rel(), joint.GetBody1Rel()) for t in rel.GetTargets()]
            if len(ends) != 2 or any(end not in bodies for end in ends):
                yield f"{prim.GetName()} does not join two rigid bodies"
            axis = Gf.Rotation(Gf.Quatd(joint.GetLocalRot0Attr().Get())).TransformDir(Gf.Vec3d(1, 0, 0))
            low, high = (prim.GetAttribute(f"physics:{end}Limit").Get() for end in ("lower", "upper"))
            kind, limits = KINDS[prim.GetTypeName()], None
            if math.isinf(low) or math.isinf(high):
                kind = "continuous"
            else:
                limits = [low, high] if kind == "prismatic" else [math.radians(low), math.radians(high)]
                if not low < high:
                    yield f"{prim.GetName()} cannot move"
            joints[prim.GetName()] = (kind, list(axis), list(joint.GetLocalPos0Attr().Get()), limits)
    if joints and not root.HasAPI(UsdPhysics.ArticulationRootAPI):
        yield "is articulated without a root"
    registry = UsdValidation.ValidationRegistry()
    for error in UsdValidation.ValidationContext(registry.GetOrLoadAllValidators()).Validate(stage):
        # Text layers are for people to read; the performance advice is to use the binary form.
        if error.GetType() != UsdValidation.ValidationErrorType.Warn and "Performance" not in error.GetName():
            yield f"{error.GetName()}: {error.GetMessage()}"
    if file.suffix == ".usdz":
        yield from check_package(file)


def check_package(file):
    with zipfile.ZipFile(file) as package, open(file, "rb") as raw:
        if package.testzip():
            yield "is a damaged archive"
        for entry in package.infolist():
            raw.seek(entry.header_offset + 26)
            name, extra = struct.unpack("<HH", raw.read(4))
            if entry.compress_type != zipfile.ZIP_STORED or (entry.header_offset + 30 + name + extra) % 64:
                yield f"{entry.filename} is compressed, or does not begin at a multiple of 64 bytes"


def check_glb(file, box, joints):
    data = file.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    root = json.loads(data[20 : 20 + length])
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    back = lambda v: [v[0], -v[2], v[1]]  # y up to z up

    def visit(index, shift):
        node = root["nodes"][index]
        shift = shift + np.array(node.get("translation", [0, 0, 0]))
        for primitive in root["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
            accessor = root["accessors"][primitive["attributes"]["POSITION"]]
            np.minimum(low, shift + accessor["min"], out=low)
            np.maximum(high, shift + accessor["max"], out=high)
        joint = node.get("extras", {}).get("joint")
        if joint:
            limits = joint.get("limits_rad", joint.get("limits_m"))
            joints[joint["name"]] = (joint["kind"], back(joint["axis"]), back(shift), limits)
        for child in node.get("children", []):
            visit(child, shift)

    for index in root["scenes"][root["scene"]]["nodes"]:
        visit(index, np.zeros(3))
    found = [[low[0], high[0]], [-high[2], -low[2]], [low[1], high[1]]]
    if differ(found, box):
        yield f"spans {rounded(found)}, annotated {box}"


def check_sdf(file, box, joints):
    root = ET.parse(file).getroot()
    model = root.find("model")
    if root.tag != "sdf" or model is None:
        yield "holds no model"
        return
    for node in root.iter():
        names = [child.get("name") for child in node if child.get("name")]
        if len(names) != len(set(names)):
            yield f"has siblings of one name in {node.tag} {node.get('name')}"
        if node.tag in ("size", "pose", "radius", "length", "mass"):
            values = [float(v) for v in (node.text or "").split()]
            if not values or not all(map(math.isfinite, values)) or (node.tag != "pose" and min(values) <= 0):
                yield f"has {node.tag} {node.text}"
    for inertia in root.iter("inertia"):
        xx, xy, xz, yy, yz, zz = (float(inertia.findtext(f"i{k}")) for k in ("xx", "xy", "xz", "yy", "yz", "zz"))
        a, b, c = sorted(np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
        if a <= 0 or a + b < c:
            yield f"has moments of inertia that no body has: {a}, {b}, {c}"
    links = {link.get("name") for link in model.findall("link")}
    points = []
    for uri in root.iter("uri"):
        mesh = file.parent / uri.text
        if not mesh.is_file():
            yield f"has a mesh that is not there: {uri.text}"
        else:
            points += [line[2:].split() for line in mesh.read_text().splitlines() if line.startswith("v ")]
    if points:
        points = np.array(points, dtype=float)
        found = list(zip(points.min(axis=0), points.max(axis=0)))
        if differ(found, box):
            yield f"spans {rounded(found)}, annotated {box}"
    for joint in model.findall("joint"):
        ends = [joint.findtext("parent"), joint.findtext("child")]
        if not set(ends) <= links | {"world"}:
            yield f"{joint.get('name')} joins {ends}"
        if joint.get("type") != "fixed":
            numbers = lambda path: [float(v) for v in joint.findtext(path).split()]
            limits = [float(joint.findtext(f"axis/limit/{end}")) for end in ("lower", "upper")] if joint.find("axis/limit") is not None else None
            joints[joint.get("name")] = (joint.get("type"), numbers("axis/xyz"), numbers("pose")[:3], limits)


def compare_joints(name, a, b):
    if a.keys() != b.keys():
        yield f"{name}: joints {sorted(a)} and {sorted(b)}"
    for key in a.keys() & b.keys():
        (kind, axis, origin, limits), (kind_b, axis_b, origin_b, limits_b) = a[key], b[key]
        same = kind == kind_b and np.allclose(axis, axis_b, atol=1e-3) and np.allclose(origin, origin_b, atol=1e-3)
        if not same or (limits is None) != (limits_b is None) or (limits and not np.allclose(limits, limits_b, atol=1e-3)):
            yield f"{name}: {key} is {a[key]} and {b[key]}"


def check_model(file):
    """Returns reference, box, problems and number of joints of the model beside an annotation."""
    annotation = yaml.load(file.read_text(), LOADER)
    name, box = annotation["name"], annotation["bounding_box"]
    problems, joints = [], []
    for check, pattern in ((check_usd, f"{name}.usd*"), (check_sdf, f"{name}.sdf/{name}.sdf"), (check_glb, f"{name}.glb")):
        files = sorted(file.parent.glob(pattern))
        if not files:
            problems.append(f"{file.parent}: {pattern} is missing")
        for path in files:
            found = {}
            problems += [f"{path}: {problem}" for problem in check(path, box, found)]
            joints.append((path.name, found))
    for path, found in joints[1:]:
        problems += [f"{file.parent}: {p}" for p in compare_joints(f"{joints[0][0]} and {path}", joints[0][1], found)]
    return f"{file.parents[2].name}/{name}", box, problems, len(joints[0][1]) if joints else 0


def check_folder(folder, pool):
    boxes, joints, moving = {}, 0, 0
    for reference, box, problems, count in pool.map(check_model, sorted(folder.rglob("annotation.yaml")), chunksize=8):
        boxes[reference] = box
        joints, moving = joints + count, moving + (count > 0)
        yield from problems
    for file in sorted(folder.rglob("world.yaml")):
        for zone in yaml.load(file.read_text(), LOADER)["zones"]:
            for thing in zone["entities"]["static"]:
                if thing["model"] not in boxes:
                    yield f"{file}: {thing['name']} is the model {thing['model']}, which is not there"
                elif differ(thing["bbox"], boxes[thing["model"]]):
                    yield f"{file}: {thing['name']} has box {thing['bbox']}, its model {boxes[thing['model']]}"
    print(f"{folder}: {len(boxes)} models opened, {moving} of them with {joints} joints", file=sys.stderr)
    if not boxes:
        yield f"{folder}: no model at all"


def main():
    with multiprocessing.Pool() as pool:
        problems = [p for folder in sys.argv[1:] for p in check_folder(Path(folder), pool)]
    print("\n".join(problems) or "every model holds")
    sys.exit(1 if problems or len(sys.argv) < 2 else 0)


if __name__ == "__main__":
    main()
