/** Pictures of assets and plans, asked for once each, as addresses of the page's own. */
import type { KeptWorld } from "../gen/d3dgen/v1/library_service_pb";
import { access } from "./access.svelte";
import { assets } from "./api";

const known = new Map<string, Promise<string>>();

/** Returns the address of an asset's picture; an empty one where there is none. */
export function thumbnail(assetId: string): Promise<string> {
  let picture = known.get(assetId);
  if (!picture) {
    picture = assets.getAsset({ assetId }).then(
      ({ thumbnailPng }) =>
        thumbnailPng.length === 0 ? "" : URL.createObjectURL(new Blob([new Uint8Array(thumbnailPng)], { type: "image/png" })),
      () => "",
    );
    known.set(assetId, picture);
  }
  return picture;
}

/** Returns the address of a kept world's plan; the browser itself asks for it where no token is wanted. */
export async function planPicture(world: KeptWorld): Promise<string> {
  const address = `/worlds/${world.worldId}/plan.svg`;
  if (!access.token) return `${address}?${world.etag}`;
  const answer = await fetch(address, { headers: { authorization: `Bearer ${access.token}` } }).catch(() => undefined);
  return answer?.ok ? URL.createObjectURL(await answer.blob()) : "";
}
