/** People and robots: a scenario is moved by the server, played over the plan, and told in figures. */
import assert from "node:assert/strict";
import { test } from "node:test";

import { browser, make, middle, opened, server, skip, sound, withBrowserAndServer } from "./support.mjs";

withBrowserAndServer();

test("everybody walks over the plan, and encounters, distances and conditions are told", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  await page.getByTestId("stage-people").click();
  assert.match(await page.getByTestId("flows").innerText(), /\w+: [\d.]+ groups an hour, \d+ people at a time/);
  await page.getByTestId("minutes").fill("5");
  await page.getByTestId("simulate").click();
  const figures = page.getByTestId("crowd-figures");
  await figures.waitFor({ timeout: 60_000 });
  assert.match(await figures.innerText(), /Closest encounter\s+[\d.]+ m[^]*delivery robot 1/);
  assert.ok((await figures.locator("[data-condition-id][data-holds]").count()) > 0);
  // it plays by itself, and stands where the time is put
  const at = (selector) => page.locator(selector).evaluate((e) => `${e.getAttribute("cx")} ${e.getAttribute("cy")}`);
  const robot = '[data-robot-id="delivery_robot_1"]';
  await page.getByTestId("play").click();
  const slider = page.locator('input[type="range"]');
  const seen = new Set();
  for (const second of [0, 20, 60, 120, 290]) {
    await slider.fill(String(second));
    seen.add(await at(robot));
  }
  assert.ok(seen.size >= 4, `the robot was at ${seen.size} places`);
  // another world has another future
  await page.getByTestId("stage-plan").click();
  const spot = await middle(page, "[data-object-id].object:not(.upper)");
  await page.mouse.click(spot.x, spot.y);
  await page.getByTestId("remove").click();
  await page.locator('[data-testid="undo"]:not([disabled])').waitFor();
  await page.getByTestId("stage-people").click();
  assert.equal(await figures.count(), 0);
  sound(faults);
  await context.close();
});

test("a robot's work is changed: turn, stops, load and where it loads, each one step, and kept when a wall moves", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  await page.getByTestId("stage-people").click();
  const work = page.locator('[data-testid="robot-work"][data-work-of="delivery_robot_1"]');
  const stops = async () => (await work.getByTestId("stop").allInnerTexts()).map((text) => text.split("\n")[0].replace(/ [\d.]+ m,.*/, ""));
  await work.getByTestId("stop").first().waitFor();
  const was = await stops();
  assert.ok(was.length > 2, was.join());
  const undo = page.locator('[data-testid="undo"]:not([disabled])');
  const done = async (what) => {
    await undo.waitFor({ timeout: 20_000 });
    await work.locator("h2", { hasText: "set by you" }).waitFor();
    assert.equal(await page.getByTestId("notice").count(), 0, what);
  };
  const back = async (what) => {
    await page.getByTestId("undo").click();
    assert.deepEqual(await stops(), was, `undo of ${what}`);
    assert.ok(await page.getByTestId("undo").isDisabled(), `${what} is one step`);
  };
  await work.getByTestId("stop-earlier").nth(2).click();
  await done("turn");
  assert.deepEqual(await stops(), [was[0], was[2], was[1], ...was.slice(3)]);
  await back("turn");
  await work.getByTestId("job-load").fill("25");
  await page.keyboard.press("Tab");
  await done("load");
  await back("load");
  await work.getByTestId("job-from").selectOption({ index: 3 });
  await done("from");
  await page.getByTestId("undo").click();
  await work.getByTestId("stop-out").nth(1).click();
  await done("out");
  const left = [was[0], ...was.slice(2)];
  assert.deepEqual(await stops(), left);
  // what the person set outlives a change of the plan
  await page.getByTestId("stage-plan").click();
  const spot = await middle(page, "[data-object-id].object:not(.upper)");
  await page.mouse.click(spot.x, spot.y);
  const before = await page.locator("[data-object-id]").count();
  await page.getByTestId("remove").click();
  await page.waitForFunction((n) => document.querySelectorAll("[data-object-id]").length < n, before);
  await page.getByTestId("stage-people").click();
  assert.deepEqual(await stops(), left);
  await work.getByTestId("task-free").click();
  await work.locator("h2", { hasText: "set by you" }).waitFor({ state: "detached" });
  sound(faults);
  await context.close();
});

test("a person's steps are put in another turn, timed and left out", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  await page.getByTestId("stage-people").click();
  const nurse = page.locator('[data-testid="person"][data-steps-of="nurse_1"]');
  await nurse.locator("summary").click();
  const count = await nurse.getByTestId("stop").count();
  assert.ok(count > 2, `${count} steps`);
  await nurse.getByTestId("stop-out").nth(1).click();
  await page.waitForFunction((n) => document.querySelectorAll('[data-steps-of="nurse_1"] [data-testid="stop"]').length === n, count - 1);
  await nurse.getByTestId("step-seconds").first().fill("77");
  await page.keyboard.press("Tab");
  await nurse.getByTestId("task-free").waitFor();
  await page.waitForFunction(() => document.querySelector('[data-testid="undo"]').title.includes("nurse 1"));
  await page.getByTestId("undo").click();
  await page.getByTestId("undo").click();
  assert.equal(await nurse.getByTestId("stop").count(), count);
  sound(faults);
  await context.close();
});
