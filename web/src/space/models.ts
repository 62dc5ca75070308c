/** Models of the server's assets, asked for once each. */
import { Box3, Group, type Object3D, Quaternion, Vector3 } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

import type { Placement } from "../gen/d3dgen/v1/placements_pb";
import { assets, gathered } from "../lib/api";
import { unzipped } from "../lib/zip";

/** A part of a thing that moves: a drawer, a door, a seat that turns. */
export interface MovingPart {
  name: string;
  /** Puts the part where it is when it is so far open, 0 to 1. */
  set(open: number): void;
}

/** What a model says of a part that moves; its axis is that of the model's own frame. */
interface ModelJoint {
  name: string;
  kind: "revolute" | "prismatic" | "continuous";
  axis: [number, number, number];
  limits_rad?: [number, number];
  limits_m?: [number, number];
}

/** How far a part turns that has no limits, rad. */
const TURN = Math.PI;
/** Models on their way at a time. */
const TOGETHER = 4;
const known = new Map<string, Promise<Object3D | undefined>>();
const loader = new GLTFLoader();

/** Turn that brings the front of a model to where a thing's front is, x, by the axis that it is at; without a front, as models made here. */
const FRONTS: Record<string, number> = { "+x": 0, "-y": Math.PI / 2, "-x": Math.PI, "+y": -Math.PI / 2, xy: Math.PI / 2 };

async function load(assetId: string): Promise<Object3D | undefined> {
  const archive = await (await gathered(assets.downloadAsset({ assetId, formats: ["glb", "json"] }))).arrayBuffer();
  const glb = await unzipped(archive, (path) => path.endsWith(".glb"));
  const annotation = await unzipped(archive, (path) => path.endsWith(".json"));
  if (!glb || !annotation) return undefined;
  const { front } = JSON.parse(new TextDecoder().decode(annotation)) as { front: { axis: string } };
  const { scene } = await loader.parseAsync(glb.slice().buffer, "");
  scene.rotation.x = Math.PI / 2; // glTF has y up
  const turned = new Group();
  turned.rotation.z = FRONTS[front.axis] ?? FRONTS["-y"];
  turned.add(scene);
  return turned;
}

function model(assetId: string): Promise<Object3D | undefined> {
  let found = known.get(assetId);
  if (!found) {
    // a thing without a model stays a box
    found = load(assetId).catch(() => undefined);
    known.set(assetId, found);
  }
  return found;
}

/** Returns a model as large as its object is, its underside in the origin. */
function fitted(original: Object3D, placement: Placement): Group {
  const inner = new Group();
  inner.add(original.clone());
  const bounds = new Box3().setFromObject(inner);
  const is = bounds.getSize(new Vector3());
  const { depthM = is.x, widthM = is.y, heightM = is.z } = placement.sizeM ?? {};
  const [x, y, z] = [depthM / (is.x || 1), widthM / (is.y || 1), heightM / (is.z || 1)];
  const middle = bounds.getCenter(new Vector3());
  inner.position.set(-middle.x * x, -middle.y * y, -bounds.min.z * z);
  inner.scale.set(x, y, z);
  return inner;
}

/** Returns the joint of a part of a model, where it has one. */
export const jointOf = (part: Object3D): ModelJoint | undefined => part.userData.joint as ModelJoint | undefined;

/** Returns the parts of a model that move. */
export function movingParts(model: Object3D): MovingPart[] {
  const found: MovingPart[] = [];
  model.traverse((part) => {
    const joint = jointOf(part);
    if (!joint) return;
    const axis = new Vector3(...joint.axis);
    const shut = { at: part.position.clone(), turn: part.quaternion.clone() };
    const [low, high] = joint.limits_rad ?? joint.limits_m ?? [0, TURN];
    // what can go both ways goes the longer one
    const far = Math.abs(low) > Math.abs(high) ? low : high;
    const slides = joint.kind === "prismatic";
    const set = (open: number) => {
      if (slides) part.position.copy(shut.at).addScaledVector(axis, open * far);
      else part.quaternion.copy(shut.turn).multiply(new Quaternion().setFromAxisAngle(axis, open * far));
    };
    found.push({ name: joint.name, set });
  });
  return found;
}

/** Puts models in place of boxes, one kind after the other; `changed` is called for each kind with the things of it. */
export async function furnish(
  bodies: Map<string, Group>,
  placements: Placement[],
  changed: (placementIds: string[]) => void,
  isOver: () => boolean,
) {
  const byAsset = Map.groupBy(
    placements.filter((p) => bodies.has(p.placementId)),
    (p) => p.assetId,
  );
  const waiting = [...byAsset];
  const work = async () => {
    for (let next = waiting.shift(); next && !isOver(); next = waiting.shift()) {
      const [assetId, all] = next;
      const found = await model(assetId);
      if (!found || isOver()) continue;
      for (const placement of all) {
        const body = bodies.get(placement.placementId);
        body?.clear();
        body?.add(fitted(found, placement));
      }
      changed(all.map((placement) => placement.placementId));
    }
  };
  await Promise.all(Array.from({ length: TOGETHER }, work));
}
