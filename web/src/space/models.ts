/** Models of the server's assets, asked for once each. */
import { Box3, Group, type Object3D, Vector3 } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

import type { Placement } from "../gen/d3dgen/v1/placements_pb";
import { assets } from "../lib/api";
import { unzipped } from "../lib/zip";

/** Models on their way at a time. */
const TOGETHER = 4;
const known = new Map<string, Promise<Object3D | undefined>>();
const loader = new GLTFLoader();

async function load(assetId: string): Promise<Object3D | undefined> {
  const pieces: Uint8Array<ArrayBuffer>[] = [];
  for await (const { chunk } of assets.downloadAsset({ assetId, formats: ["glb"] })) pieces.push(new Uint8Array(chunk));
  const glb = await unzipped(await new Blob(pieces).arrayBuffer(), (path) => path.endsWith(".glb"));
  if (!glb) return undefined;
  const { scene } = await loader.parseAsync(glb.slice().buffer, "");
  scene.rotation.x = Math.PI / 2; // glTF has y up
  return scene;
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

/** Puts models in place of boxes, one kind after the other; `changed` is called for each. */
export async function furnish(
  bodies: Map<string, Group>,
  placements: Placement[],
  changed: () => void,
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
      changed();
    }
  };
  await Promise.all(Array.from({ length: TOGETHER }, work));
}
