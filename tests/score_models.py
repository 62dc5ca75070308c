#!/usr/bin/env python3
"""Compares what `d3dgen assets inspect` says about models with what independent tools found in them.

    tests/score_models.py [FOLDER] [--program target/release/d3dgen] [--list]

FOLDER has MANIFEST.jsonl: a line for each model with `file`, `format` and `ground_truth`. Lengths agree within 2 mm or
0.5 %. Exit status 1 when less than 97 % of the models agree in box, axis, unit and triangles, or less than 95 % in
materials and in textures. What the ground truth does not say (the axis of an OBJ) is not compared.
"""
import argparse
import collections
import json
import pathlib
import subprocess
import sys
import time

MM, SHARE = 0.002, 0.005
GEOMETRY, SURFACE = 0.97, 0.95


def near(ours, theirs, size):
    return ours is not None and abs(ours - theirs) <= max(MM, SHARE * size)


def same_box(ours, theirs):
    if theirs is None:
        return ours is None
    if ours is None:
        return False
    size = [abs(theirs[1][i] - theirs[0][i]) for i in range(3)]
    return all(near(ours[end][i], theirs[end][i], max(size)) for end in (0, 1) for i in range(3))


def same_geometry(ours, truth):
    """Returns what differs."""
    wrong = []
    # The box turned to z up says the same as that in the file's axes, where the format has an axis at all.
    key = "bbox_zup" if truth.get("bbox_zup") is not None else "bbox_stage"
    if not same_box(ours.get(key), truth.get(key)):
        wrong.append(f"{key} {ours.get(key)} not {truth.get(key)}")
    if ours.get("up_axis") != truth.get("up_axis"):
        wrong.append(f"up_axis {ours.get('up_axis')} not {truth.get('up_axis')}")
    unit, meters = ours.get("meters_per_unit"), truth.get("meters_per_unit")
    if (unit is None) != (meters is None) or (meters and abs(unit / meters - 1) > 1e-6):
        wrong.append(f"meters_per_unit {unit} not {meters}")
    count = truth["triangle_count"]
    if ours.get("triangle_count") is None or abs(ours["triangle_count"] - count) > SHARE * count:
        wrong.append(f"triangle_count {ours.get('triangle_count')} not {count}")
    if ours.get("mesh_count") != truth["mesh_count"]:
        wrong.append(f"mesh_count {ours.get('mesh_count')} not {truth['mesh_count']}")
    return wrong


def same_materials(ours, truth):
    wrong = []
    if ours.get("material_names") != truth["material_names"]:
        wrong.append(f"material_names {ours.get('material_names')} not {truth['material_names']}")
    colors, theirs = ours.get("diffuse_colors") or [], truth["diffuse_colors"]
    if len(colors) != len(theirs) or any(abs(a - b) > 1e-4 for x, y in zip(colors, theirs) for a, b in zip(x, y)):
        wrong.append(f"diffuse_colors {colors[:3]} not {theirs[:3]}")
    return wrong


def same_textures(ours, truth):
    mine, theirs = ours.get("textures") or [], truth["textures"]
    return [] if mine == theirs else [f"textures {mine[:3]} not {theirs[:3]}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    here = pathlib.Path(__file__).resolve().parent.parent
    parser.add_argument("folder", nargs="?", type=pathlib.Path, default=here / "../shared/assets/open")
    parser.add_argument("--program", type=pathlib.Path, default=here / "target/release/d3dgen")
    parser.add_argument("--list", action="store_true", help="print every difference")
    args = parser.parse_args()
    manifest = args.folder / "MANIFEST.jsonl"
    if not manifest.is_file():
        print(f"skipped: models with known figures, {args.folder} is not here")
        return 0
    entries = [json.loads(line) for line in manifest.read_text(encoding="utf-8").splitlines() if line.strip()]
    command = [str(args.program.resolve()), "assets", "inspect", "--json", *(e["file"] for e in entries)]
    begun = time.monotonic()
    run = subprocess.run(command, cwd=args.folder, capture_output=True, text=True, timeout=600, check=False)
    seconds = time.monotonic() - begun
    lines = {line["file"]: line for line in map(json.loads, run.stdout.splitlines())}
    tests = {"geometry": same_geometry, "materials": same_materials, "textures": same_textures}
    good, total, opened = collections.Counter(), collections.Counter(), 0
    for entry in entries:
        truth = entry["ground_truth"]
        if not truth.get("opens"):
            continue
        opened += 1
        ours = lines.get(entry["file"], {})
        for name, test in tests.items():
            wrong = test(ours, truth)
            total[name, entry["format"]] += 1
            good[name, entry["format"]] += not wrong
            if wrong and args.list:
                print(f"{entry['file']}: {'; '.join(wrong)} {ours.get('error') or ''}")
    print(f"{'':18}{'geometry':>12}{'materials':>12}{'textures':>12}")
    for kind in sorted({k for _, k in total}):
        print(f"{kind:18}" + "".join(f"{good[t, kind]:>7}/{total[t, kind]:<4}" for t in tests))
    shares = {t: sum(v for (n, _), v in good.items() if n == t) / max(1, opened) for t in tests}
    print("in all            " + "".join(f"{shares[t]:>11.1%} " for t in tests))
    refused = sum(1 for line in lines.values() if not line["ok"])
    print(f"{len(entries)} files, {refused} refused, {len(entries) / seconds:.1f} models/s")
    sound = len(lines) == len(entries) and shares["geometry"] >= GEOMETRY
    sound = sound and min(shares["materials"], shares["textures"]) >= SURFACE
    print(f"models agree: {shares['geometry']:.1%} geometry, {shares['materials']:.1%} materials, {shares['textures']:.1%} textures")
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
