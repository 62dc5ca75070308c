"""Worlds of d3dgen, read from the documents it writes."""
import json
import math
import pathlib
import resource
import subprocess
import tempfile

from houses import House, Object, Opening, Room

NAME = "d3dgen"
FRONT_RAD = math.pi / 2
"""Our yaw says where the front looks, and the width lies across it; the neutral form turns a box whose width lies along x."""


def make(program, asked, seeds):
    """Yields a home of each seed, with the CPU seconds of the whole process: start, checks and all files."""
    for seed in seeds:
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "home"
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([program, "generate", f"house with {asked} rooms", "--seed", str(seed), "--out", out], check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            yield read(out, asked, seed, cpu_s)


def read(folder, asked, seed, cpu_s):
    plan = json.loads((folder / "floorplan.json").read_text())
    placed = json.loads((folder / "placements.json").read_text())["placements"]
    return House(
        generator=NAME, asked=asked, seed=seed, cpu_s=cpu_s,
        rooms=[Room(room["room_id"], room["room_type"], corners(room["net_polygon"]), room["circulation"]) for room in plan["rooms"]],
        openings=[
            Opening(door["room_ids"], corners([door["line"]["start"], door["line"]["end"]]), door["wall_thickness_m"], door["kind"] != "open")
            for door in plan["doors"]
        ],
        objects=[
            Object(
                thing["placement_id"], thing["object"], [thing["pose"]["x"], thing["pose"]["y"]], thing["size_m"],
                thing["pose"]["yaw_rad"] + FRONT_RAD, thing["pose"]["z"], thing["support"],
            )
            for thing in placed
        ],
    )


def corners(points):
    return [(point["x"], point["y"]) for point in points]
