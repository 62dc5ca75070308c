#!/usr/bin/env python3
"""Lets the moving parts of models stand for two seconds under gravity, in MuJoCo, and sees whether they hold.

Usage: check_joints.py FOLDER...        needs `pip install mujoco`

Reads every model.sdf with joints below the folders as `d3dgen assets export --format sdf` writes them: the root fixed to the
world, friction, damping and spring of each joint as the file says. From rest at both ends and in the middle of their ranges no joint may
move by more than 3 % of its range. Parts that no joint holds together may not overlap by more than 2 mm, at rest or anywhere
in the range of a joint. Prints each fault and one line of figures; exit status 0 when there is no fault.
"""

import math
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import mujoco
import numpy as np

SECONDS = 2.0
MOST_MOVED = 0.03  # of the range
OVERLAP = 0.002  # m
STEPS = 11  # positions of a range at which overlap is looked for


def numbers(element, path, default):
    found = element.find(path)
    return [float(v) for v in found.text.split()] if found is not None and found.text else list(default)


def pose(element):
    x, y, z, roll, pitch, yaw = numbers(element, "pose", [0.0] * 6)
    half = [roll / 2, pitch / 2, yaw / 2]
    (sr, cr), (sp, cp), (sy, cy) = [(math.sin(a), math.cos(a)) for a in half]
    w, i, j, k = cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy
    return {"pos": f"{x} {y} {z}", "quat": f"{w} {i} {j} {k}"}


def geoms(link):
    for collision in link.iter("collision"):
        shape = list(collision.find("geometry"))[0]
        at = pose(collision)
        if shape.tag == "box":
            yield dict(at, type="box", size=" ".join(str(v / 2) for v in numbers(shape, "size", [1] * 3)))
        elif shape.tag == "cylinder":
            yield dict(at, type="cylinder", size=f"{numbers(shape, 'radius', [0])[0]} {numbers(shape, 'length', [0])[0] / 2}")
        elif shape.tag == "sphere":
            yield dict(at, type="sphere", size=str(numbers(shape, "radius", [0])[0]))


def world(file):
    """Returns the MJCF of a model, or none when nothing of it moves."""
    model = ET.parse(file).getroot().find("model")
    links = {link.get("name"): link for link in model.findall("link")}
    joints = {j.find("child").text: j for j in model.findall("joint") if j.get("type") in ("revolute", "prismatic", "continuous")}
    if not joints:
        return None
    root = ET.Element("mujoco")
    ET.SubElement(root, "compiler", angle="radian", autolimits="true", balanceinertia="true")
    ET.SubElement(root, "option", timestep="0.002", integrator="implicitfast")
    contact = ET.SubElement(root, "contact")
    bodies = {}

    def body(name):
        if name in bodies:
            return bodies[name]
        joint = joints.get(name)
        above = body(joint.find("parent").text) if joint is not None else top
        bodies[name] = own = ET.SubElement(above, "body", name=name)
        inertial = links[name].find("inertial")
        tensor = [numbers(inertial, f"inertia/{k}", [0.0])[0] for k in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")]
        center = numbers(inertial, "pose", [0.0] * 6)[:3]
        ET.SubElement(own, "inertial", pos=" ".join(map(str, center)), mass=inertial.find("mass").text, fullinertia=" ".join(map(str, tensor)))
        for geom in geoms(links[name]):
            ET.SubElement(own, "geom", geom)
        if joint is not None:
            axis = joint.find("axis")
            moves = {
                "name": joint.get("name"),
                "type": "slide" if joint.get("type") == "prismatic" else "hinge",
                "pos": " ".join(map(str, numbers(joint, "pose", [0.0] * 6)[:3])),
                "axis": axis.find("xyz").text,
                "damping": axis.find("dynamics/damping").text,
                "frictionloss": axis.find("dynamics/friction").text,
                # dry friction, which does not creep
                "solimpfriction": "0.9999 0.9999 0.001 0.5 2",
            }
            if axis.find("dynamics/spring_stiffness") is not None:
                moves["stiffness"] = axis.find("dynamics/spring_stiffness").text
                moves["springref"] = axis.find("dynamics/spring_reference").text
            if axis.find("limit") is not None:
                moves["range"] = f"{axis.find('limit/lower').text} {axis.find('limit/upper').text}"
            ET.SubElement(own, "joint", moves)
            ET.SubElement(contact, "exclude", body1=joint.find("parent").text, body2=name)
        return own

    top = ET.SubElement(root, "worldbody")
    for name in links:
        body(name)
    return ET.tostring(root, encoding="unicode")


def overlaps(model, data):
    name = lambda geom: model.body(model.geom_bodyid[geom]).name
    return {tuple(sorted(name(g) for g in c.geom)): -c.dist for c in data.contact if c.dist < -OVERLAP}


def check(file):
    """Yields faults; returns how many joints there are."""
    text = world(file)
    if text is None:
        return 0
    model = mujoco.MjModel.from_xml_string(text)
    low, high = model.jnt_range[:, 0].copy(), model.jnt_range[:, 1].copy()
    free = ~model.jnt_limited.astype(bool)
    low[free], high[free] = 0.0, 2 * math.pi
    rest = np.clip(0.0, low, high)
    data = mujoco.MjData(model)
    seen = {}
    for j in range(model.njnt):
        for share in np.linspace(0, 1, STEPS):
            data.qpos[:] = rest
            data.qpos[j] = low[j] + share * (high[j] - low[j])
            mujoco.mj_forward(model, data)
            for pair, depth in overlaps(model, data).items():
                seen.setdefault(pair, (depth, model.joint(j).name, float(data.qpos[j])))
    for pair, (depth, joint, at) in sorted(seen.items()):
        yield f"{pair[0]} and {pair[1]} overlap by {depth:.4f} m where {joint} is at {at:.2f}"
    # Whether a joint holds is asked of the joint alone.
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    for share in (0.0, 0.5, 1.0):
        mujoco.mj_resetData(model, data)
        start = rest if share == 0.0 else low + share * (high - low)
        data.qpos[:] = start
        for _ in range(int(SECONDS / model.opt.timestep)):
            mujoco.mj_step(model, data)
        for j in np.flatnonzero(np.abs(data.qpos - start) > MOST_MOVED * (high - low)):
            yield f"{model.joint(j).name} moves from {start[j]:.3f} to {data.qpos[j]:.3f} of {low[j]:.3f} to {high[j]:.3f} in {SECONDS} s"
    return model.njnt


def main():
    models = joints = faulty = 0
    for folder in sys.argv[1:]:
        for file in sorted(f for f in Path(folder).rglob("*.sdf") if f.is_file()):
            faults = check(file)
            count = 0
            while True:
                try:
                    fault = next(faults)
                except StopIteration as end:
                    joints += end.value or 0
                    models += bool(end.value)
                    break
                count += 1
                print(f"{file}: {fault}")
            faulty += count > 0
    print(f"{models} models with {joints} joints, {faulty} with faults")
    sys.exit(1 if faulty or not models else 0)


if __name__ == "__main__":
    main()
