#!/usr/bin/env python3
"""Counts in finished worlds what a reviewer of plans objects to, as far as the documents decide it.

    d3dgen bench paper --out target/paper && tests/plan_objections.py target/paper

Reads `scene_graph.json`, `floorplan.json`, `placements.json` and `scenario.json` of every world below the folder, and nothing of the program. One
objection of weight A, or three different ones of weight B, send a plan back. Exit status 1 when a tenth of the plans or more
would be sent back, 2 when there are no worlds. `--list` names the plans of each objection; `--page` prints the tables of
docs/plans.md and reads no worlds, `--page docs/plans.md` tells whether they are in it.

This is no referee: what must never be is for `judge_worlds.py`. Lengths in m; figures are those that reviewers named
(docs/plans.md), less a centimeter or two for rounding.
"""

import argparse
import json
import math
import sys
from collections import Counter, defaultdict
from pathlib import Path

WET = {"accessible_bathroom", "bathroom", "ensuite", "guest_toilet", "kitchen", "kitchenette", "laundry", "shower_room", "toilet"}
HAND_BASINS = {"accessible_basin", "clinical_basin", "small_basin", "washbasin"}
DESKS = {"desk", "small_desk"}
WORK_CHAIRS = {"swivel_chair", "task_chair"}
VISITOR_SEATS = {"lounge_chair", "lounge_sofa", "visitor_chair"}
HOUSES = {"house", "terraced_house", "tiny_house", "villa"}
ATTACHED = {"flat", "one_bedroom_flat", "small_flat", "shared_flat", "studio", "terraced_house"}
LOCKS = {"anteroom", "lab_airlock", "sound_lock"}
TOILETS = {"accessible_wc", "toilet", "wc_cubicle"}
EAST, NORTH, WEST, SOUTH = range(4)
GRAZE = 0.02

# One plan of so many is sent back at most.
MOST_BACK = 10
OBJECTIONS = []


def objection(weight, domain=None):
    """Registers a function that takes a world and returns whether its docstring is to be objected to."""

    def register(function):
        OBJECTIONS.append((weight, domain, " ".join(function.__doc__.split()), function))
        return function

    return register


class Body:
    """Something placed: its outline as (x0, y0, x1, y1) and its heading in quarter turns from east."""

    def __init__(self, placement):
        self.object, self.mount, self.group = placement["object"], placement["mount"], placement.get("group")
        (self.width, self.depth, height), pose = placement["size_m"], placement["pose"]
        self.x, self.y, self.yaw = pose["x"], pose["y"], pose["yaw_rad"]
        self.low, self.high = pose.get("z", 0.0), pose.get("z", 0.0) + height
        self.quarter = round(self.yaw / (math.pi / 2)) % 4
        w, h = (self.depth, self.width) if self.quarter % 2 == 0 else (self.width, self.depth)
        self.rect = (self.x - w / 2, self.y - h / 2, self.x + w / 2, self.y + h / 2)

    def seen(self, x, y):
        """A point in this body's own frame: ahead of its middle, and to its left."""
        dx, dy, cos, sin = x - self.x, y - self.y, math.cos(self.yaw), math.sin(self.yaw)
        return dx * cos + dy * sin, dy * cos - dx * sin


class Room:
    """A room with what stands and hangs in it, its doors and windows."""

    def __init__(self, room, plan, placements):
        self.id, self.kind, self.circulation = room["room_id"], room["room_type"], room["circulation"]
        self.level = room.get("level", 0)
        self.area, self.corners = room["net_area_m2"], [(p["x"], p["y"]) for p in room["net_polygon"]]
        self.outer = [(p["x"], p["y"]) for p in room["polygon"]]
        xs, ys = zip(*self.corners, strict=True)
        self.rect = (min(xs), min(ys), max(xs), max(ys))
        self.bodies = [Body(p) for p in placements if p["room_id"] == self.id]
        self.standing = [b for b in self.bodies if b.mount == "floor" and b.high > 0.05]
        self.doors = [d for d in plan["doors"] if self.id in d["room_ids"]]
        self.swings = [swing(d) for d in self.doors if (d.get("swing") or {}).get("into_room_id") == self.id]
        self.windows = [w for w in plan["windows"] if w["room_id"] == self.id]

    def named(self, *objects):
        return [b for b in self.bodies if b.object in objects]

    def having(self, *words):
        """Bodies with one of these words in their names."""
        return [b for b in self.bodies if any(word in b.object for word in words)]

    def free(self, rect, side, obstacles, part=(0.0, 1.0)):
        """Free depth beside a part of one side of a rectangle, up to the next wall or obstacle."""
        walls = [(*a, *b) for a, b in zip(self.corners, self.corners[1:] + self.corners[:1], strict=True)]
        walls = [(min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)) for x0, y0, x1, y1 in walls]
        # seen so that the side looks along the first axis
        turn = {EAST: lambda r: r, WEST: lambda r: (-r[2], r[1], -r[0], r[3]),
                NORTH: lambda r: (r[1], r[0], r[3], r[2]), SOUTH: lambda r: (-r[3], r[0], -r[1], r[2])}[side]  # fmt: skip
        own = turn(rect)
        low, high = (own[1] + (own[3] - own[1]) * share for share in part)
        ahead = (r for r in map(turn, walls + obstacles) if r[3] > low + GRAZE and r[1] < high - GRAZE)
        return max(0.0, min((r[0] - own[2] for r in ahead if r[0] > own[2] - 0.03), default=math.inf))


class World:
    """The documents of one world."""

    def __init__(self, folder):
        documents = ("floorplan", "placements", "scenario", "scene_graph")
        plan, placements, scenario, graph = (json.loads((folder / f"{name}.json").read_text()) for name in documents)
        self.domain, self.building = graph["domain"], graph.get("building_type")
        self.area = sum(r["net_area_m2"] for r in plan["rooms"])
        self.notes = graph.get("conflicts", [])
        self.rooms = [Room(r, plan, placements["placements"]) for r in plan["rooms"]]
        self.walls = [line_of(w) for w in plan["walls"]]
        self.doors = plan["doors"]
        self.robots = scenario.get("robots", [])
        self.stops = [p for p in scenario["pois"] if p["kind"] == "service_point"]
        self.staged = [(z["room_id"], outline(z["polygon"])) for z in scenario["rois"] if z["kind"] == "staging_area"]
        self.docked = [(z["room_id"], outline(z["polygon"])) for z in scenario["rois"] if z["kind"] == "charging_buffer"]

    def of(self, *kinds):
        return [r for r in self.rooms if r.kind in kinds]

    def largest(self, *kinds):
        return max((r.area for r in self.of(*kinds)), default=math.inf)

    def count(self, objects):
        return sum(len(r.named(*objects)) for r in self.rooms)


def gap(a, b):
    return math.hypot(max(0.0, a[0] - b[2], b[0] - a[2]), max(0.0, a[1] - b[3], b[1] - a[3]))


def extent(corners):
    """The rectangle around corners."""
    xs, ys = zip(*corners, strict=True)
    return (min(xs), min(ys), max(xs), max(ys))


def floor_of(corners):
    """The area of a polygon."""
    pairs = zip(corners, corners[1:] + corners[:1], strict=True)
    return abs(sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairs)) / 2.0


def outline(points):
    return extent([(p["x"], p["y"]) for p in points])


def line_of(thing):
    """The outline of a wall, door or window on the center line of its wall."""
    return outline([thing["line"]["start"], thing["line"]["end"]])


def swing(door):
    """The square that a door's leaf sweeps, on both sides of its wall, as far as it is wide."""
    x0, y0, x1, y1 = line_of(door)
    leaf = math.hypot(x1 - x0, y1 - y0) / (2 if door["kind"] == "double_hinged" else 1)
    return (x0, y0 - leaf, x1, y1 + leaf) if x1 - x0 > y1 - y0 else (x0 - leaf, y0, x1 + leaf, y1)


def overlap(a, b, graze=GRAZE):
    return min(a[2], b[2]) - max(a[0], b[0]) > graze and min(a[3], b[3]) - max(a[1], b[1]) > graze


def beside(rect, side, depth):
    """The floor beside one side of a rectangle, as deep as that."""
    x0, y0, x1, y1 = rect
    return [(x1, y0, x1 + depth, y1), (x0, y1, x1, y1 + depth), (x0 - depth, y0, x0, y1), (x0, y0 - depth, x1, y0)][side]


def ahead_of(body, depth):
    """The floor before a body, as deep as that."""
    return beside(body.rect, body.quarter, depth)


def outlines(bodies):
    return [b.rect for b in bodies]


@objection("A")
def no_door(world):
    """a room without a door"""
    return any(not room.doors for room in world.rooms)


@objection("A")
def blind_lock(world):
    """a lock with nothing behind it: no room is entered through it alone"""
    ways = {r.id for r in world.rooms if r.circulation}
    onto = {r.id: {i for d in r.doors for i in d["room_ids"]} - {r.id} for r in world.rooms}
    alone = {i for i, others in onto.items() if i not in ways and not others & ways}
    return any(not onto[lock.id] & alone for lock in world.of(*LOCKS))


@objection("B")
def long_room(world):
    """a room longer than 2.5 times its width"""
    plain = [r.rect for r in world.rooms if not r.circulation and len(r.corners) == 4]
    sides = [(x1 - x0, y1 - y0) for x0, y0, x1, y1 in plain]
    return any(max(s) > 2.5 * min(s) for s in sides)


@objection("B")
def no_dock(world):
    """a robot without a dock"""
    return bool(world.robots) and not any("dock" in b.object for room in world.rooms for b in room.bodies)


@objection("B")
def no_elbow_room(world):
    """a hand basin with less than 0.1 m at a side"""
    for room in world.rooms:
        for basin in room.named(*HAND_BASINS):
            others = [b for b in room.bodies if b is not basin and b.mount in ("floor", "wall")]
            shallow = [b for b in others if b.mount == "wall" and b.depth <= 0.1]
            beside = [b for b in others if b not in shallow and b.low < basin.high and b.high > basin.low]
            sides = [(basin.quarter + 1) % 4, (basin.quarter + 3) % 4]
            if min(room.free(basin.rect, side, outlines(beside)) for side in sides) < 0.1:
                return True
    return False


def circulation_share(world):
    return sum(r.area for r in world.rooms if r.circulation) / sum(r.area for r in world.rooms)


@objection("B", "residential")
def much_hall(world):
    """more than a fifth of a home as circulation"""
    return circulation_share(world) > 0.2


@objection("B", "office")
def much_corridor(world):
    """more than 30 % of an office as circulation"""
    return circulation_share(world) > 0.3


@objection("B", "hospital")
def much_ward_corridor(world):
    """more than 30 % of a ward as circulation"""
    return circulation_share(world) > 0.3


@objection("A", "residential")
def toilet_at_table(world):
    """a bathroom that opens to a kitchen or dining room"""
    rooms = {r.id: r.kind for r in world.rooms}
    pairs = [{rooms[i] for i in d["room_ids"]} for r in world.rooms for d in r.doors]
    return any(p & {"bathroom", "toilet", "guest_toilet"} and p & {"kitchen", "dining_room"} for p in pairs)


@objection("B", "residential")
def no_wardrobe(world):
    """a bedroom without a wardrobe"""
    return any(not any("wardrobe" in b.object for b in room.standing) for room in world.of("bedroom"))


@objection("B", "residential")
def one_sided_bed(world):
    """a double bed with less than 0.4 m at a long side"""
    for room in world.rooms:
        for bed in room.named("double_bed"):
            others = [b for b in room.standing if b is not bed and "nightstand" not in b.object]
            foot = (0.35, 1.0) if bed.quarter in (EAST, NORTH) else (0.0, 0.65)
            sides = [(bed.quarter + 1) % 4, (bed.quarter + 3) % 4]
            if min(room.free(bed.rect, side, outlines(others), foot) for side in sides) < 0.4:
                return True
    return False


@objection("B", "residential")
def few_seats(world):
    """fewer seats at a table than bedrooms and one more, six at most"""
    seats = Counter()
    for room in world.of("living_room", "dining_room", "kitchen", "studio"):
        seats.update(b.group for b in room.named("dining_chair", "stool", "bar_stool"))
    return max(seats.values(), default=0) < min(len(world.of("bedroom")) + 1, 6)


@objection("B", "residential")
def no_coats(world):
    """no place for coats where one comes in"""
    places = ("coat", "hook", "wardrobe")
    entered = [r for r in world.rooms if r.circulation or any(d["entrance"] for d in r.doors)]
    return not any(word in b.object for r in entered for b in r.bodies for word in places)


@objection("B", "residential")
def large_hall(world):
    """a hall, bedroom or bathroom larger than the living room"""
    lived = world.largest("living_room", "studio")
    return any(r.area > lived for r in world.rooms if r.circulation or r.kind in ("bedroom", "bathroom"))


@objection("B", "residential")
def scattered_wet_rooms(world):
    """wet rooms in three places"""
    places = []
    for room in (r for r in world.rooms if r.kind in WET):
        near = [p for p in places if any(gap(room.rect, other.rect) < 0.35 for other in p)]
        places = [p for p in places if p not in near] + [[room, *(other for p in near for other in p)]]
    return len(places) >= 3


@objection("A", "office")
def no_meter_behind_desk(world):
    """less than 1 m from a desk to what is behind who sits at it"""
    for room in world.rooms:
        for chair in room.named(*WORK_CHAIRS):
            desk = min(room.named(*DESKS), key=lambda d: gap(d.rect, chair.rect), default=None)
            if desk is None or gap(desk.rect, chair.rect) > 0.3:
                continue
            back, axis = (chair.quarter + 2) % 4, 1 if chair.quarter % 2 == 0 else 0
            low, length = desk.rect[axis], desk.rect[axis + 2] - desk.rect[axis]
            part = [min(max((chair.rect[k] - low) / length, 0.0), 1.0) for k in (axis, axis + 2)]
            others = [b for b in room.standing if b is not desk and b is not chair]
            if room.free(desk.rect, back, outlines(others), part) < 0.98:
                return True
    return False


@objection("B", "office")
def mirrored_window(world):
    """a window before or behind the screen in a single office"""
    for room in world.of("office", "executive_office"):
        for chair in room.named(*WORK_CHAIRS):
            for window in room.windows:
                a, b = window["line"]["start"], window["line"]["end"]
                for k in range(11):
                    ahead, left = chair.seen(*(a[c] + (b[c] - a[c]) * k / 10 for c in ("x", "y")))
                    if abs(left) < 0.5 and abs(ahead) < 3.5:
                        return True
    return False


@objection("B", "office")
def printer_at_sofa(world):
    """a printer within 0.5 m of a sofa"""
    pairs = ((p, s) for r in world.rooms for p in r.named("printer") for s in r.standing if "sofa" in s.object)
    return any(gap(p.rect, s.rect) < 0.5 for p, s in pairs)


@objection("B", "office")
def sofa_at_desks(world):
    """a sofa within 0.88 m of the desks of an open office"""
    pairs = ((s, d) for r in world.of("open_office") for s in r.standing if "sofa" in s.object for d in r.named(*DESKS))
    return any(gap(s.rect, d.rect) < 0.88 for s, d in pairs)


@objection("B", "office")
def no_place_to_wait(world):
    """a reception with no seat for visitors but among the staff"""
    for room in world.of("reception"):
        desks = [b for b in room.standing if "reception_desk" in b.object]
        seats = room.named(*VISITOR_SEATS)
        apart = [s for s in seats for d in desks if d.seen(s.x, s.y)[0] > -d.depth / 2 or gap(s.rect, d.rect) > 1.1]
        if desks and not apart:
            return True
    return False


def meeting_tables(world):
    return [(r, b) for r in world.of("meeting_room") for b in r.standing if b.object.startswith("meeting_table")]


@objection("B", "office")
def table_at_wall(world):
    """a meeting table with less than 0.9 m behind a seat's edge of it"""
    for room, table in meeting_tables(world):
        chairs = [b for b in room.standing if "chair" in b.object and gap(b.rect, table.rect) < 0.3]
        others = [b for b in room.standing if b is not table and "chair" not in b.object]
        for chair in chairs:
            if room.free(table.rect, (chair.quarter + 2) % 4, outlines(others)) < 0.88:
                return True
    return False


@objection("B", "office")
def screen_behind_backs(world):
    """a meeting room with no screen at a head of its table"""
    for room, table in meeting_tables(world):
        wide = table.rect[2] - table.rect[0] > table.rect[3] - table.rect[1]
        if not any((display.quarter % 2 == 0) == wide for display in room.named("wall_display")):
            return True
    return False


@objection("B", "office")
def no_blind(world):
    """a meeting room with a window and no blind"""
    return any(r.windows and not r.named("blind") for r in world.of("meeting_room"))


@objection("B", "office")
def one_toilet(world):
    """one toilet for more than ten desks"""
    return bool(world.of("toilet")) and world.count(DESKS) > 10 and world.count(TOILETS) < 2


@objection("A", "hospital")
def narrow_bed(world):
    """a patient bed with its head off the wall, or less than 0.88 m at a long side"""
    beside = ("bedside", "iv_", "overbed", "chair")
    for room in world.of("patient_room", "icu_room", "isolation_room"):
        for bed in room.named("hospital_bed"):
            others = [b for b in room.standing if b is not bed and not any(word in b.object for word in beside)]
            foot = (0.4, 1.0) if bed.quarter in (EAST, NORTH) else (0.0, 0.6)
            sides = [(bed.quarter + 1) % 4, (bed.quarter + 3) % 4]
            if room.free(bed.rect, (bed.quarter + 2) % 4, []) > 0.3:
                return True
            if min(room.free(bed.rect, side, outlines(others), foot) for side in sides) < 0.88:
                return True
    return False


@objection("A", "hospital")
def clean_and_dirty(world):
    """a door between clean and dirty utility"""
    rooms = {r.id: r.kind for r in world.rooms}
    doors = [{rooms[i] for i in d["room_ids"]} for r in world.rooms for d in r.doors]
    return {"clean_utility", "dirty_utility"} in doors


@objection("B", "hospital")
def no_visitor_seat(world):
    """a patient room without a seat"""
    seats = ("chair", "recliner")
    return any(not any(word in b.object for b in r.standing for word in seats) for r in world.of("patient_room"))


@objection("B", "hospital")
def no_hand_basin(world):
    """a patient, exam or treatment room without a hand basin"""
    return any(not r.named(*HAND_BASINS) for r in world.of("patient_room", "exam_room", "treatment_room"))


@objection("B", "hospital")
def lone_nurse(world):
    """a nurse station of 18 m2 or more with one workplace"""
    return any(r.area >= 18.0 and len(r.named(*WORK_CHAIRS)) < 2 for r in world.of("nurse_station"))


def seats_of_toilets(world):
    """WCs of patients and visitors, each with its room."""
    kinds = ("ensuite", "bathroom", "accessible_toilet", "assisted_bathroom", "toilet")
    return [(r, t) for r in world.rooms if r.kind.startswith(kinds) for t in r.named("toilet", "accessible_wc")]


@objection("B", "hospital")
def call_out_of_reach(world):
    """a WC with no emergency call within 0.6 m"""
    calls = [(r, t, r.having("emergency_c")) for r, t in seats_of_toilets(world)]
    return any(min((gap(t.rect, c.rect) for c in found), default=9.0) > 0.6 for _, t, found in calls)


@objection("B", "hospital")
def no_rail(world):
    """a WC with no rail at a wall beside it, nor rails at both sides"""
    for room, toilet in seats_of_toilets(world):
        rails = [toilet.seen(b.x, b.y) + (b.quarter,) for b in room.having("rail") if "towel" not in b.object]
        beside = [left for ahead, left, _ in rails if abs(ahead) < 0.5 and 0.15 < abs(left) < 0.65]
        at_wall = [q for ahead, left, q in rails if (q - toilet.quarter) % 2 and abs(left) < 0.65 and abs(ahead) < 0.5]
        if not at_wall and not (min(beside, default=1) < 0 < max(beside, default=-1)):
            return True
    return False


def lying(world):
    """Rooms of patients with a bed in them, each with a bed and the middle of its pillow."""
    for room in (r for r in world.rooms if "patient_room" in r.kind or r.kind in ("vip_room", "isolation_room")):
        for bed in room.named("hospital_bed"):
            back = bed.depth / 2 - 0.3
            yield room, bed, (bed.x - back * math.cos(bed.yaw), bed.y - back * math.sin(bed.yaw))


@objection("B", "hospital")
def visitor_far_away(world):
    """a visitor's chair whose middle is more than 1.75 m from the pillow"""
    for room, _, pillow in lying(world):
        chairs = room.named("visitor_chair")
        if chairs and min(math.dist(pillow, (c.x, c.y)) for c in chairs) > 1.75:
            return True
    return False


@objection("B", "hospital")
def screen_out_of_sight(world):
    """a television that a patient does not see from the bed, or far from its axis"""
    for room, bed, _ in lying(world):
        for screen in room.having("tv"):
            ahead, left = bed.seen(screen.x, screen.y)
            if ahead < 0.3 or abs(left) > ahead + 0.8 or screen.seen(bed.x, bed.y)[0] < 0.3:
                return True
    return False


@objection("B")
def stacked_over_basin(world):
    """something over a hand basin that does not belong to it"""
    for room in world.rooms:
        for basin in room.named(*HAND_BASINS):
            over = [b for b in room.bodies if b.mount == "wall" and b.low > basin.high - 0.3 and b.low < 1.9]
            if any(b.group != basin.group and overlap(b.rect, basin.rect, 0.01) for b in over):
                return True
    return False


@objection("A")
def dock_taken(world):
    """furniture on the free floor of a charging dock"""
    for room_id, floor in world.docked:
        room = next(r for r in world.rooms if r.id == room_id)
        if any(overlap(b.rect, floor) for b in room.standing if "dock" not in b.object and "robot" not in b.object):
            return True
    return False


@objection("B")
def many_bins(world):
    """two bins within 0.5 m, or two clocks in a room"""
    for room in world.rooms:
        bins, clocks = room.having("waste_bin"), room.having("wall_clock")
        close = any(gap(a.rect, b.rect) < 0.5 for k, a in enumerate(bins) for b in bins[:k])
        if close or len(clocks) > (0 if room.kind in WET and "kitchen" not in room.kind else 1):
            return True
    return False


@objection("B", "office")
def floating_desk(world):
    """a desk of an open office with neither a desk, a wall nor a screen behind it"""
    for room in world.of("open_office", "team_office", "coworking_space"):
        desks = room.named(*DESKS)
        for desk in desks:
            screens = [b for b in room.standing if b is not desk and "chair" not in b.object]
            if room.free(desk.rect, (desk.quarter + 2) % 4, outlines(screens), (0.25, 0.75)) > 0.4:
                return True
    return False


@objection("B", "office")
def lone_desk(world):
    """a desk more than 2 m from the others of an open office"""
    for room in world.of("open_office", "team_office", "coworking_space"):
        desks = room.named(*DESKS)
        if len(desks) > 1 and any(min(gap(a.rect, b.rect) for b in desks if b is not a) > 2.0 for a in desks):
            return True
    return False


@objection("B", "office")
def crowded_visitors(world):
    """visitors' seats right beside a counter, behind it, or touching each other or a shelf"""
    for room in world.of("reception", "office", "executive_office", "shared_office"):
        desks = [b for b in room.standing if "reception_desk" in b.object]
        seats = room.named(*VISITOR_SEATS)
        if any(s.group != d.group and gap(s.rect, d.rect) < 0.6 for s in seats for d in desks):
            return True
        others = seats + room.having("shelf", "cupboard", "cabinet", "rack")
        lone = [s for s in seats if s.object == "visitor_chair"]
        apart = ((s, o) for s in lone for o in others if o is not s and (s.group is None or s.group != o.group))
        if any(gap(s.rect, o.rect) < 0.04 and s.quarter == o.quarter for s, o in apart):
            return True
    return False


@objection("A", "office")
def leaf_at_cubicle(world):
    """a door whose leaf sweeps the floor before a WC cubicle"""
    cubicles = [(r, c) for r in world.rooms for c in r.having("cubicle")]
    return any(overlap(ahead_of(c, 0.6), leaf, 0.05) for r, c in cubicles for leaf in r.swings)


@objection("B", "residential")
def armchair_apart(world):
    """an armchair of a living room more than 1.2 m from the coffee table, or turned away from it"""
    for room in world.of("living_room", "studio", "family_room"):
        tables = room.named("coffee_table")
        # a chair to read in has a table of its own
        alone = [b for b in room.named("armchair", "reading_chair") if not b.group or "reading_corner" not in b.group]
        for chair in alone if tables else []:
            table = min(tables, key=lambda t: gap(t.rect, chair.rect))
            if gap(table.rect, chair.rect) > 1.2 or chair.seen(table.x, table.y)[0] < 0.2:
                return True
    return False


@objection("B", "residential")
def narrow_wardrobe(world):
    """a bedroom for two with less than 1.2 m of wardrobe"""
    double = [r for r in world.rooms if r.named("double_bed")]
    closets = any(r.kind in ("walk_in_closet", "dressing_room") for r in world.rooms)
    return not closets and any(sum(b.width for b in r.having("wardrobe")) < 1.19 for r in double)


@objection("B", "residential")
def lone_fridge(world):
    """a fridge more than 0.65 m from the kitchen's run"""
    run = ("sink_unit", "base_cabinet", "hob", "kitchen_unit", "dishwasher", "tall_cabinet")
    for room in world.rooms:
        units = room.having(*run)
        for fridge in room.having("fridge") if units else []:
            if min(gap(fridge.rect, b.rect) for b in units) > 0.65:
                return True
    return False


@objection("A", "residential")
def hob_at_door(world):
    """a hob less than 0.9 m from a door"""
    for room in world.rooms:
        for hob in room.named("hob"):
            if any(gap(hob.rect, line_of(d)) < 0.88 for d in room.doors):
                return True
    return False


@objection("B")
def shower_in_the_middle(world):
    """a shower in no corner"""
    for room in world.rooms:
        for shower in room.having("shower"):
            if "wall" in shower.object or "chair" in shower.object or shower.mount != "floor":
                continue
            flush = [side for side in range(4) if room.free(shower.rect, side, []) < 0.06]
            if not any((side + 1) % 4 in flush for side in flush):
                return True
    return False


def before_window(body, room):
    """Whether a window is behind a body, seen along its width."""
    for window in room.windows:
        a, b = window["line"]["start"], window["line"]["end"]
        for k in range(11):
            ahead, left = body.seen(*(a[c] + (b[c] - a[c]) * k / 10 for c in ("x", "y")))
            if abs(left) < body.width / 2 - 0.05 and -0.6 < ahead + body.depth / 2 < 0.1:
                return True
    return False


@objection("B", "residential")
def bed_under_window(world):
    """the head of a double bed under a window"""
    return any(before_window(bed, r) for r in world.rooms for bed in r.named("double_bed"))


@objection("B", "residential")
def screen_between_windows(world):
    """a television with windows to both sides of it"""
    for room in world.rooms:
        for screen in room.named("tv"):
            sides = set()
            for window in room.windows:
                a, b = window["line"]["start"], window["line"]["end"]
                ahead, left = screen.seen((a["x"] + b["x"]) / 2, (a["y"] + b["y"]) / 2)
                if -1.0 < ahead < 0.1 and abs(left) < 2.5:
                    sides.add(left > 0)
            if len(sides) == 2:
                return True
    return False


def sees(world, eye, point):
    """Whether no wall is between two points."""
    (x, y), (u, v) = eye, point
    for x0, y0, x1, y1 in world.walls:
        if x1 - x0 < y1 - y0:
            share, low, high, other = (x0 - x) / (u - x) if u != x else -1, y0, y1, lambda t: y + t * (v - y)
        else:
            share, low, high, other = (y0 - y) / (v - y) if v != y else -1, x0, x1, lambda t: x + t * (u - x)
        if 0 < share < 1 and low < other(share) < high:
            return False
    return True


@objection("B", "hospital")
def blind_station(world):
    """nurse stations from whose seats and counters no door of a patient is seen"""
    stations = world.of("nurse_station")
    wards = [r for r in world.rooms if r.kind in ("patient_room", "patient_room_double", "icu_room", "postnatal_room")]
    if not stations or not wards:
        return False
    eyes = [(b.x, b.y) for r in stations for b in r.named(*WORK_CHAIRS)]
    for counter in (b for r in stations for b in r.having("counter", "reception_desk")):
        ahead = counter.depth / 2 + 0.4
        eyes += [(counter.x + side * ahead * math.cos(counter.yaw), counter.y + side * ahead * math.sin(counter.yaw)) for side in (1, -1)]
    circulation = {r.id: r for r in world.rooms if r.circulation}
    for room in wards:
        for door in (d for d in room.doors if any(i in circulation for i in d["room_ids"])):
            a, b = door["line"]["start"], door["line"]["end"]
            hall = next(circulation[i] for i in door["room_ids"] if i in circulation)
            upright = abs(a["x"] - b["x"]) < abs(a["y"] - b["y"])
            for k in (1, 5, 9):
                x, y = a["x"] + (b["x"] - a["x"]) * k / 10, a["y"] + (b["y"] - a["y"]) * k / 10
                faces = [(x + 0.1, y), (x - 0.1, y)] if upright else [(x, y + 0.1), (x, y - 0.1)]
                if any(sees(world, eye, p) for eye in eyes for p in faces if inside(hall.corners, *p)):
                    return False
    return True


def inside(corners, x, y):
    """Whether a point is in a polygon of corners."""
    odd = False
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1], strict=True):
        if (y0 > y) != (y1 > y) and x < x0 + (y - y0) / (y1 - y0) * (x1 - x0):
            odd = not odd
    return odd


@objection("B")
def dryer_far_from_basin(world):
    """a hand dryer more than 1.6 m from every basin"""
    for room in world.rooms:
        basins = room.having("basin")
        for dryer in room.named("hand_dryer"):
            if basins and min(gap(dryer.rect, b.rect) for b in basins) > 1.6:
                return True
    return False


@objection("B", "hospital")
def basin_far_from_entrance(world):
    """the hand basin of a patient or treatment room more than 2.5 m from where one comes in"""
    halls = {r.id for r in world.rooms if r.circulation}
    for room in world.of("patient_room", "exam_room", "treatment_room", "icu_room"):
        basins = room.named(*HAND_BASINS)
        ways_in = (d["line"] for d in room.doors if halls & set(d["room_ids"]))
        lines = [outline([line["start"], line["end"]]) for line in ways_in]
        if basins and lines and min(gap(b.rect, line) for b in basins for line in lines) > 2.5:
            return True
    return False


@objection("B")
def hall_of_a_toilet(world):
    """a toilet of more than 6.5 m2 with one WC"""
    kinds = ("toilet", "restroom", "guest_toilet")
    return any(r.area > 6.5 and len(r.named(*TOILETS)) == 1 for r in world.of(*kinds))


@objection("A")
def no_pocket(world):
    """a sliding leaf with no wall to go into"""
    for door in (d for d in world.doors if d["kind"] == "sliding" and len(d["room_ids"]) == 2):
        x0, y0, x1, y1 = line_of(door)
        upright = x1 - x0 < y1 - y0
        low, high, at = (y0, y1, x0) if upright else (x0, x1, y0)
        width = door["clear_width_m"]
        start = door["line"]["start"]["y" if upright else "x"]
        ahead = start < (low + high) / 2
        before, after = {"beyond_start": (1, 0), "beyond_end": (0, 1), "apart": (0.5, 0.5), "up": (0, 0),
                         "stacked_beyond_start": (0.5, 0), "stacked_beyond_end": (0, 0.5)}[door["slide"]]  # fmt: skip
        if not ahead:
            before, after = after, before
        own = [(w[1], w[3]) if upright else (w[0], w[2]) for w in world.walls
               if (w[2] - w[0] < w[3] - w[1]) == upright and abs((w[0] if upright else w[1]) - at) < 0.001]  # fmt: skip
        for a, b in ((low - before * width, low), (high, high + after * width)):
            while a < b - 0.001:
                further = [end for begin, end in own if begin <= a + 0.001 and end > a + 0.001]
                if not further:
                    return True
                a = max(further)
    return False


@objection("A", "residential")
def no_worktop(world):
    """less than 0.3 m of worktop between sink and hob"""
    for room in world.rooms:
        for hob in room.named("hob"):
            if any(gap(hob.rect, sink.rect) < 0.28 for sink in room.named("sink_unit")):
                return True
    return False


@objection("B", "residential")
def bare_kitchen(world):
    """a kitchen of 8 m2 or more with less than 1.2 m of worktop beside sink and hob"""
    tops = ("base_cabinet", "dishwasher", "washing_machine")
    for room in world.of("kitchen"):
        hobs = room.named("hob")
        if room.area >= 8.0 and sum(b.width for b in room.having(*tops) if hobs and b.low < 0.1) < 1.18:
            return True
    return False


@objection("B", "residential")
def crowded_sitting(world):
    """a chair or table to eat at within 0.6 m of a sofa, armchair or coffee table"""
    for room in world.of("living_room", "living_kitchen", "studio", "family_room"):
        eat = [b for b in room.standing if b.object.startswith(("dining_", "breakfast_table", "stool"))]
        sit = [b for b in room.standing if "sofa" in b.object or b.object in ("armchair", "reading_chair", "coffee_table")]
        if any(gap(a.rect, b.rect) < 0.58 for a in eat for b in sit):
            return True
    return False


@objection("B", "residential")
def single_bed_under_window(world):
    """the head of a single bed under a window"""
    return any(before_window(bed, r) for r in world.rooms for bed in r.named("single_bed"))


@objection("B", "residential")
def bed_in_swing(world):
    """a bed with its pillows within 0.3 m of a leaf's swing"""
    for room in world.rooms:
        for bed in room.named("double_bed", "single_bed"):
            x0, y0, x1, y1 = bed.rect
            heads = (x0, y0, x0 + 0.6, y1), (x0, y0, x1, y0 + 0.6), (x1 - 0.6, y0, x1, y1), (x0, y1 - 0.6, x1, y1)
            head = heads[bed.quarter]
            if any(gap(head, leaf) < 0.28 for leaf in room.swings):
                return True
    return False


@objection("B", "residential")
def no_bedside_table(world):
    """a double bed without a bedside table at each side"""
    return any(len(r.named("nightstand")) < 2 for r in world.rooms if r.named("double_bed"))


@objection("B", "residential")
def no_mirror(world):
    """a basin of a bathroom without a mirror"""
    return any(not r.having("mirror") for r in world.rooms if r.named("vanity", *HAND_BASINS))


def entrance_of(world):
    """The room behind the entrance, and the middle of its door."""
    for room in world.rooms:
        for door in room.doors:
            if door["entrance"] and len(door["room_ids"]) == 1:
                return room, middle(door)
    return None, None


def middle(door):
    a, b = door["line"]["start"], door["line"]["end"]
    return (a["x"] + b["x"]) / 2, (a["y"] + b["y"]) / 2


@objection("B", "residential")
def entrance_opens_outwards(world):
    """a home's entrance that opens outwards"""
    room, _ = entrance_of(world)
    mains = [d for d in room.doors if d["entrance"]] if room else []
    return any((d.get("swing") or {"into_room_id": room.id}).get("into_room_id") is None for d in mains)


@objection("B", "residential")
def guest_toilet_far(world):
    """a guest toilet whose door is more than 8 m from the entrance"""
    _, entrance = entrance_of(world)
    doors = [middle(d) for r in world.of("toilet") for d in r.doors]
    return bool(entrance and doors) and min(abs(x - entrance[0]) + abs(y - entrance[1]) for x, y in doors) > 8.0


@objection("B", "residential")
def one_toilet_for_many(world):
    """one WC for three bedrooms or more"""
    return len(world.of("bedroom", "guest_room", "kids_room")) >= 3 and world.count({"toilet", "accessible_wc"}) < 2


@objection("B", "residential")
def machine_behind_door(world):
    """a leaf that opens within 0.05 m of a machine or basin, or a machine within 0.7 m straight behind a door"""
    for room in world.rooms:
        things = room.named("washing_machine", "dryer", "vanity", "fridge", *HAND_BASINS)
        if any(gap(t.rect, leaf) < 0.05 for t in things for leaf in room.swings):
            return True
        for door in room.doors:
            if len(door["room_ids"]) == 2 and door["kind"] != "open":
                x0, y0, x1, y1 = line_of(door)
                wide = x1 - x0 > y1 - y0
                ahead = (x0 + 0.1, y0 - 0.7, x1 - 0.1, y1 + 0.7) if wide else (x0 - 0.7, y0 + 0.1, x1 + 0.7, y1 - 0.1)
                if any(overlap(t.rect, ahead) for t in room.named("washing_machine", "dryer")):
                    return True
    return False


@objection("B")
def idle_docks(world):
    """more docks than robots"""
    return sum("dock" in b.object for r in world.rooms for b in r.bodies) > max(len(world.robots), 1)


@objection("B", "residential")
def bath_seen_from_entrance(world):
    """the door of a bathroom straight across from the entrance, or within 1.5 m of it"""
    room, entrance = entrance_of(world)
    for bath in world.of("bathroom", "accessible_bathroom", "shower_room"):
        for door in bath.doors:
            if room and room.id in door["room_ids"]:
                x, y = middle(door)
                line = line_of(door)
                main = next(d for d in room.doors if d["entrance"])
                other = line_of(main)
                upright = [r[3] - r[1] > r[2] - r[0] for r in (line, other)]
                axis = 1 if upright[0] else 0
                shared = min(line[axis + 2], other[axis + 2]) - max(line[axis], other[axis])
                if upright[0] == upright[1] and shared > 0.2 or abs(x - entrance[0]) + abs(y - entrance[1]) < 1.5:
                    return True
    return False


@objection("B", "residential")
def pinched_neck(world):
    """a way into a bedroom or living room with less than 0.88 m past a dresser, wardrobe or desk"""
    for room in world.of("bedroom", "living_room", "dining_room", "home_office", "guest_room", "single_bedroom"):
        if len(room.corners) < 5:
            continue
        for body in room.standing:
            x0, y0, x1, y1 = body.rect
            across = room.free(body.rect, body.quarter, [])
            depth = x1 - x0 if body.quarter in (EAST, WEST) else y1 - y0
            if across < 0.88 and across + depth < 1.55:
                reach = ahead_of(body, across)
                strip = (min(x0, reach[0]), min(y0, reach[1]), max(x1, reach[2]), max(y1, reach[3]))
                along = (0.0, 2.5) if body.quarter in (EAST, WEST) else (2.5, 0.0)
                strip = (strip[0] - along[0], strip[1] - along[1], strip[2] + along[0], strip[3] + along[1])
                if any(overlap(line_of(d), strip, -0.15) for d in room.doors):
                    return True
    return False


def screens(world):
    """Sofas with the screen of their room: distance of their middles ahead and aside."""
    for room in world.of("living_room", "studio", "family_room"):
        sofas = [b for b in room.standing if "sofa" in b.object]
        for screen in room.named("tv") if sofas else []:
            yield min((sofa.seen(screen.x, screen.y) for sofa in sofas), key=lambda at: abs(at[1]))


@objection("B", "residential")
def screen_far(world):
    """a television more than 4.4 m from the sofa"""
    return any(ahead > 4.4 for ahead, _ in screens(world))


@objection("B", "residential")
def screen_aside(world):
    """a television more than 0.8 m beside the axis of the sofa"""
    return any(abs(aside) > 0.8 for _, aside in screens(world))


@objection("B", "residential")
def seats_for_beds(world):
    """fewer seats at a table than people with beds, four at most"""
    seats, beds = Counter(), 0
    for room in world.rooms:
        seats.update(b.group for b in room.named("dining_chair", "stool", "bar_stool"))
        beds += 2 * len(room.named("double_bed")) + len(room.named("single_bed"))
    return max(seats.values(), default=0) < min(beds, 4)


@objection("B", "residential")
def large_bathroom(world):
    """a bathroom of more than 10.5 m2"""
    return any(r.area > 10.5 for r in world.of("bathroom", "accessible_bathroom", "ensuite"))


@objection("B", "residential")
def toilet_at_wall(world):
    """a WC whose side is less than 0.19 m from a wall"""
    for room in world.rooms:
        for wc in room.named("toilet", "accessible_wc"):
            if min(room.free(wc.rect, (wc.quarter + k) % 4, []) for k in (1, 3)) < 0.19:
                return True
    return False


@objection("B", "residential")
def living_room_far(world):
    """a living room whose door is more than 7 m from the entrance, past a bathroom or bedroom"""
    hall, entrance = entrance_of(world)
    if not entrance:
        return False

    def way(room):
        ways = (middle(d) for d in room.doors if hall.id in d["room_ids"])
        return min((abs(x - entrance[0]) + abs(y - entrance[1]) for x, y in ways), default=99.0)

    living = min(map(way, world.of("living_room", "studio")), default=0.0)
    return 7.0 < living < 99.0 and any(way(r) < living - 1.0 for r in world.of("bathroom", "bedroom", "toilet"))


@objection("B", "residential")
def table_far_from_kitchen(world):
    """a living room where one eats with its door more than 7 m from the kitchen's"""
    if world.of("dining_room"):
        return False
    doors = {r.id: [middle(d) for d in r.doors if not d["entrance"]] for r in world.rooms}
    pairs = ((k.id, v.id) for k in world.of("kitchen") for v in world.of("living_room"))
    ways = [abs(a[0] - b[0]) + abs(a[1] - b[1]) for k, v in pairs for a in doors[k] for b in doors[v]]
    return min(ways, default=0.0) > 7.0


@objection("B", "residential")
def dock_before_screen(world):
    """a dock between a sofa and its screen"""
    for room in world.of("living_room", "studio", "family_room"):
        for screen in room.named("tv"):
            for dock in room.having("dock"):
                ahead, aside = screen.seen(dock.x, dock.y)
                sofas = [screen.seen(s.x, s.y) for s in room.standing if "sofa" in s.object]
                if any(0.3 < ahead < s[0] and abs(aside) < 1.0 and abs(s[1]) < 1.0 for s in sofas):
                    return True
    return False


@objection("B", "residential")
def route_behind_chairs(world):
    """a robot's route over the floor on which a chair at a table is pushed back 0.4 m"""
    for room in world.of("living_room", "dining_room", "kitchen", "studio"):
        for chair in room.named("dining_chair"):
            pushed = beside(chair.rect, (chair.quarter + 2) % 4, 0.4)
            for robot in world.robots:
                radius = robot["robot"]["radius_m"]
                for route in robot.get("routes") or []:
                    for a, b in zip(route["path"], route["path"][1:], strict=False):
                        n = max(1, round(math.hypot(b["x"] - a["x"], b["y"] - a["y"]) / 0.1))
                        for k in range(n + 1):
                            x, y = a["x"] + (b["x"] - a["x"]) * k / n, a["y"] + (b["y"] - a["y"]) * k / n
                            if gap(pushed, (x, y, x, y)) < radius - 0.1:
                                return True
    return False


@objection("A", "residential")
def no_garden_door(world):
    """a house without a door to its garden from where one lives"""
    if world.building not in HOUSES or any(r.kind in ("terrace", "balcony") for r in world.rooms):
        return False
    lived = [r for r in world.of("living_room", "living_kitchen", "family_room", "sunroom", "dining_room", "studio") if not r.level]
    return bool(lived) and not any(len(d["room_ids"]) == 1 and not d["entrance"] for r in lived for d in r.doors)


@objection("B", "residential")
def hall_of_a_small_home(world):
    """a hall in a home of less than 40 m2"""
    return world.area < 40.0 and any(r.kind == "hallway" for r in world.rooms)


def legs(corners):
    """The two arms of an L, without the part that both share; nothing of other shapes."""
    if len(corners) != 6:
        return []
    xs, ys = ([min(c), max(c)] for c in zip(*corners, strict=True))
    # where it turns inwards, and the corner of the rectangle around it that it leaves out
    x, y = next(c for c in corners if xs[0] + GRAZE < c[0] < xs[1] - GRAZE and ys[0] + GRAZE < c[1] < ys[1] - GRAZE)
    a, b = next((u, v) for u in xs for v in ys if all(math.dist(c, (u, v)) > GRAZE for c in corners))
    other_x, other_y = sum(xs) - a, sum(ys) - b
    arms = [((x, a), (y, other_y)), ((x, other_x), (y, b))]
    return [(min(u), min(v), max(u), max(v)) for u, v in arms]


@objection("B", "residential")
def dead_neck(world):
    """a part of a bedroom or living room that is narrower than 1.9 m, longer than 1.8 m, and holds nothing"""
    for room in world.of("bedroom", "single_bedroom", "kids_room", "guest_room", "living_room", "studio"):
        for x0, y0, x1, y1 in legs(room.corners):
            narrow, long = sorted((x1 - x0, y1 - y0))
            if narrow < 1.9 and long > 1.8 and not any(overlap(b.rect, (x0, y0, x1, y1), 0.2) for b in room.standing):
                return True
    return False


@objection("B", "residential")
def no_ensuite(world):
    """two bathrooms or more, and none that is entered from a bedroom"""
    baths, beds = world.of("bathroom", "ensuite"), {r.id for r in world.of("bedroom", "single_bedroom", "kids_room", "guest_room")}
    toilets = len(baths) + len(world.of("toilet"))
    if world.building == "shared_flat" or len(baths) < 2 or len(beds) < 2 or toilets <= len({r.level for r in world.rooms}):
        return False
    return not any(beds & set(d["room_ids"]) for r in baths for d in r.doors)


@objection("A", "residential")
def water_over_beds(world):
    """a bathroom or kitchen of which more than half stands over a bedroom"""
    sleeping = world.of("bedroom", "single_bedroom", "kids_room", "guest_room")

    def shared(a, b):
        width, height = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
        return max(width, 0.0) * max(height, 0.0)

    wet = (r for r in world.rooms if r.kind in WET and len(r.corners) == 4)
    return any(shared(r.rect, s.rect) > 0.5 * r.area for r in wet for s in sleeping if s.level == r.level - 1 and len(s.corners) == 4)


@objection("B", "residential")
def windows_at_neighbors(world):
    """a flat or house in a row with windows on more than two opposite sides"""
    panes = [line_of(w) for r in world.rooms if r.kind not in ("terrace", "balcony") for w in r.windows]
    return world.building in ATTACHED and len({x1 - x0 > y1 - y0 for x0, y0, x1, y1 in panes}) > 1


@objection("B", "residential")
def motor_at_home(world):
    """a door of a home that opens by motor, gates and elevators aside"""
    rooms = (r for r in world.rooms if r.kind not in ("garage", "double_garage", "elevator"))
    return any(d.get("automatic") and len(set(d["room_ids"]) & lifts(world)) == 0 for r in rooms for d in r.doors)


def lifts(world):
    return {r.id for r in world.of("elevator")}


@objection("A", "hospital")
def visitors_at_surgery(world):
    """operating rooms of up to 25 rooms on the corridor that visitors come to"""
    surgery = ("operating_room", "operating_room_large", "operating_lobby", "scrub_room")
    visited = ("entrance_lobby", "reception", "waiting_area")
    if len(world.rooms) > 25:
        return False
    at = [{i for r in world.of(*kinds) for d in r.doors for i in d["room_ids"]} for kinds in (surgery, visited)]
    return any(r.circulation and r.id in at[0] and r.id in at[1] for r in world.rooms)


@objection("B", "residential")
def notched_between_neighbors(world):
    """a storey of a flat or house in a row that leaves more than a tenth of its plot open"""
    for level in {r.level for r in world.rooms} if world.building in ATTACHED else ():
        here = [r for r in world.rooms if r.level == level]
        x0, y0, x1, y1 = extent([corner for r in here for corner in r.outer])
        if 1.0 - sum(floor_of(r.outer) for r in here) / ((x1 - x0) * (y1 - y0)) > 0.1:
            return True
    return False


@objection("A", "residential")
def bath_behind_a_bedroom(world):
    """the only bathroom of a storey with several bedrooms entered from one of them"""
    halls = {r.id for r in world.rooms if r.circulation}
    for level in {r.level for r in world.rooms}:
        baths = [r for r in world.of("bathroom", "accessible_bathroom", "shower_room") if r.level == level]
        shared = [b for b in baths if any(halls & set(d["room_ids"]) for d in b.doors)]
        asleep = [r for r in world.of("bedroom", "single_bedroom", "kids_room") if r.level == level]
        if len(asleep) > len(baths) > 0 and not shared:
            return True
    return False


@objection("B", "hospital")
def corridor_for_no_beds(world):
    """a corridor of more than 2.3 m without a bed on wheels in the building"""
    ways = [r.rect for r in world.rooms if r.circulation and len(r.corners) == 4]
    beds = any(r.having("hospital_bed", "bariatric_bed", "stretcher", "operating_table") for r in world.rooms)
    return not beds and any(min(x1 - x0, y1 - y0) > 2.3 for x0, y0, x1, y1 in ways)


@objection("B", "hospital")
def dark_room(world):
    """a room with no lamp at its ceiling"""
    return any(not any(b.mount == "ceiling" and ("lamp" in b.object or "light" in b.object) for b in r.bodies) for r in world.rooms)


def working(room):
    """Chairs at the desks of a room."""
    desks = room.named(*DESKS)
    return [c for c in room.named(*WORK_CHAIRS) if any(gap(c.rect, d.rect) < 0.3 for d in desks)]


@objection("B", "office")
def parallel_screen(world):
    """a window before or behind a screen of a room for several"""
    for room in world.of("open_office", "team_office", "shared_office", "coworking_space"):
        for chair in working(room):
            for window in room.windows:
                a, b = window["line"]["start"], window["line"]["end"]
                for k in range(11):
                    ahead, left = chair.seen(*(a[c] + (b[c] - a[c]) * k / 10 for c in ("x", "y")))
                    if abs(left) < 0.5 and abs(ahead) < 3.5:
                        return True
    return False


@objection("B", "office")
def printer_at_chair(world):
    """a printer within 1.15 m of a chair at a desk"""
    pairs = ((p, c) for r in world.of("open_office") for p in r.named("printer") for c in working(r))
    return any(gap(p.rect, c.rect) < 1.15 for p, c in pairs)


@objection("B", "office")
def empty_office(world):
    """more than 13 m2 of an open office for each desk"""
    return any(r.area > 13.0 * max(len(r.named(*DESKS)), 1) for r in world.of("open_office"))


@objection("B", "office")
def one_seat(world):
    """a reception with one seat for visitors"""
    seats = [[3 if "sofa" in b.object else 1 for b in r.named(*VISITOR_SEATS)] for r in world.of("reception")]
    return any(sum(room) < 2 for room in seats)


@objection("B", "office")
def stop_at_chair(world):
    """a robot that stops within 0.2 m of a chair at a desk"""
    radius = max((r["robot"]["radius_m"] for r in world.robots), default=0.0)
    for stop in world.stops if world.robots else []:
        room = next(r for r in world.rooms if r.id == stop["room_id"])
        spot = (stop["pose"]["x"], stop["pose"]["y"]) * 2
        if any(gap(spot, c.rect) < radius + 0.2 for c in working(room)):
            return True
    return False


@objection("B")
def goods_on_route(world):
    """a staging area that a robot drives over"""
    for _, floor in world.staged:
        for robot in world.robots:
            radius = robot["robot"]["radius_m"]
            for route in robot.get("routes", []):
                path = [(p["x"], p["y"]) for p in route["path"]]
                for a, b in zip(path, path[1:], strict=False):
                    steps = max(1, int(math.dist(a, b) / 0.05))
                    spots = ((a[0] + (b[0] - a[0]) * k / steps, a[1] + (b[1] - a[1]) * k / steps) for k in range(steps + 1))
                    if any(gap(spot * 2, floor) < radius - 0.01 for spot in spots):
                        return True
    return False


def reached(room, taken, width, goals):
    """Which of the goals (outlines) one comes near to from the doors, on a way of this width past what is taken."""
    cell, half = 0.05, width / 2
    x0, y0, x1, y1 = room.rect
    columns, rows = int((x1 - x0) / cell) + 1, int((y1 - y0) / cell) + 1
    free = [[True] * columns for _ in range(rows)]

    def close(rect, grown):
        i0, i1 = (rect[0] - grown - x0) / cell - 0.5, (rect[2] + grown - x0) / cell - 0.5
        j0, j1 = (rect[1] - grown - y0) / cell - 0.5, (rect[3] + grown - y0) / cell - 0.5
        for j in range(max(math.floor(j0) + 1, 0), min(math.ceil(j1), rows)):
            beyond = max(rect[1] - (y0 + (j + 0.5) * cell), y0 + (j + 0.5) * cell - rect[3], 0.0)
            less = (grown - math.sqrt(max(grown**2 - beyond**2, 0.0))) / cell
            for i in range(max(math.floor(i0 + less) + 1, 0), min(math.ceil(i1 - less), columns)):
                free[j][i] = False

    walls = [(*a, *b) for a, b in zip(room.corners, room.corners[1:] + room.corners[:1], strict=True)]
    for a0, b0, a1, b1 in walls:
        close((min(a0, a1), min(b0, b1), max(a0, a1), max(b0, b1)), half)
    for rect in taken:
        close(rect, half)
    doors = [line_of(d) for d in room.doors]
    inside = [(i, j) for j in range(rows) for i in range(columns) if free[j][i]]

    def near(cells, rect, far):
        at = [(x0 + (i + 0.5) * cell, y0 + (j + 0.5) * cell) for i, j in cells]
        return [c for c, spot in zip(cells, at, strict=True) if gap(spot * 2, rect) < far]

    edge = [c for door in doors for c in near(inside, door, half + 0.35)]
    seen = set(edge)
    while edge:
        i, j = edge.pop()
        for k in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if 0 <= k[0] < columns and 0 <= k[1] < rows and k not in seen and free[k[1]][k[0]]:
                seen.add(k)
                edge.append(k)
    known = list(seen)
    return [bool(near(known, goal, 0.85)) for goal in goals]


@objection("A", "office")
def pinched(world):
    """less than 0.85 m on the way to four or more desks, past furniture, charging robots and goods"""
    for room in world.of("open_office", "team_office", "coworking_space"):
        chairs = working(room)
        if len(chairs) < 4:
            continue
        starts = [(r["start"]["x"], r["start"]["y"], 0.9 * r["robot"]["radius_m"]) for r in world.robots]
        parked = [(x - r, y - r, x + r, y + r) for x, y, r in starts]
        taken = outlines(room.standing) + parked + [floor for id_, floor in world.staged if id_ == room.id]
        if reached(room, taken, 0.85, outlines(chairs)).count(False) >= 4:
            return True
    return False


def blocks(corners):
    """A rectilinear outline as rectangles between its corners' lines."""
    (xs, ys), edges = map(sorted, map(set, zip(*corners, strict=True))), list(zip(corners, corners[1:] + corners[:1], strict=True))

    def inside(x, y):
        return sum((a[1] > y) != (b[1] > y) and a[0] > x for a, b in edges) % 2 == 1

    cells = [(x0, y0, x1, y1) for x0, x1 in zip(xs, xs[1:], strict=False) for y0, y1 in zip(ys, ys[1:], strict=False)]
    return [c for c in cells if inside((c[0] + c[2]) / 2, (c[1] + c[3]) / 2)]


def common(first, second):
    """The floor that two lists of rectangles share, m2."""
    pairs = ((min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])) for a in first for b in second)
    return sum(w * h for w, h in pairs if w > 0 and h > 0)


@objection("A")
def in_the_air(world):
    """more than a tenth of a storey with nothing of the storey below under it"""
    levels = sorted({r.level for r in world.rooms if r.level >= 0})
    floors = {level: [b for r in world.rooms if r.level == level for b in blocks(r.outer)] for level in levels}
    areas = {level: sum((x1 - x0) * (y1 - y0) for x0, y0, x1, y1 in floor) for level, floor in floors.items()}
    pairs = zip(levels, levels[1:], strict=False)
    return any(common(floors[upper], floors[lower]) < 0.9 * areas[upper] for lower, upper in pairs)


@objection("A")
def idle_storey(world):
    """a storey with nothing but stairs, corridors, toilets and bathrooms"""
    levels = {r.level for r in world.rooms}
    used = {r.level for r in world.rooms if not r.circulation and r.kind not in WET | {"restroom", "accessible_toilet", "shower_room"}}
    return len(levels) > 1 and bool(levels - used)


# what people look at, rooms where the public is served, and doors that goods come through
SHOWN = {"cinema_screen", "presiding_table", "stage_platform", "theatre_stage"}
PUBLIC = {"auditorium", "boutique", "cafe", "check_in_hall", "courtroom", "dining_room", "exhibition_room", "gym_floor", "library", "mall_street",
          "nave", "parking_hall", "pool_hall", "prayer_hall", "sales_floor", "theatre_hall", "ticket_hall", "visa_section"}  # fmt: skip
DOCKS = {"loading_dock"}


@objection("A")
def fewer_places(world):
    """fewer seats, desks, bays or stalls in a room than were asked for"""
    return any(note["code"] == "too_few_places" for note in world.notes)


@objection("A")
def tills_anywhere(world):
    """tills of a sales floor that stand in no line, or behind half of its shelves seen from the entrance"""
    entrance = next((d for d in world.doors if d["entrance"]), None)
    for room in world.of("sales_floor", "store_floor"):
        tills, shelves = room.named("checkout_counter"), room.named("gondola_shelf")
        if len(tills) < 2 or entrance is None:
            continue
        (x0, y0), (x1, y1) = ((entrance["line"][end]["x"], entrance["line"][end]["y"]) for end in ("start", "end"))
        away = (lambda b: abs(b.x - x0)) if abs(x1 - x0) < abs(y1 - y0) else (lambda b: abs(b.y - y0))
        far = max(map(away, tills))
        if far - min(map(away, tills)) > 0.3 or 2 * sum(away(s) < far for s in shelves) > len(shelves):
            return True
    return False


@objection("A")
def screen_at_door(world):
    """a screen or stage before rows of seats with a door of the room nearer to it than the middle of the seats"""
    for room in world.of("auditorium", "theatre_hall", "lecture_hall", "event_room", "council_chamber"):
        shown, seats = room.named(*SHOWN), room.having("seats", "chair_row", "council_desk")
        if not shown or len(seats) < 4:
            continue
        x, y = (sum(getattr(b, axis) for b in seats) / len(seats) for axis in "xy")
        ahead = shown[0].seen(x, y)[0]
        if any(shown[0].seen(*middle(d))[0] < 0.25 * ahead for d in room.doors):
            return True
    return False


@objection("A")
def docks_around(world):
    """loading docks with gates on more than one side of the building"""
    gates = [d for room in world.of(*DOCKS) for d in room.doors if len(d["room_ids"]) == 1 and d["clear_width_m"] > 2.0]
    sides = {(upright := abs(line[2] - line[0]) < GRAZE, round(line[0] if upright else line[1], 1)) for line in map(line_of, gates)}
    return len(sides) > 1


@objection("A")
def no_accessible_toilet(world):
    """a building where the public is served without a toilet for wheelchairs"""
    served = world.of(*PUBLIC)
    return sum(r.area for r in served) > 60 and not any(r.named("accessible_wc") for r in world.rooms)


def page():
    """The objections as tables of a page, by what they are looked for in."""
    titles = {None: "Every building", "residential": "Homes", "office": "Offices", "hospital": "Wards"}
    out = []
    for domain in sorted({where for _, where, _, _ in OBJECTIONS}, key=list(titles).index):
        rows = sorted((weight, text) for weight, where, text, _ in OBJECTIONS if where == domain)
        out += [f"### {titles[domain]}", "", "| weight | objection |", "|---|---|"]
        out += [f"| {weight} | {text} |" for weight, text in rows] + [""]
    return "\n".join(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="?", help="worlds, at any depth")
    parser.add_argument("--page", nargs="?", const=True, metavar="FILE", help="print the objections, or look for them in a page")
    parser.add_argument("--list", action="store_true", help="name the plans of each objection")
    options = parser.parse_args()
    if options.page is True:
        print(page(), end="")
        return 0
    if options.page:
        fresh = page() in Path(options.page).read_text()
        print(f"{options.page} {'has' if fresh else 'lacks'} the {len(OBJECTIONS)} objections of this program")
        return int(not fresh)
    if options.folder is None:
        parser.error("name a folder of worlds")
    folders = sorted(path.parent for path in options.folder.rglob("floorplan.json"))
    if not folders:
        print(f"{options.folder}: no world below it; make some with `d3dgen bench paper --out DIR`", file=sys.stderr)
        return 2
    raised, plans, back, clean = defaultdict(list), Counter(), Counter(), Counter()
    for folder in folders:
        name = folder.relative_to(options.folder)
        world = World(folder)
        domain = world.domain
        mine = [(w, text) for w, where, text, holds in OBJECTIONS if where in (None, domain) and holds(world)]
        for entry in mine:
            raised[entry].append(str(name))
        plans[domain] += 1
        clean[domain] += not mine
        back[domain] += any(w == "A" for w, _ in mine) or len(mine) >= 3
    print(f"{'domain':12} {'plans':>6} {'no objection':>13} {'sent back':>10}")
    for domain, count in sorted(plans.items()):
        print(f"{domain:12} {count:6} {clean[domain]:13} {back[domain]:10}")
    print(f"\n{len(OBJECTIONS)} objections looked for; raised:")
    for (weight, text), names in sorted(raised.items(), key=lambda item: (item[0][0], -len(item[1]))):
        print(f"{weight} {len(names):4}  {text}")
        if options.list:
            print("         " + " ".join(names))
    print(f"{back.total()} of {plans.total()} plans sent back")
    # one in ten is the goal; whoever adds an objection to the list sends more plans back
    return int(MOST_BACK * back.total() >= plans.total())


if __name__ == "__main__":
    sys.exit(main())
