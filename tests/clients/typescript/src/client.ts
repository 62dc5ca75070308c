// A client made of the proto files alone: every service of a running server, end to end.
//
//     node out/src/client.js ADDRESS WORKSPACE [CA_FILE]     token in $D3DGEN_TOKEN
//
// `WORKSPACE` is the checkout, for the files of domains/school and a few models. Exits with 1 at the first thing that is
// not as the contract says. Calls go over gRPC; what web pages do is repeated over gRPC-Web.

import { randomUUID } from "node:crypto";
import { existsSync, readFileSync, readdirSync, statSync } from "node:fs";
import { join, relative, sep } from "node:path";

import { clone, create, equals } from "@bufbuild/protobuf";
import { Code, ConnectError, createClient, type Interceptor, type Transport } from "@connectrpc/connect";
import { createGrpcTransport } from "@connectrpc/connect-node";
import { createGrpcWebTransport } from "@connectrpc/connect-web";

import { AssetService, FileChunkSchema, IngestAssetsRequestSchema } from "../gen/d3dgen/v1/asset_service_pb.js";
import { DomainService } from "../gen/d3dgen/v1/domain_service_pb.js";
import { type DomainManifest, DomainManifestSchema } from "../gen/d3dgen/v1/domain_manifest_pb.js";
import { type Job, JobService, JobState } from "../gen/d3dgen/v1/job_service_pb.js";
import type { KnowledgeBase } from "../gen/d3dgen/v1/knowledge_base_pb.js";
import { KnowledgeService } from "../gen/d3dgen/v1/knowledge_service_pb.js";
import { Mount } from "../gen/d3dgen/v1/common_pb.js";
import { PlacementSchema } from "../gen/d3dgen/v1/placements_pb.js";
import { type World, WorldSchema } from "../gen/d3dgen/v1/world_pb.js";
import { type GenerateWorldRequest, GenerateWorldRequestSchema, WorldService } from "../gen/d3dgen/v1/world_service_pb.js";
import { BadRequestSchema } from "../gen/google/rpc/error_details_pb.js";

const PIECE_BYTES = 64 * 1024;
const DEADLINE = { timeoutMs: 120_000 };

function check(holds: unknown, message: string): asserts holds {
  if (!holds) throw new Error(`not as the contract says: ${message}`);
}

function clients(transport: Transport) {
  return {
    domains: createClient(DomainService, transport),
    knowledge: createClient(KnowledgeService, transport),
    assets: createClient(AssetService, transport),
    worlds: createClient(WorldService, transport),
    jobs: createClient(JobService, transport),
  };
}
type Clients = ReturnType<typeof clients>;

function bearer(token: string | undefined): Interceptor[] {
  if (!token) return [];
  return [
    (next) => (request) => {
      request.header.set("authorization", `Bearer ${token}`);
      return next(request);
    },
  ];
}

function grpc(baseUrl: string, ca: string | undefined, token: string | undefined): Clients {
  const nodeOptions = ca ? { ca: readFileSync(ca) } : {};
  return clients(createGrpcTransport({ baseUrl, nodeOptions, interceptors: bearer(token) }));
}

async function listDomains(client: Clients): Promise<string[]> {
  const ids: string[] = [];
  let pageToken = "";
  do {
    const answer = await client.domains.listDomains({ pageSize: 2, pageToken }, DEADLINE);
    ids.push(...answer.domains.map((d) => d.domainId));
    pageToken = answer.nextPageToken;
  } while (pageToken);
  check(["residential", "office", "hospital"].every((id) => ids.includes(id)), `shipped domains are listed: ${ids}`);
  check(new Set(ids).size === ids.length, `no domain is on two pages: ${ids}`);
  return ids;
}

// Returns the school domain and its rules under another id, from the files of its folder.
async function readSchool(client: Clients, workspace: string, domainId: string): Promise<[DomainManifest, KnowledgeBase]> {
  const folder = join(workspace, "domains", "school");
  const names = readdirSync(folder).filter((name) => name.endsWith(".toml") || name === "knowledge.json");
  const files = names.sort().map((name) => ({ name, content: readFileSync(join(folder, name)) }));
  const { manifest, knowledgeBase, problems } = await client.domains.parseDomain({ files }, DEADLINE);
  check(manifest && knowledgeBase?.metadata && !problems.length, `the files of school have no problems: ${problems}`);
  manifest.domainId = domainId;
  manifest.title = "School of a client";
  knowledgeBase.metadata.domainId = domainId;
  return [manifest, knowledgeBase];
}

async function register(client: Clients, manifest: DomainManifest, knowledgeBase: KnowledgeBase): Promise<void> {
  const request = { manifest, knowledgeBase, requestId: randomUUID() };
  const first = (await client.domains.registerDomain(request, DEADLINE)).domain;
  const again = (await client.domains.registerDomain(request, DEADLINE)).domain;
  check(first && first.domainVersion === again?.domainVersion, "a repeated request has the answer of the first");
  check(!first.shipped && first.registeredAt, "the domain says when it was registered");
  const got = await client.domains.getDomain({ domainId: first.domainId, includeManifest: true }, DEADLINE);
  check(got.manifest && equals(DomainManifestSchema, got.manifest, manifest), "the manifest comes back as it was sent");
}

async function searchRules(client: Clients, domainId: string): Promise<number> {
  const query = "clear width of corridors";
  const filters = { jurisdiction: { values: ["DE", "US"] } };
  const { constraints } = await client.knowledge.searchConstraints({ query, filters, pageSize: 5 }, DEADLINE);
  check(constraints.length, "rules about corridors are found");
  check(constraints.every((c) => ["DE", "US"].includes(c.jurisdiction)), "filters hold");
  check(constraints.every((c) => c.sources.length && c.constraint?.unit), "every rule has a source and a unit");
  const roomLabels = ["classroom", "classroom", "corridor"];
  const building = { domainId, countryCode: "DE", roomLabels };
  const applying = await client.knowledge.retrieveConstraints(building, DEADLINE);
  check(applying.domainId === domainId && applying.constraints.length, "the rules of a school in Germany");
  return applying.constraints.length;
}

// Watches a job to its end and returns it.
async function waitFor(client: Clients, jobId: string): Promise<Job> {
  let fraction = 0;
  let job: Job | undefined;
  for await (const event of client.jobs.watchJob({ jobId }, DEADLINE)) {
    job = event.job;
    check((job?.progress?.fraction ?? 0) >= fraction, "progress does not fall");
    fraction = job?.progress?.fraction ?? 0;
  }
  check(job?.state === JobState.SUCCEEDED, `the job ends well: ${job?.error?.message}`);
  return job;
}

function filesBelow(folder: string): string[] {
  const paths = readdirSync(folder).sort().map((name) => join(folder, name));
  return paths.flatMap((path) => (statSync(path).isDirectory() ? filesBelow(path) : [path]));
}

// Uploads a folder of models and waits until they are assets.
async function ingest(client: Clients, workspace: string): Promise<number> {
  const folder = join(workspace, "service", "assets", "tests", "models");
  async function* parts() {
    const header = { folderName: "models", why: "a test of clients", requestId: randomUUID() };
    yield create(IngestAssetsRequestSchema, { part: { case: "header", value: header } });
    for (const path of filesBelow(folder)) {
      const content = readFileSync(path);
      for (let at = 0; at < Math.max(content.length, 1); at += PIECE_BYTES) {
        const name = relative(folder, path).split(sep).join("/");
        const chunk = create(FileChunkSchema, { path: name, content: content.subarray(at, at + PIECE_BYTES) });
        yield create(IngestAssetsRequestSchema, { part: { case: "chunk", value: chunk } });
      }
    }
  }
  const { job } = await client.assets.ingestAssets(parts(), DEADLINE);
  check(job, "an upload becomes a job");
  const { result } = await waitFor(client, job.jobId);
  check(result.case === "ingest", `the result is that of an ingest, not ${result.case}`);
  const { addedCount, updatedCount, unchangedCount, files } = result.value;
  check(addedCount + updatedCount + unchangedCount >= 3, "models become assets");
  const assetId = files.find((f) => f.assetId)?.assetId;
  const { asset } = await client.assets.getAsset({ assetId }, DEADLINE);
  check(asset?.origin?.kind.case === "ingested" && (asset.sizeM?.zM ?? 0) > 0, "an asset has origin and size");
  return addedCount + updatedCount + unchangedCount;
}

async function searchAssets(client: Clients): Promise<string> {
  const request = { query: "bed for a patient", pageSize: 5, filter: { heightM: { max: 2 } } };
  const { assets } = await client.assets.searchAssets(request, DEADLINE);
  check(assets[0]?.asset, "there are beds");
  check(assets.every((a) => (a.asset?.sizeM?.zM ?? 9) <= 2), "limits of filters hold");
  return assets[0].asset.assetId;
}

// Returns the sound world of a request and the names of the events on the way.
async function generate(client: Clients, request: GenerateWorldRequest): Promise<[World, string[]]> {
  const seen: string[] = [];
  let fraction = 0;
  let made: World | undefined;
  for await (const { progress, event } of client.worlds.generateWorld(request, DEADLINE)) {
    check(progress && progress.fraction >= fraction && progress.fraction <= 1, "progress goes from 0 to 1");
    fraction = progress.fraction;
    if (event.case) seen.push(event.case);
    if (event.case === "world") {
      check(event.value.report?.sound, "the world is sound");
      made = event.value.world;
    }
  }
  check(made, `the stream ends with a world: ${seen}`);
  const wanted = ["floorplan", "placements", "scenario", "world"];
  const order = wanted.map((stage) => seen.indexOf(stage));
  check(order.every((at, i) => at >= 0 && (i === 0 || at > (order[i - 1] ?? 0))), `stages come in order: ${seen}`);
  return [made, seen];
}

// Keeps the plan and the furniture of one room, and has the rest furnished anew.
async function pinAndRegenerate(client: Clients, world: World): Promise<string> {
  const { sceneGraph, floorplan, placements } = clone(WorldSchema, world);
  check(sceneGraph && floorplan && placements, "a world has all its documents");
  const roomId = placements.placements.find((p) => p.mount === Mount.FLOOR)?.roomId;
  check(roomId, "something stands on a floor");
  sceneGraph.seed += 1n;
  for (const room of floorplan.rooms) room.locked = true;
  for (const placement of placements.placements) placement.locked = placement.roomId === roomId;
  const request = create(GenerateWorldRequestSchema, {
    start: { case: "sceneGraph", value: sceneGraph },
    pinnedFloorplan: floorplan,
    pinnedPlacements: placements,
    name: "pinned",
  });
  const [again] = await generate(client, request);
  for (const before of placements.placements.filter((p) => p.locked)) {
    const after = again.placements?.placements.find((p) => p.placementId === before.placementId);
    check(after && equals(PlacementSchema, { ...after, locked: true }, before), `${before.placementId} stays as it was`);
  }
  const poses = (w: World) => JSON.stringify(w.placements?.placements.map((p) => [p.pose?.xM, p.pose?.yM]));
  check(poses(again) !== poses(world), "the other rooms are furnished anew");
  return roomId;
}

async function exportZip(client: Clients, world: World): Promise<number> {
  const pieces: Uint8Array[] = [];
  for await (const { chunk } of client.worlds.exportWorld({ world }, DEADLINE)) pieces.push(chunk);
  const archive = Buffer.concat(pieces);
  check(archive.subarray(0, 4).equals(Buffer.from("PK\x03\x04")), "the archive begins as a zip archive does");
  check(archive.includes("world.yaml") && archive.includes("PK\x05\x06"), "the archive is whole and has a world.yaml");
  return archive.length;
}

// Sends a manifest with a mistake and reads from the answer where it is.
async function brokenDomain(client: Clients, whole: DomainManifest): Promise<string> {
  const manifest = clone(DomainManifestSchema, whole);
  const area = manifest.roomTypes[2]?.areaM2;
  check(area, "a room type has an area");
  [area.minM2, area.maxM2] = [500, 5];
  try {
    await client.domains.registerDomain({ manifest, validateOnly: true }, DEADLINE);
  } catch (reason) {
    const error = ConnectError.from(reason);
    check(error.code === Code.InvalidArgument, `the code is ${Code[error.code]}`);
    const places = error.findDetails(BadRequestSchema).flatMap((d) => d.fieldViolations.map((v) => v.field));
    const place = places.find((field) => field.startsWith("manifest.room_types[2].area_m2"));
    check(place, `the answer names the place: ${places}`);
    return place;
  }
  throw new Error("not as the contract says: a broken domain is registered");
}

async function withoutToken(baseUrl: string, ca: string | undefined): Promise<void> {
  try {
    await listDomains(grpc(baseUrl, ca, undefined));
  } catch (reason) {
    check(ConnectError.from(reason).code === Code.Unauthenticated, `without a token: ${reason}`);
    return;
  }
  throw new Error("not as the contract says: a call without a token is answered");
}

// What a web page does: the same calls over gRPC-Web, by `fetch`.
async function overTheWeb(baseUrl: string, token: string | undefined, domainId: string): Promise<string> {
  const client = clients(createGrpcWebTransport({ baseUrl, interceptors: bearer(token) }));
  const ids = await listDomains(client);
  const building = { prompt: "primary school with two classrooms", seed: 8n, domainId };
  const [world] = await generate(
    client,
    create(GenerateWorldRequestSchema, { start: { case: "building", value: building } }),
  );
  return `${ids.length} domains, world ${world.name}`;
}

async function main(): Promise<void> {
  const [address, workspace, ca] = process.argv.slice(2);
  check(address && workspace && existsSync(workspace), "usage: client.js ADDRESS WORKSPACE [CA_FILE]");
  const token = process.env["D3DGEN_TOKEN"];
  const baseUrl = `${ca ? "https" : "http"}://${address}`;
  const client = grpc(baseUrl, ca, token);
  if (token) await withoutToken(baseUrl, ca);
  const domainId = "client_school_ts";
  console.log("domains:", (await listDomains(client)).join(", "));
  const [manifest, knowledgeBase] = await readSchool(client, workspace, domainId);
  console.log("broken domain refused at", await brokenDomain(client, manifest));
  await register(client, manifest, knowledgeBase);
  check((await listDomains(client)).includes(domainId), "the registered domain is listed");
  console.log("rules applying:", await searchRules(client, domainId));
  console.log("models ingested:", await ingest(client, workspace));
  console.log("asset found:", await searchAssets(client));
  const building = { prompt: "primary school with three classrooms", seed: 7n, domainId };
  const request = create(GenerateWorldRequestSchema, { start: { case: "building", value: building } });
  const [world, seen] = await generate(client, request);
  console.log(`world ${world.name}: ${world.placements?.placements.length} objects, events ${seen.join(", ")}`);
  console.log("pinned:", await pinAndRegenerate(client, world));
  console.log("exported bytes:", await exportZip(client, world));
  console.log("over gRPC-Web:", await overTheWeb(baseUrl, token, domainId));
  await client.domains.removeDomain({ domainId }, DEADLINE);
  check(!(await listDomains(client)).includes(domainId), "the removed domain is gone");
  console.log("done");
}

main().then(
  () => process.exit(0),
  (reason) => {
    console.error(reason);
    process.exit(1);
  },
);
