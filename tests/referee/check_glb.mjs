#!/usr/bin/env node
// Passes every GLB file below folders to the Khronos glTF validator: check_glb.mjs FOLDER...
//
// Errors and warnings fail; hints do not. The validator is in tests/package.json (`npm ci --prefix tests`).
// Exit status 0 when all files are valid, 1 when one is not.
import fs from "node:fs";
import path from "node:path";
import { validateBytes } from "gltf-validator";

function* files(folder) {
  for (const entry of fs.readdirSync(folder, { withFileTypes: true }).sort((a, b) => (a.name < b.name ? -1 : 1))) {
    const full = path.join(folder, entry.name);
    if (entry.isDirectory()) yield* files(full);
    else if (entry.name.endsWith(".glb")) yield full;
  }
}

let seen = 0;
let broken = 0;
let triangles = 0;
for (const folder of process.argv.slice(2)) {
  for (const file of files(folder)) {
    const report = await validateBytes(new Uint8Array(fs.readFileSync(file)), { uri: path.basename(file) });
    const issues = report.issues.messages.filter((m) => m.severity <= 1);
    for (const issue of issues) console.log(`${file}: ${issue.code} ${issue.message} ${issue.pointer ?? ""}`);
    seen += 1;
    broken += issues.length > 0 ? 1 : 0;
    triangles += report.info.totalTriangleCount;
  }
}
if (seen === 0) console.log("no GLB file at all");
console.log(broken === 0 && seen > 0 ? `every GLB is valid: ${seen}, ${triangles} triangles` : `${broken} of ${seen} GLB files are broken`);
process.exit(seen > 0 && broken === 0 ? 0 : 1);
