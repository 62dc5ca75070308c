/** What a person does to what is selected: each is one step, and one edit of the server where there is one for it. */
import { type EditInit, session } from "./session.svelte";
import { onStep } from "./geometry";
import { t } from "./texts.svelte";
import { nameOf, objectOf, roomOf, without, withMoved } from "./world";

const world = () => session.step?.world;
const objects = () => session.selected.filter((id) => objectOf(world(), id));
const name = () => nameOf(world(), session.selected[0] ?? "");

/** Moves selected objects by so much, m. */
export async function nudge(x: number, y: number) {
  const now = world();
  const ids = objects();
  if (!now || ids.length === 0) return;
  const moved = withMoved(now, ids, { x: onStep(x), y: onStep(y) });
  const edits = ids.map((id): EditInit => {
    const pose = objectOf(moved, id)?.pose;
    return { case: "movedObject", value: { placementId: id, xM: pose?.xM ?? 0, yM: pose?.yM ?? 0 } };
  });
  await session.edit(edits, t("did.moved", { name: name() }), moved);
}

/** Turns selected objects by a quarter, counter-clockwise. */
export async function rotate() {
  const now = world();
  const ids = objects();
  if (!now || ids.length === 0) return;
  const quarter = Math.PI / 2;
  const edits = ids.map((id): EditInit => {
    const pose = objectOf(now, id)?.pose;
    const yawRad = Math.round(((pose?.yawRad ?? 0) + quarter) / quarter) * quarter;
    return { case: "movedObject", value: { placementId: id, xM: pose?.xM ?? 0, yM: pose?.yM ?? 0, yawRad } };
  });
  await session.edit(edits, t("did.turned", { name: name() }), withMoved(now, ids, { x: 0, y: 0 }, quarter));
}

/** Takes selected objects and rooms away. */
export async function remove() {
  const now = world();
  if (!now) return;
  const [ids, said] = [objects(), name()];
  const rooms = session.selected.filter((id) => roomOf(now, id));
  const edits = [
    ...ids.map((id): EditInit => ({ case: "removedPlacementId", value: id })),
    ...rooms.map((id): EditInit => ({ case: "removedRoomId", value: id })),
  ];
  if (edits.length === 0) return;
  const done = await session.edit(edits, t("did.removed", { name: said }), rooms.length > 0 ? undefined : without(now, ids));
  if (done) session.selected = [];
}

/** Puts another object of the same kind into the room of each selected one. */
export async function duplicate() {
  const edits = objects().flatMap((id): EditInit[] => {
    const object = objectOf(world(), id);
    return object ? [{ case: "addedObject", value: { roomId: object.roomId, object: object.objectId } }] : [];
  });
  if (edits.length > 0) await session.edit(edits, t("did.duplicated", { name: name() }));
}

/** Puts another model, or another object, where the selected one stands. */
export async function swap(object = "", asset = "") {
  const [placementId] = objects();
  if (placementId) await session.edit([{ case: "swappedObject", value: { placementId, object, asset } }], t("did.swapped", { name: name() }));
}

/** Sets selected objects in a row with the first one. */
export async function align(axis: "x" | "y") {
  const now = world();
  const [first, ...rest] = objects();
  const anchor = objectOf(now, first ?? "")?.pose;
  if (!now || !anchor) return;
  let aligned = now;
  const edits = rest.flatMap((id): EditInit[] => {
    const pose = objectOf(now, id)?.pose;
    if (!pose) return [];
    const by = { x: axis === "x" ? anchor.xM - pose.xM : 0, y: axis === "y" ? anchor.yM - pose.yM : 0 };
    aligned = withMoved(aligned, [id], by);
    return [{ case: "movedObject", value: { placementId: id, xM: pose.xM + by.x, yM: pose.yM + by.y } }];
  });
  if (edits.length > 0) await session.edit(edits, t("did.aligned"), aligned);
}

/** Hangs the selected door at its other side, or has it open into the room on its other side. */
export async function turnDoor(what: "hinge" | "room") {
  const door = world()?.floorplan?.doors.find((d) => d.doorId === session.selected[0]);
  if (!door?.swing) return;
  const { hingeAtStart, intoRoomId } = door.swing;
  const other = door.roomIds.find((id) => id !== intoRoomId);
  const swing = what === "hinge" ? { hingeAtStart: !hingeAtStart, intoRoomId } : { hingeAtStart, intoRoomId: other };
  const updateMask = { paths: [what === "hinge" ? "swing.hinge_at_start" : "swing.into_room_id"] };
  await session.edit([{ case: "door", value: { door: { doorId: door.doorId, swing }, updateMask } }], t("did.doorTurned"));
}

/** Pins what is selected, or frees it. */
export async function lock(locked: boolean) {
  const value = { ids: session.selected, includeContents: true, locked };
  await session.edit([{ case: "lock", value }], t(locked ? "did.locked" : "did.freed", { name: name() }));
}

/** Furnishes the selected room anew. */
export async function refurnish() {
  const room = session.selected.find((id) => roomOf(world(), id));
  if (room) await session.edit([{ case: "refurnishedRoomId", value: room }], t("did.refurnished", { name: name() }));
}

const ARROWS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

/** Does what a key on the plan says; returns false for a key that says nothing. */
export function act(event: KeyboardEvent): boolean {
  const arrow = ARROWS[event.key];
  if (arrow) {
    const by = event.shiftKey ? 0.5 : 0.05;
    void nudge(arrow[0] * by, arrow[1] * by);
    return objects().length > 0;
  }
  if (event.key === "Delete" || event.key === "Backspace") void remove();
  else if (event.key.toLowerCase() === "d" && (event.ctrlKey || event.metaKey)) void duplicate();
  else if (event.key.toLowerCase() === "r" && !event.ctrlKey && !event.metaKey) void rotate();
  else return false;
  return true;
}
