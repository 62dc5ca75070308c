// A world in a few lines: start `d3dgen serve`, then `node quickstart.js 127.0.0.1:50051`. See examples/README.md.

import { createWriteStream } from "node:fs";

import { createClient } from "@connectrpc/connect";
import { createGrpcTransport } from "@connectrpc/connect-node";

import { type CheckedWorld, WorldService } from "../gen/d3dgen/v1/world_service_pb.js";

const worlds = createClient(WorldService, createGrpcTransport({ baseUrl: `http://${process.argv[2]}` }));

const prompt = "hospital ward with 5 rooms in Germany, for a delivery robot";
let checked: CheckedWorld | undefined;
for await (const { progress, event } of worlds.generateWorld({ start: { case: "building", value: { prompt, seed: 1n } } })) {
  console.log(`${Math.round(100 * (progress?.fraction ?? 0))} % ${progress?.stage} ${progress?.message}`);
  if (event.case === "floorplan") {
    // the plan is there while furniture is still being placed
    for (const room of event.value.rooms) console.log(`  ${room.name}: ${room.netAreaM2.toFixed(1)} m2`);
  }
  if (event.case === "world") checked = event.value;
}
console.log(`sound: ${checked?.report?.sound} with ${checked?.world?.placements?.placements.length} objects`);

const archive = createWriteStream("world.zip");
for await (const { chunk } of worlds.exportWorld({ world: checked?.world })) archive.write(chunk);
archive.end(() => {
  console.log("wrote world.zip");
  process.exit(0);
});
