"""The neutral form in which the worlds of all generators are measured, and the measures: one code for all, in exact geometry.

A house has rooms as polygons with a kind, openings as segments between rooms, and objects as oriented boxes. Lengths in metres, angles in
radians counterclockwise, z up. Robots are discs; doors stand open and their leaves are in nobody's way.
"""
import dataclasses
import math

from shapely import STRtree
from shapely.affinity import rotate, translate
from shapely.geometry import LineString, Polygon, box
from shapely.ops import unary_union

PRIVATE = ("bed", "bath", "toilet", "shower")
"""A room whose kind has one of these in it is a bedroom or bathroom."""
ROBOT_RADIUS_M = 0.2
ROBOT_HEIGHT_M = 1.0
"""What begins above it does not hinder the robot."""
DOOR_HEIGHT_M = 2.0
"""What begins above it is in no one's way at a door."""
STEPPED_OVER_M = 0.03
"""Rugs and mats up to this height hinder nobody, and what stands on them does not go into them."""
TOUCHING_M = 0.01
"""Boxes that go into each other by less than this, in each direction, only touch; so do a box and what must stay free."""
OUTSIDE_SHARE = 0.01
"""A box is outside when more than this share of its footprint is not over the floor of any room (SceneEval's 99 %)."""
WALL_M = 0.005
"""Half the thickness of the walls of houses that have walls without thickness: rooms do not flow into each other there."""


@dataclasses.dataclass
class Room:
    room_id: str
    kind: str
    polygon: list
    circulation: bool = False
    """Whether it was added to connect the rooms that were asked for."""

    @property
    def private(self):
        return any(word in self.kind.lower() for word in PRIVATE)


@dataclasses.dataclass
class Opening:
    room_ids: list
    """One room, if it leads out of the house, or two."""
    segment: list
    """Its two ends on the middle of the wall, as far apart as it is clear."""
    wall_m: float = 0.0
    door: bool = True
    """Not a whole side of a room left open."""


@dataclasses.dataclass
class Object:
    object_id: str
    kind: str
    center: list
    size: list
    """Width, depth and height."""
    yaw: float
    z: float
    """Height of its lowest point over the floor."""
    support: str | None = None
    """The object that it stands on or in."""

    @property
    def footprint(self):
        width, depth, _ = self.size
        return translate(rotate(box(-width / 2, -depth / 2, width / 2, depth / 2), self.yaw, origin=(0, 0), use_radians=True), *self.center)

    @property
    def top(self):
        return self.z + self.size[2]

    def hinders_below(self, height_m):
        return self.top > STEPPED_OVER_M and self.z < height_m


@dataclasses.dataclass
class House:
    generator: str
    asked: int
    seed: int
    cpu_s: float
    rooms: list
    openings: list
    objects: list | None
    """None, if the generator makes plans only."""


def from_json(document):
    """Returns the house that a peer's own Python printed."""
    parts = dict(document)
    parts["rooms"] = [Room(**room) for room in document["rooms"]]
    parts["openings"] = [Opening(**opening) for opening in document["openings"]]
    parts["objects"] = None if document["objects"] is None else [Object(**thing) for thing in document["objects"]]
    return House(**parts)


def measure(house):
    """Returns all measures of a house; those of objects are None where there are none to measure."""
    asked_for = [room for room in house.rooms if not room.circulation]
    measures = {
        "cpu_s": house.cpu_s,
        "rooms": len(asked_for),
        "circulation": len(house.rooms) - len(asked_for),
        "net_m2": sum(Polygon(room.polygon).area for room in house.rooms),
        "behind_private": share(len(behind_private(house)), len(house.rooms)),
        "doors": sum(opening.door for opening in house.openings),
    }
    furnished = {"objects": None, "objects_a_room": None, "door_sides_blocked": None, "overlapping": None, "outside": None, "reachable": None}
    if house.objects is not None:
        sides = door_sides(house)
        furnished = {
            "objects": len(house.objects),
            "objects_a_room": len(house.objects) / len(house.rooms),
            "door_sides_blocked": share(sum(is_blocked(side, house.objects) for side in sides), len(sides)),
            "overlapping": share(len(overlapping(house.objects)), len(house.objects)),
            "outside": share(len(outside(house)), len(house.objects)),
            "reachable": reachable(house),
        }
    return measures | furnished


def share(part, whole):
    return part / whole if whole else 0.0


def behind_private(house):
    """Returns the rooms that nobody gets to from the entrance except through a bedroom or bathroom."""
    private = {room.room_id for room in house.rooms if room.private}
    entered = {room_id for opening in house.openings if len(opening.room_ids) == 1 for room_id in opening.room_ids}
    neighbours = {room.room_id: set() for room in house.rooms}
    for opening in house.openings:
        for a in opening.room_ids:
            neighbours[a].update(b for b in opening.room_ids if b != a)
    reached, todo = set(entered), list(entered - private)
    while todo:
        for room_id in neighbours[todo.pop()] - reached:
            reached.add(room_id)
            if room_id not in private:
                todo.append(room_id)
    return [room for room in house.rooms if room.room_id not in reached]


def door_sides(house):
    """Returns what must stay free on each side of each door that lies in a room: a square as wide as the door, from the wall's face."""
    floors = {room.room_id: Polygon(room.polygon) for room in house.rooms}
    sides = []
    for opening in (opening for opening in house.openings if opening.door):
        for sign in (1, -1):
            side = strip(opening, sign * opening.wall_m / 2, sign * (opening.wall_m / 2 + width(opening)))
            owner = max((floors[room_id] for room_id in opening.room_ids), key=lambda floor: floor.intersection(side).area)
            if owner.intersection(side).area > side.area / 4:
                sides.append(side)
    return sides


def width(opening):
    return math.dist(*opening.segment)


def strip(opening, near, far):
    """Returns the rectangle along an opening between two distances from the middle of its wall."""
    (ax, ay), (bx, by) = opening.segment
    nx, ny = -(by - ay) / width(opening), (bx - ax) / width(opening)
    return Polygon([(ax + nx * near, ay + ny * near), (bx + nx * near, by + ny * near), (bx + nx * far, by + ny * far), (ax + nx * far, ay + ny * far)])


def is_blocked(side, objects):
    free = side.buffer(-TOUCHING_M)
    return any(thing.hinders_below(DOOR_HEIGHT_M) and thing.footprint.intersects(free) for thing in objects)


def overlapping(objects):
    """Returns the objects whose box goes into that of another one which it neither carries nor stands on."""
    shrunk = [thing.footprint.buffer(-TOUCHING_M / 2, join_style="mitre") for thing in objects]
    found = set()
    for i, j in STRtree(shrunk).query(shrunk, predicate="intersects").T:
        a, b = objects[i], objects[j]
        apart = min(a.top, b.top) - max(a.z, b.z) <= STEPPED_OVER_M
        if i != j and not apart and a.support != b.object_id and b.support != a.object_id and min(shrunk[i].area, shrunk[j].area) > 0:
            found.update((int(i), int(j)))
    return sorted(found)


def outside(house):
    """Returns the objects that do not lie over the floor of rooms."""
    floor = unary_union([Polygon(room.polygon).buffer(0) for room in house.rooms])
    footprints = [thing.footprint for thing in house.objects]
    return [spot for spot in footprints if spot.difference(floor).area > OUTSIDE_SHARE * spot.area]


def reachable(house):
    """Returns the largest share of the free floor of the whole house in which a robot gets from everywhere to everywhere."""
    rooms = [Polygon(room.polygon).buffer(-WALL_M, join_style="mitre") for room in house.rooms]
    ways = [strip(opening, -opening.wall_m / 2 - 4 * WALL_M, opening.wall_m / 2 + 4 * WALL_M) for opening in house.openings if len(opening.room_ids) == 2]
    hindering = [thing.footprint for thing in house.objects if thing.hinders_below(ROBOT_HEIGHT_M)]
    free = unary_union(rooms + ways).difference(unary_union(hindering)).buffer(-ROBOT_RADIUS_M)
    pieces = [piece.area for piece in getattr(free, "geoms", [free])]
    return max(pieces, default=0.0) / sum(pieces) if sum(pieces) else 0.0


def self_test():
    """Measures a house made by hand: one door side blocked, one overlap, one box outside, one room behind a bedroom, one cut off."""
    house = House(
        generator="by hand", asked=4, seed=0, cpu_s=0.0,
        rooms=[
            Room("hall", "hallway", [(0, 0), (6, 0), (6, 2), (0, 2)], circulation=True),
            Room("bed", "bedroom", [(0, 2.1), (3, 2.1), (3, 5), (0, 5)]),
            Room("study", "study", [(0, 5.1), (3, 5.1), (3, 8), (0, 8)]),
            Room("bath", "bathroom", [(3.1, 2.1), (6, 2.1), (6, 5), (3.1, 5)]),
        ],
        openings=[
            Opening(["hall"], [(0, 0.5), (0, 1.4)], 0.2),
            Opening(["hall", "bed"], [(1, 2.05), (1.9, 2.05)], 0.1),
            Opening(["bed", "study"], [(1, 5.05), (1.9, 5.05)], 0.1),
            Opening(["hall", "bath"], [(4, 2.05), (4.9, 2.05)], 0.1),
        ],
        objects=[
            Object("wardrobe", "wardrobe", [1.5, 2.6], [2.0, 0.6, 2.2], 0.0, 0.0),  # at the door of the bedroom: nobody gets in
            Object("rug", "rug", [4.5, 1.5], [0.8, 0.8, 0.01], 0.0, 0.0),  # at the door of the bathroom, stepped over
            Object("lamp", "lamp", [4.5, 3.0], [0.5, 0.5, 0.2], 0.0, 2.3),  # over it
            Object("table", "table", [2.4, 7.4], [1.0, 1.0, 0.8], 0.0, 0.0),
            Object("vase", "vase", [2.4, 7.4], [0.2, 0.2, 0.3], 0.0, 0.75, support="table"),
            Object("chair", "chair", [2.4, 6.8], [0.5, 0.5, 0.9], math.pi / 4, 0.0),  # a corner of it under the table
            Object("stool", "stool", [6.1, 4.6], [0.4, 0.4, 0.4], 0.0, 0.0),  # half in the wall
            Object("box", "box", [5.75, 4.28], [0.3, 0.23, 0.2], 0.0, 0.0),  # beside it, touching
        ],
    )
    found = measure(house)
    sides = door_sides(house)
    expected = {"rooms": 3, "circulation": 1, "doors": 4, "behind_private": 1 / 4, "objects": 8, "objects_a_room": 2.0,
                "door_sides_blocked": 1 / 7, "overlapping": 2 / 8, "outside": 1 / 8}
    wrong = {name: (found[name], value) for name, value in expected.items() if not math.isclose(found[name], value)}
    assert not wrong, wrong
    assert len(sides) == 7, len(sides)
    assert math.isclose(found["net_m2"], 12 + 3 * 2.9 * 2 + 2.9 * 2.9, rel_tol=1e-9), found["net_m2"]
    assert 0.4 < found["reachable"] < 0.9, found["reachable"]
    house.objects = house.objects[1:3]
    assert measure(house)["reachable"] > 0.999, "an empty house is one piece"
    house.openings.pop()
    assert measure(house)["reachable"] < 0.9 and len(behind_private(house)) == 2, "walls without a door part the floor"
