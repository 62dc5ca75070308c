"""Worlds as Python objects, read from the documents that the command writes."""

from __future__ import annotations

import json
import math
import shutil
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterable

from ._command import run

if TYPE_CHECKING:
    import numpy

Json = dict[str, Any]
Point = tuple[float, float]


@dataclass(frozen=True)
class Object:
    """A thing that stands in a room."""

    id: str
    object: str
    """Type of the object in the catalog of its domain."""
    asset: str
    """Model, `Domain/Name`."""
    room_id: str
    x: float
    """Center of the footprint, m."""
    y: float
    z: float
    """Height of the underside, m."""
    yaw: float
    """Heading of the front, rad, counter-clockwise from east."""
    size_m: tuple[float, float, float]
    """Width across the front, depth, height, m."""

    @property
    def footprint(self) -> list[Point]:
        """Corners of the footprint, m, counter-clockwise.

        The front looks along the heading: depth lies along it, width across.
        """
        width, depth, _ = self.size_m
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        corners = [(depth / 2, -width / 2), (depth / 2, width / 2), (-depth / 2, width / 2), (-depth / 2, -width / 2)]
        return [(self.x + u * cos - v * sin, self.y + u * sin + v * cos) for u, v in corners]


@dataclass(frozen=True)
class Door:
    """A door or an opening; `room_ids` has one room for a door to the outside."""

    id: str
    kind: str
    start: Point
    """Ends of the opening on the center line of the wall, m."""
    end: Point
    clear_width_m: float
    height_m: float
    room_ids: tuple[str, ...]
    entrance: bool


@dataclass(frozen=True)
class Room:
    """A room with what stands in it."""

    id: str
    room_type: str
    name: str
    level: int
    """Storey, 0 at the ground."""
    area_m2: float
    """Floor between the wall faces."""
    polygon: tuple[Point, ...]
    """Outline on the wall faces, m, counter-clockwise."""
    circulation: bool
    objects: tuple[Object, ...] = field(repr=False, default=())


@dataclass(frozen=True)
class Report:
    """The verdict: hard rules, building rules with their sources, and what became of every wish."""

    sound: bool
    rules: list[Json] = field(repr=False)
    constraints: list[Json] = field(repr=False)
    asks: list[Json] = field(repr=False)
    document: Json = field(repr=False)

    @classmethod
    def of(cls, document: Json) -> Report:
        """Returns the report in a document (schemas/report.schema.json)."""
        lists = [document.get(name, []) for name in ("rules", "constraints", "asks")]
        return cls(document["sound"], *lists, document)

    @property
    def violated(self) -> list[Json]:
        """Building rules that the world breaks, each with figure, limit and citation."""
        return [c for c in self.constraints if c["status"] == "violated"]

    @property
    def unmet(self) -> list[Json]:
        """Wishes that are not met as they were said, each with the reason."""
        return [a for a in self.asks if a["fate"] != "honored"]


class World:
    """A finished world, over the folder that it was written into."""

    def __init__(self, folder: str | Path, *, _kept: tempfile.TemporaryDirectory | None = None) -> None:
        self.folder = Path(folder)
        self._kept = _kept  # deleted with the world unless it was saved elsewhere
        self.document: Json = json.loads((self.folder / "world.json").read_text(encoding="utf-8"))
        self.report = Report.of(json.loads((self.folder / "report.json").read_text(encoding="utf-8")))

    def __repr__(self) -> str:
        return f"World({self.name!r}, {len(self.rooms)} rooms, {len(self.objects)} objects, sound={self.sound})"

    def _repr_svg_(self) -> str:
        """The plan, for notebooks."""
        return self.plan_svg()

    @property
    def name(self) -> str:
        """Name of the world."""
        return self.document["name"]

    @property
    def sound(self) -> bool:
        """True when every hard rule holds."""
        return self.report.sound

    @property
    def prompt(self) -> str:
        """The sentence that it was made of."""
        return self.document["scene_graph"]["prompt"]

    @property
    def objects(self) -> list[Object]:
        """Everything that stands somewhere."""
        return [_object(p) for p in self.document["placements"]["placements"]]

    @property
    def rooms(self) -> list[Room]:
        """The rooms with what stands in them."""
        inside: dict[str, list[Object]] = {}
        for thing in self.objects:
            inside.setdefault(thing.room_id, []).append(thing)
        return [_room(r, inside.get(r["room_id"], [])) for r in self.document["floorplan"]["rooms"]]

    @property
    def doors(self) -> list[Door]:
        """Doors and openings."""
        return [_door(d) for d in self.document["floorplan"]["doors"]]

    @property
    def area_m2(self) -> float:
        """Floor between the wall faces of all rooms."""
        return sum(r["net_area_m2"] for r in self.document["floorplan"]["rooms"])

    def plan_svg(self) -> str:
        """Returns the plan as SVG, drawn when it is not there."""
        path = self.folder / "plan.svg"
        if not path.is_file():
            run("export", str(self.folder), "--format", "plan", "--no-png")
        return path.read_text(encoding="utf-8")

    def occupancy(self, level: int = 0) -> tuple[numpy.ndarray, float, Point]:
        """Returns the floor of a storey as a grid, with its cell size in m and the position of its first cell's corner in m.

        Values are those of ROS: 0 free, 100 occupied, -1 unknown; rows go north. Needs `d3dgen[numpy]`.
        """
        import numpy
        import yaml
        from PIL import Image

        found = sorted(self.folder.glob(f"arena/worlds/*/{level}/map.yaml"))
        if not found:
            run("export", str(self.folder), "--format", "arena")
            found = sorted(self.folder.glob(f"arena/worlds/*/{level}/map.yaml"))
        if not found:
            raise ValueError(f"world {self.name} has no storey {level}")
        settings = yaml.safe_load(found[0].read_text(encoding="utf-8"))
        gray = numpy.asarray(Image.open(found[0].parent / settings["image"]).convert("L"), dtype=float)[::-1]
        dark = 1.0 - gray / 255.0
        grid = numpy.full(gray.shape, -1, dtype=numpy.int8)
        grid[dark > settings["occupied_thresh"]] = 100
        grid[dark < settings["free_thresh"]] = 0
        return grid, settings["resolution"], tuple(settings["origin"][:2])

    def polygons(self) -> dict[str, numpy.ndarray]:
        """Returns the outline of each room on its wall faces as an array of n x 2 in m. Needs numpy."""
        import numpy

        return {r.id: numpy.array(r.polygon) for r in self.rooms}

    def export(self, *formats: str) -> Path:
        """Writes the world in further formats (`d3dgen version` lists them) into its folder, and returns that."""
        run("export", str(self.folder), "--format", ",".join(formats))
        return self.folder

    def to_mujoco(self) -> Path:
        """Returns the path of the world for MuJoCo, written when it is not there."""
        return self._exported("mujoco", "mujoco/world.xml")

    def to_usd(self) -> Path:
        """Returns the path of the world for Isaac Sim and other USD programs, written when it is not there."""
        return self._exported("usd", "usd/world.usda")

    def to_gazebo(self) -> Path:
        """Returns the path of the world for Gazebo, written when it is not there."""
        return self._exported("gazebo", "gazebo/world.sdf")

    def edit(self, *changes: str) -> World:
        """Returns the world with changes in words: `world.edit("move_wall wall_7 0.4", "remove_object bed_1")`.

        `d3dgen edit --help` lists them. Raises Refused for a change that cannot be made.
        """
        kept = _folder()
        flags = [flag for change in changes for flag in ("--do", change)]
        run("edit", str(self.folder), *flags, "--out", kept.name, "--no-png")
        return World(kept.name, _kept=kept)

    def save(self, folder: str | Path) -> World:
        """Copies the world into a folder, which must not exist, and returns the world there."""
        shutil.copytree(self.folder, folder)
        return World(folder)

    def _exported(self, format: str, path: str) -> Path:
        if not (self.folder / path).is_file():
            self.export(format)
        return self.folder / path


def generate(
    prompt: str,
    *,
    seed: int = 0,
    domain: str | None = None,
    country: str | None = None,
    rooms: int | None = None,
    area_m2: float | None = None,
    formats: Iterable[str] = ("plan",),
    out: str | Path | None = None,
    allow_conflicts: bool = False,
) -> World:
    """Returns a checked world of a sentence.

    It is kept in `out` (a new or empty folder, or an earlier world, which is replaced), or in a temporary folder that goes
    with the object. Raises Refused when the sentence cannot be met, Unsound when what came of it breaks a hard rule.
    """
    kept = _folder() if out is None else None
    target = kept.name if kept else str(out)
    flags = ["--seed", str(seed), "--format", ",".join(formats), "--no-png", "--out", target]
    for name, value in [("domain", domain), ("country", country), ("rooms", rooms), ("area", area_m2)]:
        flags += [f"--{name}", str(value)] if value is not None else []
    flags += ["--allow-conflicts"] if allow_conflicts else []
    run("generate", *flags, "--", prompt)
    return World(target, _kept=kept)


def load(folder: str | Path) -> World:
    """Returns a world that was written earlier. Raises FileNotFoundError where there is none."""
    return World(folder)


def brief(prompt: str) -> Json:
    """Returns what a sentence is understood as (schemas/brief.schema.json): its asks, and the words nobody understood."""
    return json.loads(run("brief", "--json", "--", prompt))


def check(folder: str | Path) -> Report:
    """Returns the verdict on a world's folder, judged anew."""
    return Report.of(json.loads(run("check", "--json", str(folder))))


def _folder() -> tempfile.TemporaryDirectory:
    return tempfile.TemporaryDirectory(prefix="d3dgen-")


def _object(p: Json) -> Object:
    pose = p["pose"]
    return Object(
        p["placement_id"], p["object"], p["asset"], p["room_id"], pose["x"], pose["y"], pose["z"], pose["yaw_rad"], tuple(p["size_m"])
    )


def _room(r: Json, objects: list[Object]) -> Room:
    polygon = tuple((p["x"], p["y"]) for p in r["net_polygon"])
    head = (r["room_id"], r["room_type"], r["name"], r.get("level", 0), r["net_area_m2"])
    return Room(*head, polygon, r["circulation"], tuple(objects))


def _door(d: Json) -> Door:
    start, end = ((d["line"][at]["x"], d["line"][at]["y"]) for at in ("start", "end"))
    return Door(d["door_id"], d["kind"], start, end, d["clear_width_m"], d["height_m"], tuple(d["room_ids"]), d["entrance"])
