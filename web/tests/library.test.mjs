/** The library: many worlds of one request, and kinds of building of one's own. */
import assert from "node:assert/strict";
import { cpSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { test } from "node:test";

import { browser, opened, runProgram, Server, server, skip, sound, withBrowserAndServer } from "./support.mjs";

withBrowserAndServer();

test("many worlds are made while one watches, and one of them is opened", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await page.getByTestId("prompt").fill("flat in Ghent with 2 bedrooms");
  await page.getByTestId("stage-library").click();
  await page.getByTestId("batch-count").fill("3");
  await page.getByTestId("batch-start").click();
  await page.locator('[data-job-id][data-state="done"]').waitFor({ timeout: 120_000 });
  assert.match(await page.locator("[data-job-id]").innerText(), /3 of 3 sound/);
  // what was written down, and all of it in one archive
  await page.getByTestId("job-log").click();
  await page.locator('[data-testid="job-lines"] li').first().waitFor();
  const [archive] = await Promise.all([page.waitForEvent("download", { timeout: 120_000 }), page.getByTestId("batch-download").click()]);
  const files = readFileSync(await archive.path()).toString("latin1");
  for (const seed of [0, 1, 2]) for (const name of ["world.json", "report.json", "plan.svg"]) assert.ok(files.includes(`world-${seed}/${name}`), `${seed} ${name}`);
  await page.getByTestId("batch-worlds").click();
  await page.locator('[data-seed="2"]').waitFor();
  assert.equal(await page.locator("[data-seed]").count(), 3);
  await page.locator('[data-seed="2"]').getByTestId("batch-open").click();
  await page.getByTestId("plan-svg").waitFor();
  const names = await page.locator("[data-room-id] title").allTextContents();
  assert.equal(names.filter((name) => /bedroom/i.test(name)).length, 2);
  // it is a world like any other: kept, and found again
  await page.locator('[data-testid="saved"][data-saved="saved"]').waitFor();
  await page.getByTestId("stage-library").click();
  await page.locator('[data-testid="worlds"] [data-world-id]').first().waitFor();
  sound(faults);
  await context.close();
});

/** Returns a copy of a shipped kind of building under an id of its own. */
function ownKind(id) {
  const folder = mkdtempSync(join(tmpdir(), "d3dgen-kind-"));
  cpSync(resolve("../domains/school"), folder, { recursive: true });
  const change = (name, from, to) => {
    const text = readFileSync(join(folder, name), "utf8");
    assert.ok(text.includes(from), `${name} has ${from}`);
    writeFileSync(join(folder, name), text.replace(from, to));
  };
  change("domain.toml", 'id = "school"', `id = "${id}"`);
  change("domain.toml", 'title = "School"', 'title = "Evening school"');
  change("knowledge.json", '"domain": "school"', `"domain": "${id}"`);
  return { change, files: () => readdirSync(folder).map((name) => join(folder, name)), remove: () => rmSync(folder, { recursive: true }) };
}

test("a kind of building of one's own: its problems by place, then registered and removed", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  const kind = ownKind("evening_school");
  await page.getByTestId("stage-library").click();
  await page.locator('[data-domain-id="hospital"]').waitFor();
  const files = page.getByTestId("domain-files");
  const card = page.locator('[data-domain-id="evening_school"]');
  kind.change("domain.toml", "version = 1", "version = 1\nno_such_field = 1");
  await files.setInputFiles(kind.files());
  const problems = page.getByTestId("domain-problems");
  assert.match(await problems.innerText(), /domain\.toml[^]*no_such_field/);
  assert.equal(await page.getByTestId("domain-register").count(), 0);

  kind.change("domain.toml", "\nno_such_field = 1", "");
  await files.setInputFiles(kind.files());
  await page.getByTestId("domain-checked").waitFor();
  assert.equal(await problems.count(), 0);
  assert.equal(await card.count(), 0, "nothing is registered by a check");
  await page.getByTestId("domain-register").click();
  await card.waitFor();
  assert.match(await card.innerText(), /Evening school/);
  await card.getByRole("button", { name: "Delete" }).click();
  await card.getByRole("button", { name: "Really delete" }).click();
  await card.waitFor({ state: "detached" });

  // what only the check of the whole finds has its place too
  kind.change("knowledge.json", '"domain": "evening_school"', '"domain": "day_school"');
  await files.setInputFiles(kind.files());
  await problems.waitFor();
  assert.match(await problems.locator("code").first().innerText(), /knowledge/);
  kind.remove();
  sound(faults);
  await context.close();
});

test("a data set that somebody makes in the server's folder is seen with its figures and what came to no world", { skip }, async () => {
  const home = mkdtempSync(join(tmpdir(), "d3dgen-sets-"));
  const spec = join(home, "wards.toml");
  writeFileSync(spec, 'name = "wards"\nseeds = 8\nprompts = [{ text = ["flat", "office with 3000 rooms"] }]\n');
  // a shard waits to be merged: it is there, and nobody adds to it
  runProgram("dataset", "make", spec, "--shard", "0/4", "--block", "2", "--out", join(home, "sets", "wards"));
  const watching = await new Server().start(`data_sets = [${JSON.stringify(join(home, "sets"))}]`);
  const { page, context, faults } = await opened(browser, watching.url);
  await page.getByTestId("stage-library").click();
  const row = page.locator('[data-job-id="data_set/0/wards"]');
  await row.getByText("4 tasks done of 4: 2 worlds, 2 without one").waitFor();
  await row.getByTestId("job-log").click();
  assert.match(await row.getByTestId("job-lines").innerText(), /office with 3000 rooms[^]*500 at most/);
  sound(faults);
  await context.close();
  await watching.remove();
  rmSync(home, { recursive: true });
});
