#!/usr/bin/env python3
"""Measures worlds by other means and compares with what their reports say was measured.

    tests/referee/measure_worlds.py WORLD_FOLDER...

Reads `world.json` for the geometry and `report.json` for what was measured, and shares no code with the program: floor is
polygons here (shapely), where the program has maximal rectangles, rays and a search over squares.

    doors        clear width: never more than the opening between its jambs, and at most JAMBS_M less
    circles      largest circle on the free floor of a room: the inscribed circle of floor without furniture
    corridors    widest square that can be pushed from door to door: the floor eroded by half of it stays one piece
    docks        free half circle before a dock: the largest half disc before the middle of its front that touches nothing
    areas        net floor of a room

Exit status 1 when a figure differs by more than its tolerance, or when a kind was never met.
"""
import argparse
import collections
import json
import math
import pathlib
import re
import sys

import shapely
from shapely import affinity
from shapely.geometry import LineString, Point, Polygon, box
from shapely.ops import unary_union

JAMBS_M = 0.15
FLAT_M, ROBOT_HEIGHT_M, HEAD_ROOM_M, SHALLOW_M = 0.03, 1.2, 2.03, 0.10
# What stands in the plane of a dock's front or beside it does not bound what is before it.
BESIDE_M = 0.02
TOLERANCE_M = {"doors": 0.002, "circles": 0.02, "corridors": 0.03, "docks": 0.02, "areas": 0.005}


def ring(points):
    return Polygon([(p["x"], p["y"]) for p in points])


def line(of):
    return LineString([(of["start"]["x"], of["start"]["y"]), (of["end"]["x"], of["end"]["y"])])


class Thing:
    """Something that was placed."""

    def __init__(self, placement):
        self.id, self.room = placement["placement_id"], placement["room_id"]
        pose, (width, depth, height) = placement["pose"], placement["size_m"]
        self.pose, self.width, self.depth = pose, width, depth
        self.support, self.group = placement.get("support"), placement.get("group")
        flat = box(-depth / 2, -width / 2, depth / 2, width / 2)
        turned = affinity.rotate(flat, pose["yaw_rad"], origin=(0, 0), use_radians=True)
        self.outline = affinity.translate(turned, pose["x"], pose["y"])
        shallow = placement["mount"] == "wall" and depth <= SHALLOW_M + 1e-6
        self.stops_robot = pose["z"] + height > FLAT_M and pose["z"] < ROBOT_HEIGHT_M and not shallow
        self.stops_people = self.stops_robot or placement["mount"] == "wall" and not shallow and pose["z"] < HEAD_ROOM_M


class World:
    def __init__(self, folder):
        world = json.loads((folder / "world.json").read_text())
        plan = world["floorplan"]
        self.name = folder.name
        self.rows = json.loads((folder / "report.json").read_text())["constraints"]
        self.rooms = {r["room_id"]: ring(r["net_polygon"]) for r in plan["rooms"]}
        self.circulation = {r["room_id"] for r in plan["rooms"] if r["circulation"]}
        self.doors = {d["door_id"]: d for d in plan["doors"]}
        self.walls = plan["walls"]
        self.things = {t.id: t for t in map(Thing, world["placements"]["placements"])}
        self.standing = collections.defaultdict(list)
        for obstacle in plan.get("obstacles", []):
            self.standing[obstacle["room_id"]].append(ring(obstacle["outline"]))

    def free(self, room, stops):
        taken = [t.outline for t in self.things.values() if t.room == room and stops(t)]
        return self.rooms[room].difference(unary_union(taken + self.standing[room]))

    def opening(self, door_id):
        """Length of a door's line that no crossing wall covers, m."""
        door = self.doors[door_id]
        own = line(door["line"])
        direction = math.atan2(*reversed([b - a for a, b in zip(own.coords[0], own.coords[-1])]))
        crossing = []
        for wall in self.walls:
            other = line(wall["line"])
            angle = math.atan2(*reversed([b - a for a, b in zip(other.coords[0], other.coords[-1])])) - direction
            if abs(math.sin(angle)) > 0.3:
                crossing.append(other.buffer(wall["thickness_m"] / 2, cap_style="flat"))
        return own.difference(unary_union(crossing)).length if crossing else own.length


def circle(world, room):
    free = world.free(room, lambda t: t.stops_robot)
    parts = getattr(free, "geoms", [free])
    return max((2 * shapely.maximum_inscribed_circle(p, tolerance=0.001).length for p in parts if p.area > 0), default=0.0)


def along(floor, of):
    """Extent of some floor along a line, m."""
    if floor.is_empty:
        return 0.0
    (x0, y0), (x1, y1) = of.coords[0], of.coords[-1]
    corners = shapely.get_coordinates(floor)
    at = [((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / of.length for x, y in corners]
    return max(at) - min(at)


def passage(world, room):
    """Widest square that can be pushed between all doors of a room, m; none for a room with one door or none."""
    doors = [d for d in world.doors.values() if room in d["room_ids"]]
    free = world.free(room, lambda t: t.stops_people)
    if len(doors) < 2:
        return None

    def passes(width):
        # a hair less than half: floor exactly as wide as the square keeps the line that its middle runs along
        left = free.buffer(-(width / 2 - 0.002), join_style="mitre", mitre_limit=10)
        parts = list(getattr(left, "geoms", [left]))

        def reached(door):
            # at the door itself only the door's own width is asked for
            own = line(door["line"])
            before = own.buffer(door["wall_thickness_m"] / 2 + 0.02, cap_style="flat")
            wanted = min(width, door["clear_width_m"], own.length) - 0.01
            swept = [part.buffer(width / 2, join_style="mitre", mitre_limit=10).intersection(before) for part in parts]
            return {n for n, floor in enumerate(swept) if along(floor, own) >= wanted}

        return bool(set.intersection(*map(reached, doors)))

    low, high = 0.0, 12.0
    while high - low > 0.002:
        middle = (low + high) / 2
        low, high = (middle, high) if passes(middle) else (low, middle)
    return low


def half_disc(world, thing):
    """Radius of the free half disc before a thing's front, m."""
    room = world.rooms[thing.room]
    belongs = lambda o: o.support == thing.id or thing.support == o.id
    taken = [t.outline for t in world.things.values() if t.room == thing.room and t.id != thing.id and t.stops_robot and not belongs(t)]
    walls = room.boundary
    yaw = thing.pose["yaw_rad"]
    front = (thing.pose["x"] + math.cos(yaw) * thing.depth / 2, thing.pose["y"] + math.sin(yaw) * thing.depth / 2)
    ahead = box(BESIDE_M, -50, 50, 50)
    ahead = affinity.translate(affinity.rotate(ahead, yaw, origin=(0, 0), use_radians=True), *front)
    bounds = [g.intersection(ahead) for g in [walls, *taken, *world.standing[thing.room]]]
    return min((g.distance(Point(front)) for g in bounds if not g.is_empty), default=0.0)


def compared(world, row):
    """Returns the kind of a row of the report with our own figure, or with the least and most that it may be."""
    name, subject = row["name"], row["subject"]
    if subject in world.doors and re.search(r"clear_width|door_width|clear_opening|door_clear", name) and "height" not in name:
        opening = world.opening(subject)
        return "doors", opening - JAMBS_M, opening
    if subject in world.rooms and "turn" in name and "needs" not in row["note"] and row["unit"] == "m":
        return "circles", *[circle(world, subject)] * 2
    if subject in world.circulation and re.search(r"corridor_width|hallway_width|clear_width", name) and "to" not in name:
        width = passage(world, subject)
        return width and ("corridors", width, width)
    if subject in world.things and "clearance_radius_180" in name:
        return "docks", *[half_disc(world, world.things[subject])] * 2
    if subject in world.rooms and name.startswith("room_area"):
        return "areas", *[world.rooms[subject].area] * 2
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=pathlib.Path)
    wrong, met = 0, collections.Counter()
    folders = parser.parse_args().folders
    for world in map(World, folders):
        for row in world.rows:
            if row["measured"] is None or not (own := compared(world, row)):
                continue
            kind, least, most = own
            met[kind] += 1
            if not least - TOLERANCE_M[kind] <= row["measured"] <= most + TOLERANCE_M[kind]:
                wrong += 1
                figure = f"{least:.3f}" if least == most else f"{least:.3f} to {most:.3f}"
                print(f"{world.name}: {row['constraint_id']} of {row['subject']}: {row['measured']}, is {figure} ({kind})")
    missing = sorted(set(TOLERANCE_M) - set(met))
    if missing:
        print(f"never met: {', '.join(missing)}")
    counts = ", ".join(f"{n} {kind}" for kind, n in sorted(met.items()))
    print(f"measured by other means: {len(folders)} worlds, {counts}; {wrong} figures differ")
    return 1 if wrong or missing else 0


if __name__ == "__main__":
    sys.exit(main())
