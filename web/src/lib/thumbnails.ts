/** Pictures of assets and plans by their addresses; the browser itself asks for them, and keeps them, where no token is wanted. */
import type { KeptWorld } from "../gen/d3dgen/v1/library_service_pb";
import { access } from "./access.svelte";

const known = new Map<string, Promise<string>>();

/** Returns the address of an asset's picture; an empty one where there is none. */
export function thumbnail(assetId: string): Promise<string> {
  return pictureAt(`/models/${assetId.split("/").map(encodeURIComponent).join("/")}/thumbnail.png`);
}

/** Returns the address of a kept world's plan as it is now. */
export function planPicture(world: KeptWorld): Promise<string> {
  return pictureAt(`/worlds/${world.worldId}/plan.svg?${encodeURIComponent(world.etag)}`);
}

async function pictureAt(address: string): Promise<string> {
  if (!access.token) return address;
  let picture = known.get(address);
  if (!picture) {
    picture = fetched(address, access.token);
    known.set(address, picture);
  }
  return picture;
}

/** Fetches with the token what an element of the page cannot, and returns an address of the page's own for it. */
async function fetched(address: string, token: string): Promise<string> {
  const answer = await fetch(address, { headers: { authorization: `Bearer ${token}` } }).catch(() => undefined);
  return answer?.ok ? URL.createObjectURL(await answer.blob()) : "";
}
