"""Houses of ProcTHOR's generator without Unity, printed by the Python of its own environment: one house a line, in the form of houses.py.

    venv/bin/python procthor.py CHECKOUT {plans,houses} ROOMS SEEDS

Unity is asked for two things. Whether the meshes of a group of objects (a table with its chairs) go through each other: here every group is
taken as free. And small objects, which are left out. All else is the generator's own code. CPU seconds are those of making a house,
without the start of Python and the reading of its database of objects.
"""
import contextlib
import json
import logging
import math
import pathlib
import random
import subprocess
import sys
import time
import types

NAME = "ProcTHOR"
ROOM_SPECS = {5: "5-room", 8: "8-room-3-bed", 10: "12-room"}
"""Its own lists of rooms, by how many rooms they have; the one called 12-room has 10."""
OUTDOOR = 1


def make(checkout, stage, asked, count):
    """Yields the houses of a run in the peer's own environment."""
    python = pathlib.Path(checkout) / "venv" / "bin" / "python"
    command = [python, __file__, checkout, stage, str(asked), str(count)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        yield from (json.loads(line) for line in process.stdout)
    if process.returncode:
        raise SystemExit(f"{' '.join(map(str, command))} ended with {process.returncode}")


def main(checkout, stage, asked, seeds):
    import_without_unity(checkout)
    from procthor.generation import PROCTHOR10K_ROOM_SPEC_SAMPLER, asset_groups

    asset_groups.AssetGroupGenerator.get_intersecting_objects = lambda self, object_placement: (False, set())
    spec = PROCTHOR10K_ROOM_SPEC_SAMPLER[ROOM_SPECS[asked]]
    assert len(spec.room_type_map) == asked
    for seed in range(1, seeds + 1):
        began = time.process_time()
        partial = generate(spec, seed, stage)
        print(json.dumps(neutral(partial, stage, asked, seed, time.process_time() - began)), flush=True)


def import_without_unity(checkout):
    """Puts stand-ins for what only its controller and videos need before the import."""
    for name, content in {"ai2thor": {}, "ai2thor.controller": {"Controller": type("Controller", (), {})}, "moviepy": {}, "moviepy.editor": {"ImageSequenceClip": None}}.items():
        sys.modules[name] = types.ModuleType(name)
        vars(sys.modules[name]).update(content)
    sys.path.insert(0, checkout)
    logging.disable(logging.WARNING)


def generate(spec, seed, stage):
    """Takes the steps of HouseGenerator.sample up to doors, or up to what hangs on walls."""
    import numpy
    import procthor.generation as p
    from procthor.utils.types import InvalidFloorplan, SamplingVars

    random.seed(seed)
    numpy.random.seed(seed)
    sampling = SamplingVars.sample()
    for _ in range(10):
        with contextlib.suppress(InvalidFloorplan):
            structure = p.default_sample_house_structure(None, set(spec.room_type_map), spec, sampling.interior_boundary_scale)
            break
    house = p.PartialHouse.from_structure_and_room_spec(house_structure=structure, room_spec=spec)
    shared = {"partial_house": house, "controller": None, "pt_db": p.DEFAULT_PROCTHOR_DATABASE, "split": "train"}
    door_polygons = p.default_add_doors(**shared)
    if stage == "houses":
        floors = p.get_floor_polygons(xz_poly_map=structure.xz_poly_map)
        p.default_add_rooms(**shared, floor_polygons=floors, room_type_map=spec.room_type_map, door_polygons=door_polygons)
        p.default_add_floor_objects(**shared, max_floor_objects=sampling.max_floor_objects)
        p.default_add_wall_objects(
            **shared, rooms=house.rooms, boundary_groups=structure.boundary_groups, room_type_map=spec.room_type_map, ceiling_height=structure.ceiling_height
        )
    return house


def neutral(house, stage, asked, seed, cpu_s):
    return {
        "generator": NAME, "asked": asked, "seed": seed, "cpu_s": cpu_s,
        "rooms": [
            {"room_id": room["id"], "kind": room["roomType"], "polygon": [(corner["x"], corner["z"]) for corner in room["floorPolygon"]]}
            for room in house.room_types
        ],
        "openings": [doorway(door, house.walls) for door in house.doors] + open_sides(house),
        "objects": [thing for placed in house.objects for thing in boxes(placed)] if stage == "houses" else None,
    }


def doorway(door, walls):
    """Returns a door; along its wall it begins where the wall of its first room begins."""
    wall = next(wall for wall in walls if wall["id"] == door["wall0"])
    (ax, ay), (bx, by) = ends(wall)
    length = math.dist((ax, ay), (bx, by))
    low, high = sorted(corner["x"] for corner in door["holePolygon"])
    along = [(ax + (bx - ax) * at / length, ay + (by - ay) * at / length) for at in (max(low, 0.0), min(high, length))]
    return {"room_ids": sorted({door["room0"], door["room1"]}), "segment": along}


def ends(wall):
    return [(corner["x"], corner["z"]) for corner in wall["polygon"][:2]]


def open_sides(house):
    """Returns the walls left out between two rooms."""
    sides = {}
    for wall in house.walls:
        if wall.get("empty"):
            sides.setdefault(tuple(sorted(ends(wall))), []).append(wall["roomId"])
    return [{"room_ids": sorted(rooms), "segment": list(side), "door": False} for side, rooms in sides.items() if len(rooms) == 2]


def boxes(placed, support=None):
    """Yields an object and what stands on it; yaw there turns clockwise seen from above, in degrees."""
    from procthor.generation import DEFAULT_PROCTHOR_DATABASE

    asset = DEFAULT_PROCTHOR_DATABASE.ASSET_ID_DATABASE[placed["assetId"]]
    size, at = asset["boundingBox"], placed["position"]
    yield {
        "object_id": placed["id"], "kind": asset["objectType"], "center": [at["x"], at["z"]], "size": [size["x"], size["z"], size["y"]],
        "yaw": -math.radians(placed["rotation"]["y"]), "z": at["y"] - size["y"] / 2, "support": support,
    }
    for child in placed.get("children", []):
        yield from boxes(child, placed["id"])


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))
