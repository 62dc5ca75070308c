/** How parts of a plan are drawn: paths in meters, y downwards as SVG has it. */
import { type Door, DoorKind, type PlanRoom, Slide, type Window } from "../gen/d3dgen/v1/floorplan_pb";
import type { Placement } from "../gen/d3dgen/v1/placements_pb";
import { corners, ends, footprint, inside, type P, strip } from "../lib/geometry";

const n = (value: number) => Math.round(value * 1000) / 1000;
const at = (p: P) => `${n(p.x)} ${n(-p.y)}`;

/** Returns a closed outline. */
export function closed(points: P[]): string {
  return points.length === 0 ? "" : `M${points.map(at).join("L")}Z`;
}

export function open(points: P[]): string {
  return points.length === 0 ? "" : `M${points.map(at).join("L")}`;
}

/** Returns the hole of an opening in its wall, a little thicker than the wall. */
export function hole(opening: Door | Window): string {
  return closed(strip(opening.line, opening.wallThicknessM + 0.02));
}

/** Returns the panes of a window: its two faces and the glass between. */
export function panes(window: Window): string {
  const [a, b, c, d] = strip(window.line, window.wallThicknessM);
  const line = ends(window.line);
  return `${closed([a, b, c, d])}${open([line.a, line.b])}`;
}

/** Returns the leaves of a door and the arcs they sweep. */
export function leaves(door: Door, rooms: PlanRoom[]): { leaf: string; arc: string } {
  const { a, b, length, along, across } = ends(door.line);
  const plus = (p: P, v: P, s: number) => ({ x: p.x + v.x * s, y: p.y + v.y * s });
  if (door.kind === DoorKind.OPEN) return { leaf: "", arc: open([a, b]) };
  if (door.kind === DoorKind.SLIDING) {
    const beyondStart = door.slide === Slide.BEYOND_START || door.slide === Slide.STACKED_BEYOND_START;
    const by = (beyondStart ? -1 : 1) * length * 0.5;
    const side = door.wallThicknessM / 2 + 0.03;
    const from = (p: P) => plus(plus(p, along, by), across, side);
    return { leaf: open([from(a), from(b)]), arc: "" };
  }
  const middle = plus(a, along, length / 2);
  const into = rooms.find((r) => r.roomId === (door.swing?.intoRoomId || door.roomIds[0]));
  const isInside = into ? inside(corners(into.polygon), plus(middle, across, 0.3)) : true;
  const wanted = door.swing?.intoRoomId ? isInside : !isInside;
  const side = wanted ? 1 : -1;
  const one = (hinge: P, free: P, width: number) => {
    const tip = plus(hinge, across, side * width);
    const turn = (free.x - hinge.x) * (tip.y - hinge.y) - (free.y - hinge.y) * (tip.x - hinge.x) > 0 ? 0 : 1;
    return { leaf: open([hinge, tip]), arc: `M${at(free)}A${n(width)} ${n(width)} 0 0 ${turn} ${at(tip)}` };
  };
  const double = door.kind === DoorKind.DOUBLE_HINGED;
  const atStart = one(a, double ? middle : b, double ? length / 2 : length);
  const atEnd = one(b, double ? middle : a, double ? length / 2 : length);
  if (double) return { leaf: atStart.leaf + atEnd.leaf, arc: atStart.arc + atEnd.arc };
  return door.swing?.hingeAtStart === false ? atEnd : atStart;
}

/** Returns an object's outline, and the line that marks its front. */
export function object(placement: Placement): { outline: string; front: string } {
  const [a, b, c, d] = footprint(placement);
  const in1 = (p: P, q: P) => ({ x: p.x + (q.x - p.x) * 0.14, y: p.y + (q.y - p.y) * 0.14 });
  return { outline: closed([a, b, c, d]), front: open([in1(b, a), in1(c, d)]) };
}
