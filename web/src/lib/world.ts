/** Questions about a world, and worlds with one thing changed; a world itself is never changed. */
import type { Door, PlanRoom, Segment, Wall, Window } from "../gen/d3dgen/v1/floorplan_pb";
import type { Placement } from "../gen/d3dgen/v1/placements_pb";
import type { Violation } from "../gen/d3dgen/v1/report_pb";
import type { World } from "../gen/d3dgen/v1/world_pb";
import { names } from "./names.svelte";
import { figure, t, unitSaid } from "./texts.svelte";
import { corners, ends, footprint, inside, type P, tidy } from "./geometry";

/** What lies on one storey. */
export interface Storey {
  rooms: PlanRoom[];
  walls: Wall[];
  doors: Door[];
  windows: Window[];
  objects: Placement[];
}

export function levelsOf(world: World | undefined): number[] {
  const found = new Set((world?.floorplan?.rooms ?? []).map((r) => r.level));
  return [...found].sort((a, b) => a - b);
}

export function storeyOf(world: World | undefined, level: number): Storey {
  const plan = world?.floorplan;
  const rooms = (plan?.rooms ?? []).filter((r) => r.level === level);
  const ids = new Set(rooms.map((r) => r.roomId));
  const here = (roomIds: string[]) => roomIds.some((id) => ids.has(id));
  return {
    rooms,
    walls: (plan?.walls ?? []).filter((w) => here(w.roomIds)),
    doors: (plan?.doors ?? []).filter((d) => here(d.roomIds)),
    windows: (plan?.windows ?? []).filter((w) => ids.has(w.roomId)),
    objects: (world?.placements?.placements ?? []).filter((p) => ids.has(p.roomId)),
  };
}

export function objectOf(world: World | undefined, id: string): Placement | undefined {
  return world?.placements?.placements.find((p) => p.placementId === id);
}

export function roomOf(world: World | undefined, id: string): PlanRoom | undefined {
  return world?.floorplan?.rooms.find((r) => r.roomId === id);
}

/** Returns the name of a thing as people read it: an object's with that of its room. */
export function nameOf(world: World | undefined, id: string): string {
  const room = roomOf(world, id);
  if (room) return names.room(room);
  const object = objectOf(world, id);
  return object ? `${names.of(object.objectId)}, ${nameOf(world, object.roomId)}` : names.one(id);
}

/** Returns the room at a point of a storey. */
export function roomAt(world: World | undefined, level: number, p: P): PlanRoom | undefined {
  return storeyOf(world, level).rooms.find((r) => inside(corners(r.polygon), p));
}

/** Returns where a thing lies, whatever it is; nothing for the building as a whole. */
export function placeOf(world: World, id: string): { at: P; level: number } | undefined {
  const plan = world.floorplan;
  const levelOf = (roomIds: string[]) => plan?.rooms.find((r) => roomIds.includes(r.roomId))?.level ?? 0;
  const middle = (line: Segment | undefined) => {
    const { a, b } = ends(line);
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 };
  };
  const object = objectOf(world, id);
  if (object) return { at: { x: object.pose?.xM ?? 0, y: object.pose?.yM ?? 0 }, level: levelOf([object.roomId]) };
  const room = roomOf(world, id);
  if (room) {
    const outline = corners(room.polygon);
    const sum = outline.reduce((s, c) => ({ x: s.x + c.x, y: s.y + c.y }), { x: 0, y: 0 });
    return { at: { x: sum.x / outline.length, y: sum.y / outline.length }, level: room.level };
  }
  const line =
    plan?.doors.find((d) => d.doorId === id) ??
    plan?.walls.find((w) => w.wallId === id) ??
    plan?.windows.find((w) => w.windowId === id);
  if (line) return { at: middle(line.line), level: levelOf("roomIds" in line ? line.roomIds : [line.roomId]) };
  const poi = world.scenario?.pois.find((p) => p.poiId === id);
  return poi && { at: { x: poi.pose?.xM ?? 0, y: poi.pose?.yM ?? 0 }, level: levelOf([poi.roomId]) };
}

/** Returns what a thing carries, things on these too. */
function carriedBy(world: World, id: string): Set<string> {
  const found = new Set([id]);
  for (let before = 0; before !== found.size; ) {
    before = found.size;
    for (const p of world.placements?.placements ?? []) {
      if (p.supportPlacementId && found.has(p.supportPlacementId)) found.add(p.placementId);
    }
  }
  return found;
}

/** Returns the world with objects, and what stands on them, moved and turned about the first one's center. */
export function withMoved(world: World, ids: string[], by: P, turn = 0): World {
  const placements = world.placements;
  const pivot = objectOf(world, ids[0])?.pose;
  if (!placements || !pivot) return world;
  const moved = new Set(ids.flatMap((id) => [...carriedBy(world, id)]));
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  const all = placements.placements.map((p) => {
    if (!moved.has(p.placementId) || !p.pose) return p;
    const [dx, dy] = [p.pose.xM - pivot.xM, p.pose.yM - pivot.yM];
    const pose = {
      ...p.pose,
      xM: tidy(pivot.xM + dx * c - dy * s + by.x),
      yM: tidy(pivot.yM + dx * s + dy * c + by.y),
      yawRad: p.pose.yawRad + turn,
    };
    return { ...p, pose };
  });
  return { ...world, placements: { ...placements, placements: all } };
}

/** Returns the world without objects and what stands on them. */
export function without(world: World, ids: string[]): World {
  const gone = new Set(ids.flatMap((id) => [...carriedBy(world, id)]));
  const placements = world.placements;
  if (!placements) return world;
  return { ...world, placements: { ...placements, placements: placements.placements.filter((p) => !gone.has(p.placementId)) } };
}

/** Returns the world with a door moved along its wall, whose pieces beside it give and take; nothing where it cannot go so far. */
export function withDoorMoved(world: World, doorId: string, by: number): World | undefined {
  const plan = world.floorplan;
  const door = plan?.doors.find((d) => d.doorId === doorId);
  if (!plan || !door?.line) return undefined;
  const { a, b, along } = ends(door.line);
  const shift = { x: along.x * by, y: along.y * by };
  const same = (p: P, q: P) => Math.hypot(p.x - q.x, p.y - q.y) < 1e-3;
  const moved = (p: { xM: number; yM: number }) => ({ ...p, xM: tidy(p.xM + shift.x), yM: tidy(p.yM + shift.y) });
  let held = true;
  const walls = plan.walls.map((wall) => {
    const line = ends(wall.line);
    const parallel = Math.abs(line.along.x * along.y - line.along.y * along.x) < 1e-3;
    if (!wall.line || !parallel || !wall.roomIds.some((id) => door.roomIds.includes(id))) return wall;
    const atStart = same(line.a, a) || same(line.a, b);
    const atEnd = same(line.b, a) || same(line.b, b);
    if (!atStart && !atEnd) return wall;
    const next = {
      ...wall.line,
      start: atStart && wall.line.start ? moved(wall.line.start) : wall.line.start,
      end: atEnd && wall.line.end ? moved(wall.line.end) : wall.line.end,
    } as Segment;
    const after = ends(next);
    if (after.length < 0.05 || after.along.x * line.along.x + after.along.y * line.along.y < 0) held = false;
    return { ...wall, line: next };
  });
  if (!held || !door.line.start || !door.line.end) return undefined;
  const line = { ...door.line, start: moved(door.line.start), end: moved(door.line.end) } as Segment;
  const doors = plan.doors.map((d) => (d.doorId === doorId ? { ...d, line } : d));
  return { ...world, floorplan: { ...plan, walls, doors } };
}

/** Returns the world with a window moved along the side of its room; nothing where that side ends before. */
export function withWindowMoved(world: World, windowId: string, by: number): World | undefined {
  const plan = world.floorplan;
  const window = plan?.windows.find((w) => w.windowId === windowId);
  if (!plan || !window?.line?.start || !window.line.end) return undefined;
  const { along } = ends(window.line);
  const moved = (p: { xM: number; yM: number }) => ({ ...p, xM: tidy(p.xM + along.x * by), yM: tidy(p.yM + along.y * by) });
  const line = { ...window.line, start: moved(window.line.start), end: moved(window.line.end) } as Segment;
  const outline = corners(roomOf(world, window.roomId)?.polygon);
  const sides = outline.map((corner, i) => [corner, outline[(i + 1) % outline.length]]);
  const isOn = ([a, b]: P[], p: P) => Math.abs(Math.hypot(a.x - p.x, a.y - p.y) + Math.hypot(b.x - p.x, b.y - p.y) - Math.hypot(a.x - b.x, a.y - b.y)) < 1e-3;
  const now = ends(line);
  if (!sides.some((side) => isOn(side, now.a) && isOn(side, now.b))) return undefined;
  return { ...world, floorplan: { ...plan, windows: plan.windows.map((w) => (w.windowId === windowId ? { ...w, line } : w)) } };
}

/** Returns where an object's edges may snap to: along x and along y, walls of its room and edges and centers of its neighbors. */
export function snapLines(world: World, id: string): { x: number[]; y: number[] } {
  const object = objectOf(world, id);
  const net = corners(roomOf(world, object?.roomId ?? "")?.netPolygon);
  const others = (world.placements?.placements ?? []).filter(
    (p) => p.roomId === object?.roomId && p.placementId !== id && !p.supportPlacementId && p.supportPlacementId !== id,
  );
  const points = [...net, ...others.flatMap((p) => [...footprint(p), { x: p.pose?.xM ?? 0, y: p.pose?.yM ?? 0 }])];
  return { x: points.map((p) => p.x), y: points.map((p) => p.y) };
}

/** Everything that a verdict says is broken, hard rules first, each with where it comes from. */
export interface Broken {
  id: string;
  subject: string;
  message: string;
  hard: boolean;
  measured?: number;
  required?: number;
  unit: string;
}

export function key(broken: { id: string; subject: string }): string {
  return `${broken.id} ${broken.subject}`;
}

export function ofViolation(v: Violation): Broken {
  return { id: v.code, subject: v.subject, message: said(v), hard: true, measured: v.measured, required: v.required, unit: v.unit };
}

/** Returns what is broken, in the server's words, or in the reader's language the rule with its figures. */
function said({ code, message, measured, required, unit }: Violation): string {
  if (!names.areTranslated) return message;
  const shown = (value: number) => `${figure(value)} ${unitSaid(unit)}`.trim();
  if (measured === undefined || required === undefined) return names.rule(code, message);
  return t("violated", { rule: names.rule(code, message), measured: shown(measured), required: shown(required) });
}
