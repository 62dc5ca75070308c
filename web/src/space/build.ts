/** The bodies of a storey in space: floors, walls with their openings, leaves that open, and what stands there. Meters, z up. */
import {
  BoxGeometry,
  type BufferGeometry,
  Group,
  Mesh,
  MeshLambertMaterial,
  PlaneGeometry,
  Shape,
  ShapeGeometry,
} from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";

import { Mount } from "../gen/d3dgen/v1/common_pb";
import { type Door, DoorKind, type PlanRoom, Slide, type Wall, type Window } from "../gen/d3dgen/v1/floorplan_pb";
import type { Placement } from "../gen/d3dgen/v1/placements_pb";
import type { World } from "../gen/d3dgen/v1/world_pb";
import { corners, ends, inside, type P } from "../lib/geometry";
import { storeyOf } from "../lib/world";
import materials from "./materials.json";

/** Height of a wall whose rooms say none, m. */
const USUAL_HEIGHT = 2.6;
const LEAF = 0.04;

/** A leaf that opens: turned about its hinge, or pushed along its wall. */
export interface Leaf {
  doorId: string;
  body: Group;
  /** Puts the leaf where it is when it is so far open, 0 to 1. */
  set(open: number): void;
}

/** A storey in space. */
export interface Bodies {
  root: Group;
  leaves: Leaf[];
  /** Bodies of objects by id, for picking and for models to take their place. */
  objects: Map<string, Group>;
  /** Everything that stops who walks. */
  solid: BufferGeometry | undefined;
  floors: { at: P; height: number }[];
}

export function colorOf(name: string, table: "floor" | "wall"): string {
  const words = name.toLowerCase();
  const found = Object.entries(materials[table]).find(([word]) => words.includes(word));
  return found?.[1] ?? materials.usual[table];
}

/** Returns a muted color of an object's kind, the same every time. */
function objectColor(id: string): string {
  let hash = 7;
  for (const letter of id) hash = (hash * 31 + letter.charCodeAt(0)) % 4096;
  return `hsl(${hash % 360}, 18%, ${58 + (hash % 5) * 5}%)`;
}

const lambert = (color: string) => new MeshLambertMaterial({ color });

/** Returns a box along a line, from one height to another. */
function box(a: P, b: P, thickness: number, low: number, high: number): BufferGeometry | undefined {
  const length = Math.hypot(b.x - a.x, b.y - a.y);
  if (length < 1e-3 || high - low < 1e-3) return undefined;
  const geometry = new BoxGeometry(length, thickness, high - low);
  geometry.rotateZ(Math.atan2(b.y - a.y, b.x - a.x));
  geometry.translate((a.x + b.x) / 2, (a.y + b.y) / 2, (low + high) / 2);
  return geometry;
}

function heightOf(roomIds: string[], rooms: PlanRoom[]): number {
  return Math.max(...rooms.filter((r) => roomIds.includes(r.roomId)).map((r) => r.ceilingHeightM), 0) || USUAL_HEIGHT;
}

/** Returns a piece of wall with its windows cut out. */
function wallBoxes(wall: Wall, windows: Window[], rooms: PlanRoom[], jambs: P[]): (BufferGeometry | undefined)[] {
  const { a, b, along, across, length } = ends(wall.line);
  const high = heightOf(wall.roomIds, rooms);
  const at = (l: number) => ({ x: a.x + along.x * l, y: a.y + along.y * l });
  const spot = (p: P) => (p.x - a.x) * along.x + (p.y - a.y) * along.y;
  const off = (p: P) => Math.abs((p.x - a.x) * across.x + (p.y - a.y) * across.y);
  const isJamb = (p: P) => jambs.some((j) => Math.hypot(j.x - p.x, j.y - p.y) < 0.01);
  // walls meet in corners, which their center lines leave open; at a door they end where it begins
  const from = isJamb(a) ? 0 : -wall.thicknessM / 2;
  const to = length + (isJamb(b) ? 0 : wall.thicknessM / 2);
  const cuts = windows.flatMap((window) => {
    const line = ends(window.line);
    const [one, two] = [spot(line.a), spot(line.b)];
    const within = off(line.a) < 0.02 && Math.max(one, two) > 0 && Math.min(one, two) < length;
    return within ? [{ low: Math.max(0, Math.min(one, two)), high: Math.min(length, Math.max(one, two)), window }] : [];
  });
  cuts.sort((c, d) => c.low - d.low);
  const found: (BufferGeometry | undefined)[] = [];
  let done = from;
  for (const cut of cuts) {
    found.push(box(at(done), at(cut.low), wall.thicknessM, 0, high));
    found.push(box(at(cut.low), at(cut.high), wall.thicknessM, 0, cut.window.sillM));
    found.push(box(at(cut.low), at(cut.high), wall.thicknessM, cut.window.headM, high));
    done = cut.high;
  }
  found.push(box(at(done), at(to), wall.thicknessM, 0, high));
  return found;
}

function leafBody(door: Door, width: number, from: number): Mesh {
  const geometry = new BoxGeometry(width, LEAF, door.heightM - 0.01);
  geometry.translate(from + width / 2, 0, door.heightM / 2);
  const body = new Mesh(geometry, lambert(materials.usual.door));
  body.userData.doorId = door.doorId;
  return body;
}

/** Returns a leaf on hinges at one end of the opening, which turns to one side. */
function hinged(door: Door, hinge: P, towards: P, width: number, side: number): Leaf {
  const body = new Group();
  body.position.set(hinge.x, hinge.y, 0);
  const shut = Math.atan2(towards.y - hinge.y, towards.x - hinge.x);
  body.add(leafBody(door, width, 0));
  const set = (open: number) => {
    body.rotation.z = shut + side * open * (Math.PI / 2);
  };
  set(0);
  return { doorId: door.doorId, body, set };
}

/** Returns a leaf that slides along its wall, or up. */
function sliding(door: Door): Leaf {
  const { a, b, along, length } = ends(door.line);
  const body = new Group();
  body.add(leafBody(door, length, 0));
  const back = [Slide.BEYOND_START, Slide.STACKED_BEYOND_START].includes(door.slide ?? Slide.UNSPECIFIED);
  const by = (back ? -1 : 1) * length * 0.95;
  const up = door.slide === Slide.UP;
  body.rotation.z = Math.atan2(b.y - a.y, b.x - a.x);
  const set = (open: number) => {
    const go = up ? 0 : by * open;
    body.position.set(a.x + along.x * go, a.y + along.y * go, up ? open * door.heightM * 0.95 : 0);
  };
  set(0);
  return { doorId: door.doorId, body, set };
}

function leavesOf(door: Door, rooms: PlanRoom[]): Leaf[] {
  if (door.kind === DoorKind.OPEN) return [];
  if (door.kind === DoorKind.SLIDING) return [sliding(door)];
  const { a, b, length, across } = ends(door.line);
  const middle = { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 };
  const into = rooms.find((r) => r.roomId === door.swing?.intoRoomId);
  const probe = { x: middle.x + across.x * 0.3, y: middle.y + across.y * 0.3 };
  const isLeft = into ? inside(corners(into.polygon), probe) : !rooms.some((r) => inside(corners(r.polygon), probe));
  const side = isLeft ? 1 : -1;
  if (door.kind === DoorKind.DOUBLE_HINGED) {
    return [hinged(door, a, b, length / 2, side), hinged(door, b, a, length / 2, -side)];
  }
  return door.swing?.hingeAtStart === false ? [hinged(door, b, a, length, -side)] : [hinged(door, a, b, length, side)];
}

function objectBody(placement: Placement): Group {
  const { depthM = 0.4, widthM = 0.4, heightM = 0.4 } = placement.sizeM ?? {};
  const group = new Group();
  group.position.set(placement.pose?.xM ?? 0, placement.pose?.yM ?? 0, placement.pose?.zM ?? 0);
  group.rotation.z = placement.pose?.yawRad ?? 0;
  const geometry = new BoxGeometry(depthM, widthM, heightM);
  geometry.translate(0, 0, heightM / 2);
  group.add(new Mesh(geometry, lambert(objectColor(placement.objectId))));
  group.userData.objectId = placement.placementId;
  group.userData.overhead = placement.mount === Mount.CEILING;
  return group;
}

function floor(room: PlanRoom): Mesh {
  const shape = new Shape();
  corners(room.polygon).forEach((p, i) => (i === 0 ? shape.moveTo(p.x, p.y) : shape.lineTo(p.x, p.y)));
  const body = new Mesh(new ShapeGeometry(shape), lambert(colorOf(room.materials?.floor ?? "", "floor")));
  body.userData.roomId = room.roomId;
  return body;
}

function pane(window: Window): Mesh {
  const { a, b, length } = ends(window.line);
  const geometry = new PlaneGeometry(length, window.headM - window.sillM);
  geometry.rotateX(Math.PI / 2);
  geometry.rotateZ(Math.atan2(b.y - a.y, b.x - a.x));
  geometry.translate((a.x + b.x) / 2, (a.y + b.y) / 2, (window.headM + window.sillM) / 2);
  const material = new MeshLambertMaterial({ color: "#a9cfe0", transparent: true, opacity: 0.35, side: 2 });
  return new Mesh(geometry, material);
}

/** Returns a storey of a world in space. */
export function bodiesOf(world: World, level: number): Bodies {
  const storey = storeyOf(world, level);
  const root = new Group();
  const jambs = storey.doors.flatMap((d) => [ends(d.line).a, ends(d.line).b]);
  const walls = storey.walls.flatMap((wall) => wallBoxes(wall, storey.windows, storey.rooms, jambs));
  for (const door of storey.doors) {
    const { a, b } = ends(door.line);
    walls.push(box(a, b, door.wallThicknessM, door.heightM, heightOf(door.roomIds, storey.rooms)));
  }
  const solid = walls.filter((w) => w !== undefined);
  const merged = solid.length > 0 ? mergeGeometries(solid) : undefined;
  if (merged) root.add(new Mesh(merged, lambert(materials.usual.wall)));
  for (const room of storey.rooms) root.add(floor(room));
  for (const window of storey.windows) root.add(pane(window));
  const leaves = storey.doors.flatMap((door) => leavesOf(door, storey.rooms));
  for (const leaf of leaves) root.add(leaf.body);
  const objects = new Map<string, Group>();
  for (const placement of storey.objects) {
    const body = objectBody(placement);
    objects.set(placement.placementId, body);
    root.add(body);
  }
  const floors = storey.rooms.map((room) => {
    const outline = corners(room.netPolygon);
    const sum = outline.reduce((s, p) => ({ x: s.x + p.x, y: s.y + p.y }), { x: 0, y: 0 });
    return { at: { x: sum.x / outline.length, y: sum.y / outline.length }, height: room.ceilingHeightM };
  });
  return { root, leaves, objects, solid: merged, floors };
}

