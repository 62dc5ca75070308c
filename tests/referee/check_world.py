#!/usr/bin/env python3
"""Judges generated worlds from outside: reads `world.yaml` alone and recomputes everything in exact geometry.

Usage: check_world.py WORLD.yaml|FOLDER ... [--graph GRAPH.json] [--robot-radius 0.30] [--json]

It shares no code with the generator, so that a mistake there cannot excuse itself here. Robots are judged by eroding the
free floor by their radius, without a grid. Meters, square meters, radians. Exit status 0 when every world holds every
rule, 1 when one does not, 2 when a file cannot be read. GRAPH is what `d3dgen scene-graph --simple` writes.
"""

import argparse
import json
import math
import sys
from collections import Counter
from pathlib import Path

import yaml
from shapely import STRtree
from shapely.geometry import LineString, Polygon
from shapely.ops import unary_union

RULES = {
    "number": "every number is finite",
    "name": "names of zones, doors and things are unique",
    "shape": "a zone is a simple polygon, counter-clockwise, first corner not repeated",
    "overlap": "zones do not overlap",
    "enclosed": "around a zone there is wall, door or neighbor everywhere",
    "wall_place": "a wall runs along a zone's edge",
    "door_place": "a door stands on the edge of one or two zones with no wall in its opening",
    "door_width": "a door is at least 0.6 m wide",
    "door_front": "the floor 0.5 m on both sides of a door is free",
    "entrance": "one can enter the building",
    "thing_size": "a thing has a box of positive size",
    "thing_room": "a thing stands in its zone",
    "thing_overlap": "two things do not share space",
    "thing_support": "a thing above the floor stands on another, hangs at a wall or from above",
    "robot_room": "a robot can use at least half of the free floor of every zone",
    "robot_whole": "95 % of a robot's free floor hang together, and with an entrance",
    "private_way": "no room but an en suite or a closet is reached only through a bedroom or bathroom",
    "graph_room": "zones are the rooms of the graph, with their types",
    "graph_link": "rooms the graph connects have a door or an opening between them",
    "storey_stands": "of a storey at most a tenth lies beyond the storey below it",
    "toilets": "a building of several rooms has a toilet; where nobody sleeps, one for wheelchairs on the ground too",
}

LEAST_COURT_M2 = 25.0  # larger than any stairwell
NEAR = 0.14  # how far the line of a wall or door may lie from the edge it belongs to: half an outer wall
LINE = 0.05  # half the thickness in which a wall stops a robot
FLAT = 0.03  # things this low are driven over
HEAD = 1.2  # things that begin this high do not stop a robot
SLACK = 0.03  # rounding of a robot's radius that a 5 cm grid would allow too
MOST_BEYOND = 0.1  # share of a storey that may jut out over the one below
LEAST_ROOMS = 5  # zones of a building from which on it is one that people spend their day in
# Words in types of things and rooms: what flushes, what is made for wheelchairs, where people sleep.
FLUSHES = ("wc", "toilet", "urinal", "cubicle")
STEP_FREE = ("accessible", "assisted", "bariatric")
SLEEPS = ("bedroom", "studio", "living", "patient", "resident", "ward", "guest_room", "dorm", "cell", "icu", "care_room")
# Words in room types: rooms one does not walk through, and rooms that may open on such a room alone.
PRIVATE = ("bedroom", "bath", "suite", "shower", "toilet", "guest_room", "patient_room")
BELONGS = ("bath", "suite", "shower", "toilet", "closet", "dressing", "balcony")


def point(p):
    return (float(p["x"]), float(p["y"])) if isinstance(p, dict) else (float(p[0]), float(p[1]))


def line(item):
    return LineString([point(item["start"]), point(item["end"])])


def finite(node):
    if isinstance(node, dict):
        return all(finite(v) for v in node.values())
    if isinstance(node, list):
        return all(finite(v) for v in node)
    return not isinstance(node, float) or math.isfinite(node)


class Thing:
    """A static entity as a footprint between two heights."""

    def __init__(self, entity, zone):
        self.name, self.zone, self.type = entity["name"], zone, entity.get("type", "")
        at, turn = entity["pose"]["position"], entity["pose"]["orientation"]
        w, x, y, z = (turn[k] for k in "wxyz")
        yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        box = entity.get("bbox") or [[0, 0]] * 3
        self.sized = len(box) == 3 and all(high > low for low, high in box)
        (x0, x1), (y0, y1), (z0, z1) = box
        cos, sin = math.cos(yaw), math.sin(yaw)
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        self.foot = Polygon([(at["x"] + cos * u - sin * v, at["y"] + sin * u + cos * v) for u, v in corners])
        self.low, self.high = at["z"] + z0, at["z"] + z1

    @property
    def stops(self):
        return self.high > FLAT and self.low < HEAD


class World:
    """The parts of a world.yaml, with everything that is wrong collected in `broken`."""

    def __init__(self, doc, graph, radius):
        self.broken, self.graph, self.radius = [], graph, radius
        self.zones, self.types, self.walls, self.doors, self.things = {}, {}, [], [], []
        if not finite(doc):
            self.fail("number", "world")
            return
        names = Counter()
        for zone in doc["zones"]:
            name = zone["name"]
            names[name] += 1
            self.read_zone(name, zone)
            for door in zone.get("doors") or []:
                names[door["name"]] += 1
                self.doors.append((door["name"], line(door)))
            for entity in (zone.get("entities") or {}).get("static") or []:
                names[entity["name"]] += 1
                thing = Thing(entity, name)
                if thing.sized:
                    self.things.append(thing)
                else:
                    self.fail("thing_size", thing.name)
        for name in sorted(n for n, count in names.items() if count > 1):
            self.fail("name", name)
        self.walls_union = unary_union(self.walls)
        self.check_plan()
        self.check_doors()
        self.check_things()
        self.check_robot()
        self.check_ways()
        if graph is not None:
            self.check_graph()

    def fail(self, rule, subject, **figures):
        self.broken.append({"rule": rule, "subject": subject, **figures})

    def read_zone(self, name, zone):
        corners = [point(c) for c in zone["corners"]]
        polygon = Polygon(corners) if len(corners) > 2 else Polygon()
        if polygon.area <= 0 or not polygon.is_valid or not polygon.exterior.is_ccw or corners[0] == corners[-1]:
            self.fail("shape", name)
        if polygon.is_valid and polygon.area > 0:
            self.zones[name] = polygon
        for item in zone.get("semantics") or []:
            if item.get("state") == "room_type":
                self.types[name] = item["value"]
        self.walls += [line(w) for w in zone.get("walls") or []]

    def check_plan(self):
        names = list(self.zones)
        edges = unary_union([p.exterior for p in self.zones.values()])
        for wall in self.walls:
            stray = wall.difference(edges.buffer(NEAR)).length
            if stray > 0.05:
                self.fail("wall_place", str(wall), length_m=round(stray, 3))
        closed = unary_union([part.buffer(NEAR) for part in self.walls + [d for _, d in self.doors]])
        self.links = set()
        for i, a in enumerate(names):
            gap = self.zones[a].exterior.difference(closed)
            for j, b in enumerate(names):
                if i < j and (shared := self.zones[a].intersection(self.zones[b]).area) > 0.01:
                    self.fail("overlap", f"{a}, {b}", area_m2=round(shared, 3))
                if i != j and not gap.is_empty and self.zones[b].distance(gap) < NEAR:
                    passage = gap.intersection(self.zones[b].buffer(NEAR))
                    if passage.length > 0.3:
                        self.links.add(frozenset((a, b)))
                    gap = gap.difference(passage)
            if gap.length > 0.1:
                self.fail("enclosed", a, length_m=round(gap.length, 3))

    def check_doors(self):
        self.entrances, self.beside = [], {}
        low = [t for t in self.things if t.stops]
        built = unary_union([p.buffer(NEAR, join_style="mitre") for p in self.zones.values()])
        holes = [ring for part in getattr(built, "geoms", [built]) for ring in getattr(part, "interiors", [])]
        # stairwells are no zones of upper storeys, and smaller
        courts = unary_union([ring for ring in holes if Polygon(ring).area >= LEAST_COURT_M2])
        for name, door in self.doors:
            if door.length < 0.6:
                self.fail("door_width", name, width_m=round(door.length, 3))
            sides = [z for z, p in self.zones.items() if door.difference(p.exterior.buffer(NEAR)).length < 0.1 * door.length]
            opening = LineString([door.interpolate(f, normalized=True) for f in (0.1, 0.9)])
            if len(sides) not in (1, 2) or opening.buffer(0.01).intersection(self.walls_union).length > 0.03:
                self.fail("door_place", name, zones=len(sides))
                continue
            self.beside[name] = sides
            if len(sides) == 1:
                # a door to ground with rooms all around is no way in
                if courts.is_empty or courts.distance(door) > 2 * NEAR:
                    self.entrances.append((door, sides[0]))
            else:
                self.links.add(frozenset(sides))
            front = door.buffer(0.5, cap_style="flat").intersection(unary_union([self.zones[z] for z in sides]))
            for thing in low:
                if front.intersection(thing.foot).area > 0.002:
                    self.fail("door_front", f"{name}, {thing.name}")
        if not self.entrances:
            self.fail("entrance", "world")

    def check_things(self):
        solid = [t for t in self.things if t.high - t.low > FLAT]
        tree = STRtree([t.foot for t in solid]) if solid else None
        for i, thing in enumerate(solid):
            under = []
            for j in tree.query(thing.foot):
                other = solid[j]
                shared = thing.foot.intersection(other.foot).area
                depth = min(thing.high, other.high) - max(thing.low, other.low)
                if i < j and shared > 4e-4 and depth > 0.02:
                    self.fail("thing_overlap", f"{thing.name}, {other.name}", area_m2=round(shared, 4))
                if i != j and shared > 0.25 * thing.foot.area and abs(other.high - thing.low) < 0.03:
                    under.append(other.name)
            hangs = thing.low > 1.5 or thing.foot.distance(self.walls_union) < 0.25
            if thing.low > FLAT and not under and not hangs:
                self.fail("thing_support", thing.name, height_m=round(thing.low, 3))
        for thing in self.things:
            zone = self.zones.get(thing.zone)
            if zone is not None and thing.foot.difference(zone.buffer(0.02)).area > 4e-4:
                self.fail("thing_room", thing.name)

    def check_robot(self):
        solid = [w.buffer(LINE, cap_style="flat") for w in self.walls] + [t.foot for t in self.things if t.stops]
        # A seam of rounding between two zones must not part them.
        floor = unary_union([p.buffer(0.01, join_style="mitre") for p in self.zones.values()]).difference(unary_union(solid))
        space = floor.buffer(SLACK - self.radius, quad_segs=4)
        parts = sorted(getattr(space, "geoms", None) or [space], key=lambda part: -part.area)
        main, whole = parts[0], space.area
        self.share = main.area / whole if whole else 0.0
        if self.share < 0.95:
            self.fail("robot_whole", "world", share=round(self.share, 3))
        if self.entrances and not any(main.distance(d) < self.radius + 0.3 for d, _ in self.entrances):
            self.fail("robot_whole", "no entrance reaches the robot's floor")
        for name, zone in self.zones.items():
            own = space.intersection(zone).area
            if own < 0.01 or main.intersection(zone).area < 0.5 * own:
                self.fail("robot_room", name, free_m2=round(own, 3))

    def check_ways(self):
        """Walks from the entrances without passing through private rooms."""
        reached = {zone for _, zone in self.entrances}
        todo = list(reached)
        while todo:
            here = todo.pop()
            if self.is_any(here, PRIVATE):
                continue
            for link in self.links:
                if here in link:
                    fresh = link - reached
                    reached |= fresh
                    todo += fresh
        for name in sorted(set(self.zones) - reached):
            if not self.is_any(name, BELONGS):
                self.fail("private_way", name)

    def is_any(self, zone, words):
        return has_word(self.types.get(zone, ""), words)

    def check_graph(self):
        wanted = {room["id"]: room.get("room_type") for room in self.graph["rooms"]}
        for name in sorted(set(wanted) ^ set(self.zones)):
            self.fail("graph_room", name)
        for name in sorted(set(wanted) & set(self.zones)):
            if wanted[name] is not None and self.types.get(name, wanted[name]) != wanted[name]:
                self.fail("graph_room", name, room_type=self.types[name])
        for edge in self.graph.get("edges", []):
            if edge["connector"] in ("door", "open") and frozenset((edge["a"], edge["b"])) not in self.links:
                self.fail("graph_link", f"{edge['a']}, {edge['b']}")

    def figures(self):
        area = sum(p.area for p in self.zones.values())
        return {
            "zones": len(self.zones), "doors": len(self.doors), "things": len(self.things),
            "things_per_zone": round(len(self.things) / max(1, len(self.zones)), 2), "area_m2": round(area, 2),
            "robot_share": round(getattr(self, "share", 0.0), 4),
        }


def has_word(text, words):
    return any(word in text for word in words)


def check_building(storeys):
    """Returns what is broken in a building: its worlds by the number of their storey."""
    broken, levels = [], sorted(storeys)
    for below, level in zip(levels, levels[1:]):
        if below < 0:
            continue  # a cellar stands in the ground
        lower, upper = (unary_union(list(storeys[n].zones.values())) for n in (below, level))
        beyond = upper.difference(lower.buffer(NEAR, join_style="mitre")).area / max(1.0, upper.area)
        if beyond > MOST_BEYOND:
            broken.append({"rule": "storey_stands", "subject": f"level {level}", "share": round(beyond, 3)})
    types = [t for world in storeys.values() for t in world.types.values()]
    if len(types) < LEAST_ROOMS:
        return broken
    flushing = {n: [t.type for t in world.things if has_word(t.type, FLUSHES)] for n, world in storeys.items()}
    ground = flushing.get(0, [])
    if not any(flushing.values()):
        broken.append({"rule": "toilets", "subject": "world"})
    elif not any(has_word(t, SLEEPS) for t in types) and not any(has_word(t, STEP_FREE) for t in ground):
        broken.append({"rule": "toilets", "subject": "level 0", "for": "wheelchairs"})
    return broken


def read(path, graph=None, radius=0.30):
    """Returns the world of a world.yaml."""
    with open(path, encoding="utf-8") as file:
        doc = yaml.load(file, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    return World(doc, graph, radius)


def judge(path, graph=None, radius=0.30):
    """Returns what is broken in a world.yaml, and its figures."""
    world = read(path, graph, radius)
    assert all(b["rule"] in RULES for b in world.broken)
    return world.broken, world.figures()


def judge_building(files):
    """Returns what is broken in the building whose storeys have these world.yaml, each in a folder of its number."""
    return check_building({int(file.parent.name): read(file) for file in files})


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("worlds", nargs="+", type=Path)
    parser.add_argument("--graph", type=Path)
    parser.add_argument("--robot-radius", type=float, default=0.30)
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    files = [f for p in args.worlds for f in (sorted(p.rglob("world.yaml")) if p.is_dir() else [p])]
    clean = 0
    try:
        graph = json.loads(args.graph.read_text()) if args.graph else None
        storeys = {}
        for file in files:
            storeys.setdefault(file.parent.parent, []).append(file)
        of_building = {own[0]: judge_building(own) for own in storeys.values() if all(f.parent.name.lstrip("-").isdigit() for f in own)}
        for file in files:
            broken, figures = judge(file, graph, args.robot_radius)
            broken += of_building.get(file, [])
            clean += not broken
            if args.json:
                print(json.dumps({"world": str(file), "broken": broken, "figures": figures}))
            else:
                print(f"{file}: {'clean' if not broken else f'{len(broken)} broken'} {figures}")
                print("".join(f"    {b}\n" for b in broken), end="")
    except (OSError, ValueError, KeyError, TypeError, yaml.YAMLError) as error:
        print(f"cannot be read: {type(error).__name__}: {error}", file=sys.stderr)
        sys.exit(2)
    print(f"{clean} of {len(files)} worlds clean", file=sys.stderr)
    sys.exit(0 if files and clean == len(files) else 1)


if __name__ == "__main__":
    main()
