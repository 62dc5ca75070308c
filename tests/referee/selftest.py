#!/usr/bin/env python3
"""Breaks a sound world in every way `check_world.py` names, and expects each break to be found."""

import copy
import math
import sys

from check_world import RULES, World, check_building


def at(x, y, z=0.0):
    return {"x": float(x), "y": float(y), "z": float(z)}


def part(a, b, **more):
    return {"start": at(*a), "end": at(*b), **more}


def thing(name, x, y, w=0.8, d=0.6, h=0.75, z=0.0):
    pose = {"position": at(x, y, z), "orientation": {"w": 1.0, "x": 0.0, "y": 0.0, "z": 0.0}}
    return {"name": name, "model": "Common/Box", "pose": pose, "bbox": [[-w / 2, w / 2], [-d / 2, d / 2], [0.0, h]]}


def zone(name, room_type, corners, walls, doors, things):
    return {
        "name": name, "corners": [at(*c) for c in corners], "walls": [part(*w) for w in walls],
        "doors": [part(a, b, name=n) for n, a, b in doors],
        "semantics": [{"state": "room_type", "value": room_type}], "entities": {"static": things, "dynamic": []},
    }


SOUND = {"zones": [
    zone("hall_1", "hall", [(0, 0), (4, 0), (4, 4), (0, 4)],
         [((0, 0), (1, 0)), ((2, 0), (4, 0)), ((4, 0), (4, 1)), ((4, 2), (4, 4)), ((4, 4), (0, 4)), ((0, 4), (0, 0))],
         [("entrance", (1, 0), (2, 0)), ("inner", (4, 1), (4, 2))],
         [thing("table", 2, 3.4), thing("cup", 2, 3.4, 0.1, 0.1, 0.1, z=0.75)]),
    zone("office_1", "office", [(4, 0), (8, 0), (8, 4), (4, 4)],
         [((4, 0), (8, 0)), ((8, 0), (8, 1)), ((8, 2), (8, 4)), ((8, 4), (4, 4))], [],
         [thing("desk", 7.4, 3.4), thing("clock", 6, 3.9, 0.3, 0.1, 0.3, z=1.3)]),
    zone("bathroom_1", "bathroom", [(8, 0), (11, 0), (11, 4), (8, 4)],
         [((8, 0), (11, 0)), ((11, 0), (11, 4)), ((11, 4), (8, 4))], [("bath", (8, 1), (8, 2))], []),
]}
GRAPH = {
    "rooms": [{"id": "hall_1", "room_type": "hall"}, {"id": "office_1", "room_type": "office"},
              {"id": "bathroom_1", "room_type": "bathroom"}],
    "edges": [{"a": "hall_1", "b": "office_1", "connector": "door"}],
}


def things(world, i):
    return world["zones"][i]["entities"]["static"]


def rename_type(world, i, room_type):
    world["zones"][i]["semantics"][0]["value"] = room_type


def wall_up(world):
    world["zones"][0]["doors"].pop(1)
    world["zones"][0]["walls"].append(part((4, 0), (4, 4)))


def fill(world):
    things(world, 1).extend(thing(f"pile_{i}", 5.2, 0.5 + i, 1.2, 1.0) for i in range(4))


def hide_behind_bedroom(world):
    rename_type(world, 1, "bedroom")
    rename_type(world, 2, "kitchen")


def far_thing(world):
    things(world, 1)[0]["pose"]["position"]["x"] = 7.9


def enter_from_court(world):
    """Builds a gallery around what the entrance leads to."""
    around = [(0, 0), (0, -13), (4, -13), (4, 0), (3, 0), (3, -12), (0.5, -12), (0.5, 0)]
    walls = list(zip(around, around[1:]))
    world["zones"].append(zone("gallery_1", "hall", around, walls, [], []))


BREAKS = {
    "number": [lambda w: things(w, 0)[0]["pose"]["position"].update(x=math.nan)],
    "name": [lambda w: things(w, 1)[0].update(name="table")],
    "shape": [lambda w: w["zones"][0]["corners"].reverse(),
              lambda w: w["zones"][0].update(corners=[at(0, 0), at(4, 4), at(4, 0), at(0, 4)])],
    "overlap": [lambda w: w["zones"][1]["corners"].__setitem__(0, at(3.5, 0))],
    "enclosed": [lambda w: w["zones"][0]["walls"].pop(4)],
    "wall_place": [lambda w: w["zones"][0]["walls"].append(part((1, 2), (3, 2)))],
    "door_place": [lambda w: w["zones"][0]["walls"].append(part((4, 0), (4, 4))),
                   lambda w: w["zones"][0]["doors"].append(part((1, 2), (2, 2), name="adrift"))],
    "door_width": [lambda w: w["zones"][0]["doors"][0].update(end=at(1.5, 0))],
    "door_front": [lambda w: things(w, 0).append(thing("box", 1.5, 0.4, 0.3, 0.3))],
    "entrance": [lambda w: w["zones"][0]["doors"].pop(0), enter_from_court],
    "thing_size": [lambda w: things(w, 0)[0].pop("bbox"), lambda w: things(w, 0)[0]["bbox"].__setitem__(2, [0.0, 0.0])],
    "thing_room": [far_thing],
    "thing_overlap": [lambda w: things(w, 0).append(thing("second", 2.3, 3.4))],
    "thing_support": [lambda w: things(w, 0)[1]["pose"]["position"].update(z=0.9, x=2.9)],
    "robot_room": [wall_up, fill],
    "robot_whole": [wall_up],
    "private_way": [hide_behind_bedroom],
    "graph_room": [lambda w: w["zones"].pop(2), lambda w: rename_type(w, 1, "store")],
    "graph_link": [wall_up],
}


def building(*, beyond=0.0, toilet="accessible_wc", upper_type="office"):
    """Two storeys of five rooms with one toilet at the ground; the upper one reaches beyond the lower one."""
    def storey(right, kinds, objects):
        zones = []
        for i, kind in enumerate(kinds):
            box = [(4 * i, 0), (4 * i + 4, 0), (4 * i + 4, 4), (4 * i, 4)]
            box = [(x + right if x == 4 * len(kinds) else x, y) for x, y in box]
            zones.append(zone(f"{kind}_{i}", kind, box, [], [], objects if i == 0 else []))
        return World({"zones": zones}, None, 0.30)
    flush = [thing("flush", 2, 2) | {"type": toilet}] if toilet else []
    return {0: storey(0.0, ["toilet", "hall", "office"], flush), 1: storey(beyond, ["office", "office", upper_type], [])}


BUILDINGS = {
    "storey_stands": [building(beyond=2.0)],
    "toilets": [building(toilet=None), building(toilet="wc"), building(toilet=None, upper_type="bedroom")],
}
SOUND_BUILDINGS = [building(), building(beyond=1.0), building(toilet="wc", upper_type="bedroom")]


def broken(world):
    return {b["rule"] for b in World(world, GRAPH, 0.30).broken}


def main():
    missed = [f"the sound world is said to break {rule}" for rule in sorted(broken(SOUND))]
    missed += [f"a sound building is said to break {b['rule']}" for sound in SOUND_BUILDINGS for b in check_building(sound)]
    missed += [f"no break is tried for {rule}" for rule in RULES if rule not in BREAKS and rule not in BUILDINGS]
    for rule, buildings in BUILDINGS.items():
        missed += [f"{rule}, building {i}: not found" for i, b in enumerate(buildings, 1) if rule not in {x["rule"] for x in check_building(b)}]
    for rule, mutations in BREAKS.items():
        for number, mutate in enumerate(mutations, 1):
            world = copy.deepcopy(SOUND)
            mutate(world)
            found = broken(world)
            if rule not in found:
                missed.append(f"{rule}, break {number}: found only {sorted(found)}")
    tried = sum(map(len, [*BREAKS.values(), *BUILDINGS.values()]))
    print("\n".join(missed) or f"{tried} breaks of {len(RULES)} rules found, the sound world is clean")
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
